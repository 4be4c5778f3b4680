// Answers to contacts from Python. Functions of Python are called with Python's lock taken; what they raise comes out
// of the call.
#include "support/respond.hpp"

#include <utility>

#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

constexpr const char* expected_respond =
    "None, a response (Reflect(0.5), Slide(), Stick(), Absorb(), Escape(), WallResponse), WallResponses, a dict of "
    "responses by patch, a ContactCallback, or a function";

// A function's answer to one contact: None, a displacement or an AfterContact.
AfterContact answer_of(const py::object& given) {
  if (given.is_none()) return {};
  if (py::isinstance<AfterContact>(given)) return given.cast<AfterContact>();
  return {vector(given, "the response's displacement"), false};
}

ContactCallback asked_one_by_one(const py::object& function) {
  return [function = function.ptr()](const Contact& contact, std::span<const WallHit> walls,
                                     std::span<const WallHit> earlier) {
    const py::gil_scoped_acquire lock;
    const auto list = [](std::span<const WallHit> w) { return std::vector<WallHit>(w.begin(), w.end()); };
    return answer_of(py::handle(function)(Contact(contact), list(walls), list(earlier)));
  };
}

constexpr const char* expected_answers = "None, float64 (contacts, 3), or a tuple of that and bool (contacts,)";

// A function's answer to a round, written to `after`.
void read_answers(const py::object& given, std::span<AfterContact> after) {
  if (given.is_none()) return;
  const bool is_pair = py::isinstance<py::tuple>(given) && py::len(given) == 2;
  const py::object displacements = is_pair ? py::object(given.cast<py::tuple>()[0]) : given;
  const py::object ensured = converted_vectors(displacements);
  const auto x = vectors(ensured, "the response's displacements");
  if (x.size() != after.size()) refuse_array(ensured, "the response", expected_answers, "one row for each contact");
  for (std::size_t i = 0; i < after.size(); ++i) after[i].displacement = x[i];
  if (!is_pair) return;
  const py::object given_along = given.cast<py::tuple>()[1];
  const auto along = marks(given_along, "the response's second array, along");
  if (along.size() != after.size()) refuse_array(given_along, "the response", expected_answers, "one for each contact");
  for (std::size_t i = 0; i < after.size(); ++i) after[i].along = along[i] != 0;
}

RoundCallback asked_in_rounds(const py::object& function) {
  return [function = function.ptr()](const ContactList& list, std::span<AfterContact> after) {
    const py::gil_scoped_acquire lock;
    const py::array contacts = rows_of(list.contacts, list.walls);
    read_answers(py::handle(function)(contacts, rows_of(std::span<const WallHit>(list.walls))), after);
  };
}

Patch patch_of(py::handle key, const CombinatorialMap* map) {
  if (!py::isinstance<py::str>(key)) {
    py::detail::make_caster<Patch> caster;
    if (!caster.load(key, true)) refuse_member("a patch", "its name, its number, or None for all others", key);
    return py::detail::cast_op<Patch&>(caster);
  }
  const auto name = key.cast<std::string>();
  if (map == nullptr) throw InvalidArgument("patch '" + name + "': give its number here");
  return map->patch(name);
}

WallResponse response_of(py::handle given) {
  WallResponse response;
  if (!load_response(given, response)) {
    refuse_member("a response", "Reflect(0.5), Slide(), Stick(), Absorb(), Escape() or a WallResponse", given);
  }
  return response;
}

}  // namespace

bool load_response(py::handle from, WallResponse& response) {
  const auto load = [&]<class T>(const T*) {
    if (!py::isinstance<T>(from)) return false;
    response = from.cast<const T&>();
    return true;
  };
  return load(static_cast<const Reflect*>(nullptr)) || load(static_cast<const Slide*>(nullptr)) ||
         load(static_cast<const Stick*>(nullptr)) || load(static_cast<const Absorb*>(nullptr)) ||
         load(static_cast<const Escape*>(nullptr)) || load(static_cast<const WallResponse*>(nullptr));
}

