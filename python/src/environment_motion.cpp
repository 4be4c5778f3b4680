// Binds the motion and the edits of dartcast/environment.hpp.
#include <string>
#include <thread>
#include <vector>

#include "bind.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/validity.hpp"
#include "environment_parts.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

constexpr const char* let_simulation = "let Simulation.step() move it, and use Simulation.edit()";

/// `with environment.next_points() as x:` writes the next positions in place, and moves at the end of the block.
struct NextPoints {
  std::shared_ptr<EnvironmentHandle> environment;
  py::object array = py::none();

  py::object enter() {
    const Use use(*environment->usage, the_environment);
    const auto positions = environment->changeable(let_simulation).next_positions();
    const py::capsule owner(new std::shared_ptr<EnvironmentHandle>(environment),
                            [](void* p) { delete static_cast<std::shared_ptr<EnvironmentHandle>*>(p); });
    array = py::array_t<double>({static_cast<py::ssize_t>(positions.size()), py::ssize_t{3}},
                                reinterpret_cast<double*>(positions.data()), owner);
    environment->writing = true;
    return array;
  }

  // The array becomes empty: its memory is the environment's. One name is expected to refer to it besides this object.
  void leave(bool failed) {
    if (array.is_none()) throw InvalidArgument("next_points(): use it in a `with` block");
    py::detail::array_proxy(array.ptr())->dimensions[0] = 0;
    read_only(py::reinterpret_borrow<py::array>(array));
    if (array.ref_count() > 2) environment->kept.push_back(array);
    array = py::none();
    environment->writing = false;
    if (failed) return;
    const Use use(*environment->usage, the_environment);
    Environment& moved = environment->changeable(let_simulation);
    const py::gil_scoped_release release;
    moved.move();
  }
};

void move(const EnvironmentHandle& h, const py::object& positions) {
  const auto points = vectors(positions, "positions");
  const Use use(*h.usage, the_environment);
  Environment& environment = h.changeable(let_simulation);
  const py::gil_scoped_release release;
  environment.move(points);
}

std::optional<CellInversion> first_inversion(const EnvironmentHandle& h, const py::object& positions) {
  const auto points = vectors(positions, "positions");
  const Use use(*h.usage, the_environment);
  const py::gil_scoped_release release;
  return h.environment->first_inversion(points);
}

double move_until_inverted(const EnvironmentHandle& h, const py::object& positions, double share) {
  const auto points = vectors(positions, "positions");
  if (!(share >= 0.0 && share <= 1.0)) {
    throw InvalidArgument("move_until_inverted: share is " + std::to_string(share) + ": it must be in [0, 1]");
  }
  const Use use(*h.usage, the_environment);
  Environment& environment = h.changeable(let_simulation);
  const py::gil_scoped_release release;
  return environment.move_until_inverted(points, share);
}

// Another thread may still use the edit, which must not end before that.
void end_when_unused(EditHandle& edit) {
  while (true) {
    try {
      return edit.end();
    } catch (const InUse&) {
      const py::gil_scoped_release release;
      std::this_thread::yield();
    }
  }
}

ComplexEditReport edit(const EnvironmentHandle& h, const py::function& make) {
  const Use use(*h.usage, the_environment);
  return h.changeable(let_simulation).edit([&](ComplexEdit& open) {
    const auto handle = std::make_shared<EditHandle>();
    handle->edit = &open;
    try {
      make(handle);
    } catch (...) {
      end_when_unused(*handle);
      throw;
    }
    end_when_unused(*handle);
  });
}

UpdateReport update_after_edit(const EnvironmentHandle& h, ParticlesHandle& particles, OrphanPolicy orphaned) {
  const Use use(*h.usage, the_environment);
  const Use other(*particles.usage, the_particles);
  const py::gil_scoped_release release;
  return h.environment->update_after_edit(particles.particles, orphaned);
}

}  // namespace

void bind_motion(py::module_& m, EnvironmentClass& c) {
  py::class_<NextPoints>(m, "NextPoints", "The block of Environment.next_points().")
      .def("__enter__", &NextPoints::enter)
      .def("__exit__", [](NextPoints& n, const py::object& type, const py::object& /*error*/,
                          const py::object& /*where*/) { n.leave(!type.is_none()); });
  c.def(
      "next_points", [](const std::shared_ptr<EnvironmentHandle>& h) { return NextPoints{h}; },
      "`with environment.next_points() as x:` gives the array float64 (n, 3) of the next positions, to be written in "
      "place without a copy, and moves at the end of the block. All of it must be written: it holds the positions of "
      "two "
      "moves ago. Nothing moves where the block raises. In the block every other call that moves or edits is refused. "
      "Afterwards the array is empty. A second name for it, or a view of it, must not be kept: the end of the block "
      "refuses to move then.");
  c.def("move", &move, py::arg("positions"), doc("Environment::move"));
  c.def("first_inversion", &first_inversion, py::arg("positions"), doc("Environment::first_inversion"));
  c.def("move_until_inverted", &move_until_inverted, py::arg("positions"), py::arg("share") = 1.0,
        doc("Environment::move_until_inverted"));
  c.def("edit", &edit, py::arg("make"), doc("Environment::edit"));
  c.def_property_readonly(
      "edit_count", [](const EnvironmentHandle& h) { return h.environment->edit_count(); },
      "The number of edits so far.");
  c.def_property_readonly(
      "last_edit",
      [](const EnvironmentHandle& h) {
        const Use use(*h.usage, the_environment);
        return h.environment->last_edit();
      },
      doc("Environment::last_edit"));
  c.def("update_after_edit", &update_after_edit, py::arg("particles"), py::arg("orphaned") = OrphanPolicy::relocate,
        doc("Environment::update_after_edit"));
}

}  // namespace dartcast::python
