// Binds dartcast/bodies.hpp: the class Bodies.
#include "dartcast/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bind.hpp"
#include "bodies_handle.hpp"
#include "simulation_handle.hpp"

namespace py = pybind11;

namespace dartcast::python::bodies {
namespace {

using Handle = BodiesHandle;
using Class = py::class_<Handle, std::shared_ptr<Handle>>;

std::shared_ptr<Handle> make_bodies(const std::shared_ptr<EnvironmentHandle>& environment, const BodiesOptions& options,
                                    const Typed<"Responses | None">& responses) {
  const Use use(*environment->usage, "the Environment");
  auto made = std::make_shared<Handle>();
  made->environment = environment;
  const BodiesOptions own_options = options;
  WallResponses walls = wall_responses(responses, *environment->environment);
  {
    const py::gil_scoped_release release;
    made->own = std::make_shared<Bodies>(*environment->environment, own_options, std::move(walls));
  }
  made->solid = made->own.get();
  return made;
}

bool is_finite_motion(const RigidMover& m) {
  const auto finite = [](const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  return std::isfinite(m.inverse_mass) && finite(m.centre) && finite(m.velocity) && finite(m.angular_velocity) &&
         finite(m.position_delta) && finite(m.rotation_delta);
}

void apply_impulse(Handle& self, std::size_t body, const RigidMover& solved) {
  if (!is_finite_motion(solved)) throw InvalidArgument("apply_impulse: the state has a number that is not finite");
  change(self, [&, own = solved](Bodies& bodies) {
    expect(bodies, body);
    bodies.apply_impulse(body, own);
  });
}

void set_velocities(Handle& self, const Typed<"Points">& given) {
  const Use use = self.use();
  const auto velocities = vectors(given, "velocities");
  const std::span<Vec3> own = self.solid->velocities();
  if (velocities.size() != own.size()) {
    throw InvalidArgument("velocities: " + std::to_string(velocities.size()) + " of them for " +
                          std::to_string(own.size()) + " particles");
  }
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const Vec3& v = velocities[i];
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      throw InvalidArgument("velocities: that of particle " + std::to_string(i) + " is not finite");
  }
  std::copy(velocities.begin(), velocities.end(), own.begin());
}

void bind_calls(Class& c) {
  c.def(py::init(&make_bodies), py::arg("environment").none(false), py::arg("options"),
        py::arg("responses") = py::none(),
        about("Bodies::Bodies",
              "responses: one such as Reflect(0.5), a dict of them by the names of patches, or WallResponses; None: "
              "reflection without loss."));
  c.def("move_with", &move_with<Bodies>, about("Bodies::move_with", "positions: float64 (n, 3)."));
  c.def("apply_impulse", &apply_impulse, about("Bodies::apply_impulse"));
  members_of_Bodies(c);
}

void bind_properties(Class& c) {
  c.def("__len__", calling<Handle>(&Bodies::size));
  c.def_property_readonly(
      "environment", [](const Handle& self) { return self.environment; }, "The environment.");
  c.def_property("velocities", calling<Handle>(+[](const Bodies& b) { return b.velocities(); }), &set_velocities,
                 "Of all particles, float64 (n, 3): a copy. Set all of them for impulses between steps.");
}

}  // namespace

void bind(py::module_& m) {
  bodies_records::bind(m);
  Class bodies(m, "Bodies", doc("Bodies"));
  bind_calls(bodies);
  bind_properties(bodies);
}

}  // namespace dartcast::python::bodies
