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
                                    const py::object& responses) {
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

AddBodyResult add(Handle& self, const py::object& points, const BodyOptions& options) {
  const Use use = self.use();
  const auto x = vectors(points, "points");
  const BodyOptions own_options = options;
  Bodies& bodies = self.changeable();
  const py::gil_scoped_release release;
  return bodies.add(x, own_options);
}

BodiesStep step(Handle& self) {
  const Use use = self.use();
  Bodies& bodies = self.changeable();
  const py::gil_scoped_release release;
  return bodies.step();
}

UpdateReport update_after_edit(Handle& self, OrphanPolicy orphaned) {
  const Use use = self.use();
  Bodies& bodies = self.changeable();
  const py::gil_scoped_release release;
  return bodies.update_after_edit(orphaned);
}

void restore(Handle& self, const BodiesCheckpoint& saved) {
  const Use use = self.use();
  Bodies& bodies = self.changeable();
  const BodiesCheckpoint own = saved;
  const py::gil_scoped_release release;
  bodies.restore(own);
}

void check_body(const Bodies& bodies, std::size_t body) {
  if (body >= bodies.size())
    throw InvalidArgument("there is no body " + std::to_string(body) + ": there are " + std::to_string(bodies.size()));
}

// A function of one body, which is there.
template <class F>
auto of_body(F&& f) {
  return [f](const Handle& self, std::size_t body) {
    const Use use = self.use();
    check_body(*self.solid, body);
    return f(std::as_const(*self.solid), body);
  };
}

// A property: `f` gives a value or a span of the bodies, of which Python gets a copy.
template <class F>
auto property(F&& f) {
  return [f](const Handle& self) {
    const Use use = self.use();
    return without_writing(f(std::as_const(*self.solid)));
  };
}

bool is_finite_motion(const RigidMover& m) {
  const auto finite = [](const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  return std::isfinite(m.inverse_mass) && finite(m.centre) && finite(m.velocity) && finite(m.angular_velocity) &&
         finite(m.position_delta) && finite(m.rotation_delta);
}

void apply_impulse(Handle& self, std::size_t body, const RigidMover& solved) {
  const Use use = self.use();
  check_body(*self.solid, body);
  if (!is_finite_motion(solved)) throw InvalidArgument("apply_impulse: the state has a number that is not finite");
  self.changeable().apply_impulse(body, solved);
}

void set_velocities(Handle& self, const py::object& given) {
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

template <class T>
py::array copied(std::span<const T> values) {
  return array_of(values);
}
py::array statuses(std::span<const ParticleStatus> fates) {
  std::vector<std::uint8_t> numbers;
  for (const ParticleStatus s : fates) numbers.push_back(static_cast<std::uint8_t>(s));
  return array_of(std::move(numbers));
}

void bind_calls(Class& bodies) {
  const std::string text = std::string(doc("Bodies::Bodies")) +
                           "\n\nresponses: one such as Reflect(0.5), a dict of them by the names of patches, or "
                           "WallResponses; None: reflection without loss.";
  bodies
      .def(py::init(&make_bodies), py::arg("environment").none(false), py::arg("options"),
           py::arg("responses") = py::none(), text.c_str())
      .def("add", &add, py::arg("points"), py::arg("options"), doc("Bodies::add"))
      .def("step", &step, doc("Bodies::step"))
      .def("move_with", &move_with<Bodies>, py::arg("positions"),
           (std::string(doc("Bodies::move_with")) + "\n\npositions: float64 (n, 3).").c_str())
      .def("predicted_state", of_body([](const Bodies& b, std::size_t i) { return b.predicted_state(i); }),
           py::arg("body"), doc("Bodies::predicted_state"))
      .def("apply_impulse", &apply_impulse, py::arg("body"), py::arg("solved"), doc("Bodies::apply_impulse"))
      .def("update_after_edit", &update_after_edit, py::arg("orphaned") = OrphanPolicy::relocate,
           doc("Bodies::update_after_edit"))
      .def(
          "checkpoint",
          [](const Handle& self) {
            const Use use = self.use();
            return self.solid->checkpoint();
          },
          doc("Bodies::checkpoint"))
      .def("restore", &restore, py::arg("saved"), doc("Bodies::restore"));
}

void bind_single(Class& bodies) {
  bodies.def("id", of_body([](const Bodies& b, std::size_t i) { return b.id(i); }), py::arg("body"), "The body's id.")
      .def("first_particle", of_body([](const Bodies& b, std::size_t i) { return b.first_particle(i); }),
           py::arg("body"), doc("Bodies::first_particle"))
      .def("particle_count", of_body([](const Bodies& b, std::size_t i) { return b.particle_count(i); }),
           py::arg("body"), "The number of its particles.")
      .def("fits", of_body([](const Bodies& b, std::size_t i) {
             const auto fits = b.fits(i);
             return std::vector<Fit>(fits.begin(), fits.end());
           }),
           py::arg("body"), doc("Bodies::fits"))
      .def("surface", of_body([](const Bodies& b, std::size_t i) { return array_of(b.surface(i)); }), py::arg("body"),
           (std::string(doc("Bodies::surface")) + "\n\nA copy: float64 (n, 3).").c_str())
      .def("energy", of_body([](const Bodies& b, std::size_t i) { return b.energy(i); }), py::arg("body"),
           "Its energy, J.")
      .def("rigid_motion_of", of_body([](const Bodies& b, std::size_t i) { return b.rigid_motion_of(i); }),
           py::arg("body"), "The rigid motion with its momentum.");
}

void bind_properties(Class& bodies) {
  const auto size = [](const Handle& self) {
    const Use use = self.use();
    return self.solid->size();
  };
  bodies.def("__len__", size)
      .def_property_readonly("size", size, "The number of bodies.")
      .def_property_readonly(
          "environment", [](const Handle& self) { return self.environment; }, "The environment.")
      .def_property_readonly("options", property([](const Bodies& b) { return py::cast(b.options()); }), "A copy.")
      .def_property_readonly("steps", property([](const Bodies& b) { return py::cast(b.steps()); }), "Steps done.")
      .def_property_readonly("particles", property([](const Bodies& b) {
                               auto copy = std::make_shared<ParticlesHandle>();
                               copy->particles = b.particles();
                               return py::cast(copy);
                             }),
                             "A copy of all particles, body by body.")
      .def_property_readonly("positions", property([](const Bodies& b) { return array_of(b.positions()); }),
                             "Of all particles, float64 (n, 3).")
      .def_property("velocities", property([](const Bodies& b) { return array_of(b.velocities()); }), &set_velocities,
                    "Of all particles, float64 (n, 3): a copy. Set all of them for impulses between steps.")
      .def_property_readonly("masses", property([](const Bodies& b) { return copied(b.masses()); }), "float64 (n,).")
      .def_property_readonly("radii", property([](const Bodies& b) { return copied(b.radii()); }), "float64 (n,).")
      .def_property_readonly("body_of", property([](const Bodies& b) { return copied(b.body_of()); }),
                             doc("Bodies::body_of"))
      .def_property_readonly("fates", property([](const Bodies& b) { return statuses(b.fates()); }),
                             "Of all particles, uint8 (n,): values of ParticleStatus.")
      .def_property_readonly("counters", property([](const Bodies& b) { return py::cast(b.counters()); }),
                             doc("Bodies::counters"))
      .def("audit", property([](const Bodies& b) { return py::cast(b.audit()); }), doc("Bodies::audit"))
      .def("state_hash", property([](const Bodies& b) { return py::cast(b.state_hash()); }), doc("Bodies::state_hash"));
}

}  // namespace

void bind(py::module_& m) {
  bodies_records::bind(m);
  Class bodies(m, "Bodies", doc("Bodies"));
  bind_calls(bodies);
  bind_single(bodies);
  bind_properties(bodies);
}

}  // namespace dartcast::python::bodies
