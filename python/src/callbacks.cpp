// Responses of Python at walls. They run with Python's lock; an exception in them ends the step, which changes nothing.
#include "callbacks.hpp"

#include <string>
#include <vector>

#include "contact_arrays.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

// The displacements that a function returned for m contacts.
void set_displacements(const py::object& answer, std::span<AfterContact> after) {
  const auto displacements = vectors(answer, "the result of respond");
  if (displacements.size() != after.size()) {
    throw InvalidArgument("the result of respond has " + std::to_string(displacements.size()) + " rows for " +
                          std::to_string(after.size()) + " contacts: one displacement for each is needed");
  }
  for (std::size_t i = 0; i < after.size(); ++i) after[i].displacement = displacements[i];
}

void set_along(const py::object& along, std::span<AfterContact> after) {
  if (py::isinstance<py::bool_>(along)) {
    for (AfterContact& a : after) a.along = along.cast<bool>();
    return;
  }
  const auto flags = marks(along, "the second result of respond");
  if (flags.size() != after.size()) {
    throw InvalidArgument("the second result of respond has " + std::to_string(flags.size()) + " flags for " +
                          std::to_string(after.size()) + " contacts");
  }
  for (std::size_t i = 0; i < after.size(); ++i) after[i].along = flags[i] != 0;
}

void answer_round(const py::object& respond, const ContactList& contacts, std::span<AfterContact> after) {
  const py::object answer = respond(contact_array(contacts), wall_array(contacts.walls));
  if (answer.is_none()) return;
  if (!py::isinstance<py::tuple>(answer)) return set_displacements(answer, after);
  const auto pair = py::reinterpret_borrow<py::tuple>(answer);
  if (pair.size() != 2) throw py::type_error("respond returned " + std::to_string(pair.size()) + " values: one or two");
  set_displacements(pair[0], after);
  set_along(pair[1], after);
}

AfterContact answer_contact(const py::object& respond, const Contact& contact, std::span<const WallHit> walls,
                            std::span<const WallHit> earlier) {
  const py::object answer = respond(contact, std::vector<WallHit>(walls.begin(), walls.end()),
                                    std::vector<WallHit>(earlier.begin(), earlier.end()));
  if (answer.is_none()) return {};
  if (py::isinstance<AfterContact>(answer)) return answer.cast<AfterContact>();
  return {vector(answer, "the result of respond"), false};
}

// Destroys a Python object with the lock held, wherever the last copy of a callback ends.
std::shared_ptr<py::object> kept(const py::object& respond) {
  return {new py::object(respond), [](py::object* p) {
            const py::gil_scoped_acquire acquire;
            delete p;
          }};
}

}  // namespace

RoundCallback round_callback(const py::object& respond) {
  return [function = kept(respond)](const ContactList& contacts, std::span<AfterContact> after) {
    const py::gil_scoped_acquire acquire;
    answer_round(*function, contacts, after);
  };
}

ContactCallback contact_callback(const py::object& respond) {
  return [function = kept(respond)](const Contact& contact, std::span<const WallHit> walls,
                                    std::span<const WallHit> earlier) {
    const py::gil_scoped_acquire acquire;
    return answer_contact(*function, contact, walls, earlier);
  };
}

void bind_callbacks(py::module_& m) {
  Record<WallHit>(m, "WallHit")
      .field("face", &WallHit::face)
      .field("triangle", &WallHit::triangle)
      .field("patch", &WallHit::patch)
      .field("normal", &WallHit::normal)
      .finish();
  Record<Contact>(m, "Contact")
      .field("particle", &Contact::particle)
      .field("kind", &Contact::kind)
      .field("dart", &Contact::dart)
      .field("first_wall", &Contact::first_wall)
      .field("wall_count", &Contact::wall_count)
      .field("earlier", &Contact::earlier)
      .field("together", &Contact::together)
      .field("last", &Contact::last)
      .field("time_of_impact", &Contact::time_of_impact)
      .field("point", &Contact::point)
      .field("wall_displacement", &Contact::wall_displacement)
      .field("displacement", &Contact::displacement)
      .field("unused", &Contact::unused)
      .finish();
  Record<AfterContact>(m, "AfterContact")
      .field("displacement", &AfterContact::displacement)
      .field("along", &AfterContact::along)
      .finish();
}

}  // namespace dartcast::python
