// Binds dartcast/catheter.hpp: catheters, and cameras along them.
#include "dartcast/catheter.hpp"

#include <string>
#include <utility>

#include "bind.hpp"
#include "bodies_handle.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::catheter {
namespace {

using Handle = CatheterHandle;
using Class = py::class_<Handle, std::shared_ptr<Handle>>;

std::shared_ptr<Handle> make_catheter(const std::shared_ptr<EnvironmentHandle>& environment,
                                      const CatheterOptions& options) {
  const Use use(*environment->usage, "the Environment");
  auto made = std::make_shared<Handle>();
  made->environment = environment;
  const CatheterOptions own_options = options;
  {
    const py::gil_scoped_release release;
    made->own = std::make_shared<Catheter>(*environment->environment, own_options);
  }
  made->solid = made->own.get();
  return made;
}

CatheterStep step(Handle& self, const CatheterInput& input) {
  const Use use = self.use();
  Catheter& catheter = self.changeable();
  const CatheterInput own_input = input;
  const py::gil_scoped_release release;
  return catheter.step(own_input);
}

UpdateReport update_after_edit(Handle& self) {
  const Use use = self.use();
  Catheter& catheter = self.changeable();
  const py::gil_scoped_release release;
  return catheter.update_after_edit();
}

// A function of the catheter, whose result is a copy.
template <class F>
auto of_catheter(F&& f) {
  return [f](const Handle& self) {
    const Use use = self.use();
    return f(std::as_const(*self.solid));
  };
}

void bind_records(py::module_& m) {
  Record<CatheterOptions>(m, "CatheterOptions")
      .field("length", &CatheterOptions::length)
      .field("spacing", &CatheterOptions::spacing)
      .field("stiffness", &CatheterOptions::stiffness)
      .field("tip_length", &CatheterOptions::tip_length)
      .field("tip_curvature", &CatheterOptions::tip_curvature)
      .field("entry", &CatheterOptions::entry)
      .field("direction", &CatheterOptions::direction)
      .field("friction", &CatheterOptions::friction)
      .field("rounds", &CatheterOptions::rounds)
      .field("tolerance", &CatheterOptions::tolerance)
      .field("edges", &CatheterOptions::edges)
      .finish();
  Record<CatheterInput>(m, "CatheterInput")
      .field("push", &CatheterInput::push)
      .field("turn", &CatheterInput::turn)
      .field("load", &CatheterInput::load)
      .finish();
  Record<CatheterStep>(m, "CatheterStep")
      .field("pushed", &CatheterStep::pushed)
      .field("turned", &CatheterStep::turned)
      .field("worst_segment", &CatheterStep::worst_segment)
      .field("substeps", &CatheterStep::substeps)
      .field("rounds", &CatheterStep::rounds)
      .field("contacts", &CatheterStep::contacts)
      .field("at_walls", &CatheterStep::at_walls)
      .field("held", &CatheterStep::held)
      .field("stuck", &CatheterStep::stuck)
      .finish();
  Record<CatheterFrame>(m, "CatheterFrame")
      .field("tangent", &CatheterFrame::tangent)
      .field("normal", &CatheterFrame::normal)
      .field("binormal", &CatheterFrame::binormal)
      .finish();
  Record<ChainWall>(m, "ChainWall")
      .field("index", &ChainWall::index)
      .field("weight", &ChainWall::weight)
      .field("normal", &ChainWall::normal)
      .field("point", &ChainWall::point)
      .field("pressure", &ChainWall::pressure)
      .field("idle", &ChainWall::idle)
      .finish();
}

// A checkpoint cannot be made or changed in Python.
void bind_checkpoint(py::module_& m) {
  using Checkpoint = CatheterCheckpoint;
  const auto reading = [](auto member) {
    return [member](const Checkpoint& c) { return without_writing(py::cast(c.*member)); };
  };
  py::class_<Checkpoint>(m, "CatheterCheckpoint", doc("CatheterCheckpoint"))
      .def_property_readonly("states", reading(&Checkpoint::states))
      .def_property_readonly("held_weights", reading(&Checkpoint::held_weights))
      .def_property_readonly("walls", reading(&Checkpoint::walls), doc("CatheterCheckpoint::walls"))
      .def_property_readonly("inserted", reading(&Checkpoint::inserted))
      .def_property_readonly("turned", reading(&Checkpoint::turned))
      .def_property_readonly("direction", reading(&Checkpoint::direction))
      .def_property_readonly("reference", reading(&Checkpoint::reference));
}

void bind_state(Class& catheter) {
  catheter
      .def("points", of_catheter([](const Catheter& c) { return c.points(); }),
           (std::string(doc("Catheter::points")) + "\n\nfloat64 (n, 3).").c_str())
      .def("frames", of_catheter([](const Catheter& c) { return c.frames(); }), doc("Catheter::frames"))
      .def("contacts", of_catheter([](const Catheter& c) { return rows_of(c.contacts()); }),
           (std::string(doc("Catheter::contacts")) + "\n\nA structured array, as SolidStep.contacts.").c_str())
      .def_property_readonly("inserted", of_catheter([](const Catheter& c) { return c.inserted(); }),
                             doc("Catheter::inserted"))
      .def_property_readonly("measured_length", of_catheter([](const Catheter& c) { return c.measured_length(); }),
                             doc("Catheter::measured_length"))
      .def_property_readonly("total_length", of_catheter([](const Catheter& c) { return c.total_length(); }),
                             "Of the whole catheter, m.")
      .def_property_readonly("turned", of_catheter([](const Catheter& c) { return c.turned(); }), "Turns so far, rad.")
      .def_property_readonly("entry", of_catheter([](const Catheter& c) { return c.entry(); }), "Where it enters now.")
      .def_property_readonly("direction", of_catheter([](const Catheter& c) { return c.direction(); }),
                             "In which it enters now.")
      .def_property_readonly(
          "environment", [](const Handle& self) { return self.environment; }, "The environment.")
      .def_property_readonly("particles", of_catheter([](const Catheter& c) {
                               auto copy = std::make_shared<ParticlesHandle>();
                               copy->particles = c.particles();
                               return copy;
                             }),
                             (std::string(doc("Catheter::particles")) + "\n\nA copy.").c_str())
      .def_property_readonly("options", of_catheter([](const Catheter& c) { return CatheterOptions(c.options()); }),
                             "A copy.")
      .def("audit", of_catheter([](const Catheter& c) { return c.audit(); }), doc("Catheter::audit"))
      .def("state_hash", of_catheter([](const Catheter& c) { return c.state_hash(); }), "Of all its points.");
}

void bind_class(py::module_& m) {
  Class catheter(m, "Catheter", doc("Catheter"));
  catheter
      .def(py::init(&make_catheter), py::arg("environment").none(false), py::arg("options"), doc("Catheter::Catheter"))
      .def("step", &step, py::arg("input"), doc("Catheter::step"))
      .def("move_with", &move_with<Catheter>, py::arg("positions"),
           (std::string(doc("Catheter::move_with")) + "\n\npositions: float64 (n, 3).").c_str())
      .def("update_after_edit", &update_after_edit, doc("Catheter::update_after_edit"))
      .def("checkpoint", of_catheter([](const Catheter& c) { return c.checkpoint(); }), "The state, for restore().")
      .def(
          "restore",
          [](Handle& self, const CatheterCheckpoint& saved) {
            const Use use = self.use();
            Catheter& own_catheter = self.changeable();
            const CatheterCheckpoint own = saved;
            const py::gil_scoped_release release;
            own_catheter.restore(own);
          },
          py::arg("saved"), doc("Catheter::restore"));
  bind_state(catheter);
}

CameraPath cameras(const std::shared_ptr<EnvironmentHandle>& environment, const py::object& points,
                   const CameraOptions& options) {
  const Use use(*environment->usage, "the Environment");
  const auto x = vectors(points, "points");
  const CameraOptions own_options = options;
  const py::gil_scoped_release release;
  return camera_path(*environment->environment, x, own_options);
}

}  // namespace

void bind(py::module_& m) {
  bind_records(m);
  bind_checkpoint(m);
  bind_class(m);
  Record<CameraOptions>(m, "CameraOptions")
      .field("spacing", &CameraOptions::spacing)
      .field("up", &CameraOptions::up)
      .field("max_count", &CameraOptions::max_count)
      .finish();
  Record<Camera>(m, "Camera")
      .field("position", &Camera::position)
      .field("direction", &Camera::direction)
      .field("up", &Camera::up)
      .field("arc", &Camera::arc)
      .finish();
  Record<CameraPath>(m, "CameraPath")
      .field("cameras", &CameraPath::cameras)
      .field("at_walls", &CameraPath::at_walls)
      .finish();
  m.def("camera_path", &cameras, py::arg("environment").none(false), py::arg("points"),
        py::arg("options") = CameraOptions{}, doc("camera_path"));
}

}  // namespace dartcast::python::catheter
