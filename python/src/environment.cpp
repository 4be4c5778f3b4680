// Binds dartcast/environment.hpp: the class itself; its parts are in particles.cpp, environment_places.cpp,
// environment_motion.cpp and advance.cpp.
#include "dartcast/environment.hpp"

#include <string>
#include <vector>

#include "bind.hpp"
#include "dartcast/mesh_selection.hpp"
#include "dartcast/validity.hpp"
#include "environment_parts.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

std::shared_ptr<EnvironmentHandle> make_environment(const MeshData& mesh, Threads threads,
                                                    const std::optional<std::vector<std::string>>& free) {
  MeshData copy = mesh;
  if (free) select_free_regions(copy, *free);
  const py::gil_scoped_release release;
  auto made = std::make_shared<Environment>(std::move(copy), threads);
  auto handle = std::make_shared<EnvironmentHandle>();
  handle->environment = made.get();
  handle->owner = std::move(made);
  return handle;
}

std::shared_ptr<ComplexHandle> complex_of(const EnvironmentHandle& h) {
  return std::make_shared<ComplexHandle>(ComplexHandle{h.owner, &h.environment->complex(), nullptr, h.usage});
}

std::shared_ptr<MapHandle> map_of(const EnvironmentHandle& h) {
  return std::make_shared<MapHandle>(MapHandle{h.owner, &h.environment->map(), nullptr, h.usage});
}

void bind_records(py::module_& m) {
  bind_enum<OrphanPolicy>(
      m, "OrphanPolicy",
      {{"HOLD", OrphanPolicy::hold}, {"RELOCATE", OrphanPolicy::relocate}, {"ABSORB", OrphanPolicy::absorb}});
  Record<OrphanedParticle>(m, "OrphanedParticle")
      .field("particle", &OrphanedParticle::particle)
      .field("place", &OrphanedParticle::place)
      .field("position", &OrphanedParticle::position)
      .field("outcome", &OrphanedParticle::outcome)
      .field("distance", &OrphanedParticle::distance)
      .finish();
  Record<UpdateReport>(m, "UpdateReport")
      .field("touched", &UpdateReport::touched)
      .field("located", &UpdateReport::located)
      .field("orphaned", &UpdateReport::orphaned)
      .finish();
}

}  // namespace

void bind_environment(py::module_& m) {
  bind_records(m);
  bind_particles(m);
  EnvironmentClass c(m, "Environment", doc("Environment"));
  c.def(
      py::init(&make_environment), py::arg("mesh"), py::arg("threads") = 0, py::arg("free") = py::none(),
      (std::string(doc("Environment::Environment")) +
       "\n\nmesh: a copy is taken. free: the regions that particles may enter, as for select_free_regions(); None: as "
       "the mesh says.")
          .c_str());
  c.def_property_readonly("complex", &complex_of, "The complex, with positions.");
  c.def_property_readonly("map", &map_of, "The combinatorial map.");
  c.def_property_readonly(
      "positions",
      [](const EnvironmentHandle& h) {
        const Use use(*h.usage, the_environment);
        return read_only(array_of(h.environment->positions()));
      },
      (std::string(doc("Environment::positions")) + " float64 (n, 3).").c_str());
  c.def_property(
      "threads",
      [](const EnvironmentHandle& h) {
        const Use use(*h.usage, the_environment);
        return h.environment->threads();
      },
      [](const EnvironmentHandle& h, Threads threads) {
        const Use use(*h.usage, the_environment);
        h.environment->set_threads(threads);
      },
      "The number of threads that calls use; 0: all of the machine. Results never depend on it.");
  c.def(
      "validity",
      [](const EnvironmentHandle& h, std::size_t max_count) {
        const Use use(*h.usage, the_environment);
        const py::gil_scoped_release release;
        return h.environment->validity(max_count);
      },
      py::arg("max_count") = 10, doc("Environment::validity"));
  bind_places(c);
  bind_motion(m, c);
  bind_advance(m, c);
}

}  // namespace dartcast::python