WallResponses responses_of(const py::object& given, const CombinatorialMap* map) {
  if (py::isinstance<WallResponses>(given)) return given.cast<WallResponses>();
  if (!py::isinstance<py::dict>(given)) return WallResponses(response_of(given));
  const auto by_patch = py::reinterpret_borrow<py::dict>(given);
  WallResponses made(by_patch.contains(py::none()) ? response_of(py::object(by_patch[py::none()])) : WallResponse{});
  for (const auto& [key, response] : by_patch) {
    if (!key.is_none()) made.set(patch_of(key, map), response_of(response));
  }
  return made;
}

std::span<const ParticleStatus> statuses_of(const py::object& x) {
  const bool right = py::isinstance<py::array_t<std::uint8_t>>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 1;
  if (!right) refuse_array(x, "statuses", "uint8 (n,), C-contiguous", "numpy.zeros(n, dtype=numpy.uint8)");
  const auto found = marks(x, "statuses");
  static_assert(sizeof(ParticleStatus) == 1);
  return {reinterpret_cast<const ParticleStatus*>(found.data()), found.size()};
}

std::span<ParticleStatus> writable_statuses(const py::object& x) {
  const auto found = statuses_of(x);
  auto a = py::reinterpret_borrow<py::array>(x);
  if (!a.writeable()) refuse_array(x, "statuses", "a writable array", "x.copy()");
  return {static_cast<ParticleStatus*>(a.mutable_data()), found.size()};
}

LibraryAnswers::LibraryAnswers(WallResponses by, py::object v, py::object s, double dt,
                               const Acceleration& acceleration)
    : responses(std::move(by)), velocities(std::move(v)), statuses(std::move(s)) {
  const std::span<Vec3> written = writable_vectors(velocities, "velocities");
  size = written.size();
  if (statuses.is_none()) own.resize(size, ParticleStatus::alive);
  const std::span<ParticleStatus> ends = statuses.is_none() ? std::span(own) : writable_statuses(statuses);
  callback = respond_with(responses, written, ends, dt, acceleration);
}

void LibraryAnswers::expect_particles(std::size_t count) const {
  if (count == size) return;
  throw InvalidArgument("velocities: expected one for each of the " + std::to_string(count) + " particles; got " +
                        std::to_string(size));
}

Answers::Answers(const RespondArguments& given, const CombinatorialMap& map, std::size_t count) {
  const py::object& respond = given.respond;
  const bool has_motion =
      !given.velocities.is_none() || !given.statuses.is_none() || !given.dt.is_none() || !given.acceleration.is_none();
  const bool is_ready = py::isinstance<LibraryAnswers>(respond);
  const bool is_function = !is_ready && PyCallable_Check(respond.ptr()) != 0;
  if (has_motion && (respond.is_none() || is_ready || is_function))
    throw InvalidArgument("velocities, statuses, dt and acceleration go with a response such as Reflect(0.5) only");
  if (respond.is_none()) return;
  if (is_ready) {
    library_ = respond.cast<std::shared_ptr<LibraryAnswers>>();
  } else if (is_function && given.per_contact) {
    each_ = asked_one_by_one(respond);
    return;
  } else if (is_function) {
    round_ = asked_in_rounds(respond);
    return;
  } else {
    WallResponse one;
    if (!load_response(respond, one) && !py::isinstance<WallResponses>(respond) && !py::isinstance<py::dict>(respond))
      refuse_member("respond", expected_respond, respond);
    if (given.velocities.is_none() || given.dt.is_none())
      throw InvalidArgument("a response needs velocities, which it changes, and dt, the duration of the step");
    library_ = std::make_shared<LibraryAnswers>(
        responses_of(respond, &map), given.velocities, given.statuses, given.dt.cast<double>(),
        given.acceleration.is_none() ? Acceleration{} : given.acceleration.cast<Acceleration>());
  }
  library_->expect_particles(count);
  each_ = library_->callback;
}

const ContactCallback& Answers::each(const char* call) const {
  if (in_rounds()) {
    throw InvalidArgument(std::string(call) +
                          ": it asks for one contact at a time: pass per_contact=True, and a function of (contact, "
                          "walls, earlier)");
  }
  return each_;
}

}  // namespace dartcast::python
