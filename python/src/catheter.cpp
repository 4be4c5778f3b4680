// Binds dartcast/catheter.hpp: catheters, and cameras along them.
#include "dartcast/catheter.hpp"

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

void bind_state(Class& c) {
  c.def("points", calling<Handle>(&Catheter::points), about("Catheter::points", "float64 (n, 3)."));
  members_of_Catheter(c);
  c.def(
      "contacts",
      [](const Handle& self) {
        const Use use = self.use();
        return rows_of(self.solid->contacts());
      },
      about("Catheter::contacts", "A structured array, as SolidStep.contacts."));
  c.def_property_readonly(
      "environment", [](const Handle& self) { return self.environment; }, "The environment.");
}

void bind_class(py::module_& m) {
  Class c(m, "Catheter", doc("Catheter"));
  c.def(py::init(&make_catheter), py::arg("environment").none(false), py::arg("options"), doc("Catheter::Catheter"));
  c.def("move_with", &move_with<Catheter>, about("Catheter::move_with", "positions: float64 (n, 3)."));
  bind_state(c);
}

CameraPath cameras(const std::shared_ptr<EnvironmentHandle>& environment, const Typed<"Points">& points,
                   const CameraOptions& options) {
  const Use use(*environment->usage, "the Environment");
  const auto x = vectors(points, "points");
  const CameraOptions own_options = options;
  const py::gil_scoped_release release;
  return camera_path(*environment->environment, x, own_options);
}

}  // namespace

void bind(py::module_& m) {
  bind_class(m);
  m.def("camera_path", &cameras, py::arg("environment").none(false), py::arg("points"),
        py::arg("options") = CameraOptions{}, doc("camera_path"));
}

}  // namespace dartcast::python::catheter
