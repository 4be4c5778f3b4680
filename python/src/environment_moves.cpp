// Binds dartcast/environment.hpp: moves, edits, and what follows an edit.
//
// next_points() gives the memory of the next positions without a copy. The memory moves at an edit, so an edit is
// refused while an array of a block exists. Between the start of a block and its end no particles may be advanced,
// because they may need what the block writes over.
#include "bind.hpp"
#include "dartcast/validity.hpp"
#include "support/environments.hpp"
#include "support/members.hpp"
#include "support/pickles.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::environment_moves {
namespace {

constexpr const char* remedy = "it is moved by its deformation";

// A block of next_points().
struct NextPoints {
  EnvironmentPointer environment;
  py::array_t<double> points;
  bool open = false;
  bool used = false;
};

// An array over memory of the environment, which it keeps alive; `written` lives as long as the array.
py::array_t<double> writable_view(EnvironmentHandle& h, std::span<Vec3> memory) {
  struct Owner {
    std::shared_ptr<void> environment, written;
  };
  std::shared_ptr<void> written = h.written.lock();
  if (!written) h.written = written = std::make_shared<int>();
  const py::capsule owner(new Owner{h.owner, written}, [](void* p) { delete static_cast<Owner*>(p); });
  return py::array_t<double>({static_cast<py::ssize_t>(memory.size()), py::ssize_t{3}},
                             reinterpret_cast<const double*>(memory.data()), owner);
}

py::array_t<double> enter(NextPoints& block) {
  EnvironmentHandle& h = *block.environment;
  const Use use(*h.usage, "the environment");
  h.expect_no_writing("next_points");
  if (block.used) throw InvalidArgument("next_points: this block has ended: call next_points() again");
  Environment& e = h.changeable(remedy);
  block.points = writable_view(h, e.next_positions());
  block.open = block.used = h.writing = true;
  return block.points;
}

// An exception leaves the positions before the last move written over in part.
void leave(NextPoints& block, const py::object& raised, const py::object& /*value*/, const py::object& /*trace*/) {
  if (!block.open) return;
  EnvironmentHandle& h = *block.environment;
  const Use use(*h.usage, "the environment");
  read_only(std::move(block.points));
  block.open = h.writing = false;
  h.overwritten = true;
  if (!raised.is_none()) return;
  const py::gil_scoped_release release;
  h.environment->move();
  h.overwritten = false;
}

void move(EnvironmentHandle& h, const Typed<"Points">& given) {
  const auto points = vectors(given, "points");
  const Use use(*h.usage, "the environment");
  h.expect_no_writing("move");
  Environment& e = h.changeable(remedy);
  const py::gil_scoped_release release;
  e.move(points);
  h.overwritten = false;
}

double move_until_inverted(EnvironmentHandle& h, const Typed<"Points">& given, double share) {
  const auto points = vectors(given, "positions");
  if (!(share >= 0.0 && share <= 1.0)) throw InvalidArgument("share: expected a number from 0 to 1");
  const Use use(*h.usage, "the environment");
  h.expect_no_writing("move_until_inverted");
  Environment& e = h.changeable(remedy);
  const py::gil_scoped_release release;
  const double way = e.move_until_inverted(points, share);
  if (way > 0.0) h.overwritten = false;
  return way;
}

// `call`: what moves the memory of positions.
Environment& editable(EnvironmentHandle& h, const char* call) {
  h.expect_no_writing(call);
  if (!h.written.expired())
    throw InvalidArgument(std::string(call) +
                          ": an array of a next_points() block still exists, and its memory may move: delete it first "
                          "(del x), and all views of it");
  return h.changeable("let its events edit it");
}

ComplexEditReport edit(EnvironmentHandle& h, const Typed<"Callable[[ComplexEdit], object]">& make) {
  const Use use(*h.usage, "the environment");
  Environment& e = editable(h, "edit");
  const auto callback = edit_callback(make);
  const py::gil_scoped_release release;
  return e.edit(callback);
}

void replace(EnvironmentHandle& h, const MeshData& mesh) {
  const Use use(*h.usage, "the environment");
  Environment& e = editable(h, "replace");
  const py::gil_scoped_release release;
  e.replace(mesh);
}

UpdateReport update_after_edit(const EnvironmentHandle& h, ParticlesHandle& p, OrphanPolicy orphaned) {
  const UseBoth use(h, p);
  expect_positions_before(h, p, "update_after_edit");
  const py::gil_scoped_release release;
  return h.environment->update_after_edit(p.particles, orphaned);
}

void bind_next_points(py::module_& m, EnvironmentClass& c) {
  py::class_<NextPoints>(m, "NextPoints", "A block in which the next positions are written: Environment.next_points().")
      .def("__enter__", &enter)
      .def("__exit__", &leave, py::arg("raised").none(true), py::arg("value").none(true), py::arg("trace").none(true));
  c.def(
      "next_points",
      [](const EnvironmentPointer& h) {
        return NextPoints{h, {}, false, false};
      },
      "`with environment.next_points() as x:` gives the memory of the next positions, without a copy: float64 (n, 3). "
      "Write all of it: the content is that of two moves ago. In the plane z is not read. At the end of the block x "
      "becomes read-only, and the environment moves, as by move(). Where the block raises, nothing is moved; particles "
      "that had not yet taken part in the last move then cannot be advanced any more. Start a block only when every "
      "set of particles has taken part in the last move. While it is open the environment can be read only. Write to "
      "no view of x after the block, and delete x and its views before an edit.");
}

}  // namespace

void bind(py::module_& m, EnvironmentClass& c) {
  auto report = class_of<UpdateReport>();
  pickle_by_bytes(report, [](UpdateReport& r) { return std::tie(r.touched, r.located, r.orphaned); });
  bind_next_points(m, c);
  c.def("move", &move, py::arg("points"),
        "Copies new positions of all the mesh's points, float64 (n, 3), and makes them current. Every set of particles "
        "must then be advanced once, or update_after_edit() an edit made after this move, before the next move. "
        "advance() takes targets relative to positions before the move. Raises InvalidArgument, nothing moved, where "
        "the number does not match, or in the plane a z is not 0.");
  c.def("move_until_inverted", &move_until_inverted, about("Environment::move_until_inverted"));
  c.def("edit", &edit, about("Environment::edit", "make(edit): gets a ComplexEdit, which is open until it returns."));
  c.def("replace", &replace, about("Environment::replace"));
  c.def("update_after_edit", &update_after_edit, about("Environment::update_after_edit"));
}

}  // namespace dartcast::python::environment_moves
