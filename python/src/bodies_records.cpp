// The records of dartcast/bodies.hpp, and the functions that sample surfaces.
#include <string>
#include <utility>

#include "bodies_handle.hpp"
#include "dartcast/bodies.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::bodies_records {
namespace {

void bind_options(py::module_& m) {
  Record<SamplingOptions>(m, "SamplingOptions")
      .field("spacing", &SamplingOptions::spacing)
      .field("seed", &SamplingOptions::seed)
      .field("max_count", &SamplingOptions::max_count)
      .finish();
  Record<BodyCollisionOptions>(m, "BodyCollisionOptions")
      .field("restitution", &BodyCollisionOptions::restitution)
      .field("friction", &BodyCollisionOptions::friction)
      .field("iterations", &BodyCollisionOptions::iterations)
      .field("position_correction", &BodyCollisionOptions::position_correction)
      .finish();
  Record<BodiesOptions>(m, "BodiesOptions")
      .field("dt", &BodiesOptions::dt)
      .field("gravity", &BodiesOptions::gravity)
      .field("drag", &BodiesOptions::drag)
      .field("collisions", &BodiesOptions::collisions)
      .field("step", &BodiesOptions::step)
      .finish();
  Record<MatchOptions>(m, "MatchOptions")
      .field("linear", &MatchOptions::linear)
      .field("keep_volume", &MatchOptions::keep_volume)
      .field("clusters", &MatchOptions::clusters)
      .finish();
  Record<BodyOptions>(m, "BodyOptions")
      .field("mass", &BodyOptions::mass)
      .field("masses", &BodyOptions::masses)
      .field("radius", &BodyOptions::radius)
      .field("stiffness", &BodyOptions::stiffness)
      .field("pull", &BodyOptions::pull)
      .field("damping", &BodyOptions::damping)
      .field("velocity", &BodyOptions::velocity)
      .field("angular_velocity", &BodyOptions::angular_velocity)
      .field("match", &BodyOptions::match)
      .field("surface", &BodyOptions::surface)
      .finish();
}

void bind_states(py::module_& m) {
  Record<AddBodyResult>(m, "AddBodyResult")
      .field("body", &AddBodyResult::body)
      .field("refused", &AddBodyResult::refused)
      .field("surface", &AddBodyResult::surface)
      .finish();
  Record<BodyEnergy>(m, "BodyEnergy")
      .field("kinetic", &BodyEnergy::kinetic)
      .field("potential", &BodyEnergy::potential)
      .field("matching", &BodyEnergy::matching)
      .def_property_readonly("total", &BodyEnergy::total, "The sum of the three.")
      .finish();
  Record<RigidMotion>(m, "RigidMotion")
      .field("mass", &RigidMotion::mass)
      .field("centre", &RigidMotion::centre)
      .field("velocity", &RigidMotion::velocity)
      .field("angular_momentum", &RigidMotion::angular_momentum)
      .field("angular_velocity", &RigidMotion::angular_velocity)
      .def("velocity_at", &RigidMotion::velocity_at, py::arg("x"), "The velocity of the rigid motion at a point.")
      .def_property_readonly("kinetic_energy", &RigidMotion::kinetic_energy, doc("RigidMotion::kinetic_energy"))
      .finish();
  Record<Fit>(m, "Fit")
      .field("rotation", &Fit::rotation)
      .field("centre", &Fit::centre)
      .field("transform", &Fit::transform)
      .field("strain", &Fit::strain)
      .finish();
}

void bind_reports(py::module_& m) {
  Record<BodyCollisionCounts>(m, "BodyCollisionCounts")
      .field("pairs_near", &BodyCollisionCounts::pairs_near)
      .field("pairs_touching", &BodyCollisionCounts::pairs_touching)
      .field("impacts", &BodyCollisionCounts::impacts)
      .field("overlaps", &BodyCollisionCounts::overlaps)
      .field("deepest", &BodyCollisionCounts::deepest)
      .finish();
  Record<BodiesStep>(m, "BodiesStep")
      .field("motion", &BodiesStep::motion)
      .field("pull", &BodiesStep::pull)
      .field("collisions", &BodiesStep::collisions)
      .field("input", &BodiesStep::input)
      .field("fallbacks", &BodiesStep::fallbacks)
      .field("repeated", &BodiesStep::repeated)
      .field("gone", &BodiesStep::gone)
      .field("stuck", &BodiesStep::stuck)
      .def_property_readonly(
          "edges", [](const BodiesStep& s) { return rows_of(s.edges); },
          (std::string(doc("BodiesStep::edges")) + "\n\nA structured array with the columns of SolidStep.contacts.")
              .c_str())
      .finish();
}

// A member that can be read only.
template <class T, class M>
auto reading(M T::*member) {
  return [member](const T& t) { return without_writing(py::cast(t.*member)); };
}

// Checkpoints cannot be made or changed in Python: bodies trust the ones that they get.
void bind_checkpoint(py::module_& m) {
  using Checkpoint = BodiesCheckpoint;
  using Particle = BodiesCheckpoint::Particle;
  py::class_<Checkpoint> checkpoint(m, "BodiesCheckpoint", doc("BodiesCheckpoint"));
  py::class_<Particle>(checkpoint, "Particle", doc("BodiesCheckpoint::Particle"))
      .def_property_readonly("state", reading(&Particle::state))
      .def_property_readonly("held_weights", reading(&Particle::held_weights))
      .def_property_readonly("velocity", reading(&Particle::velocity))
      .def_property_readonly("fate", reading(&Particle::fate))
      .def_property_readonly(
          "on",
          [](const Particle& p) { return std::vector<CellFace>(p.on.face.begin(), p.on.face.begin() + p.on.count); },
          doc("TouchedFaces"));
  checkpoint.def_property_readonly("steps", reading(&Checkpoint::steps))
      .def_property_readonly("counters", reading(&Checkpoint::counters))
      .def_property_readonly("ids", reading(&Checkpoint::ids), doc("BodiesCheckpoint::ids"))
      .def_property_readonly("fits", reading(&Checkpoint::fits), doc("BodiesCheckpoint::fits"))
      .def_property_readonly("impulses", reading(&Checkpoint::impulses))
      .def_property_readonly("particles", reading(&Checkpoint::particles))
      .def_property_readonly("surfaces", reading(&Checkpoint::surfaces));
}

// Calls f(surface) without Python's lock, on a surface that nobody else changes.
template <class F>
auto of_surface(const MeshData& surface, const SamplingOptions& options, F&& f) {
  const MeshData own = surface;
  const SamplingOptions own_options = options;
  const py::gil_scoped_release release;
  return f(own, own_options);
}

std::vector<std::vector<std::uint32_t>> clusters(const py::object& points, double size) {
  const auto x = vectors(points, "points");
  const py::gil_scoped_release release;
  return overlapping_clusters(x, size);
}

void bind_sampling(py::module_& m) {
  m.def(
      "sample_surface",
      [](const MeshData& surface, const SamplingOptions& options) {
        return of_surface(surface, options, sample_surface);
      },
      py::arg("surface"), py::arg("options"), doc("sample_surface"));
  m.def(
      "sample_volume",
      [](const MeshData& surface, const SamplingOptions& options) {
        return of_surface(surface, options, sample_volume);
      },
      py::arg("surface"), py::arg("options"), doc("sample_volume"));
  Record<SolidSamples>(m, "SolidSamples")
      .field("points", &SolidSamples::points)
      .field("on_surface", &SolidSamples::on_surface)
      .finish();
  m.def(
      "sample_solid",
      [](const MeshData& surface, const SamplingOptions& options) {
        return of_surface(surface, options, sample_solid);
      },
      py::arg("surface"), py::arg("options"), doc("sample_solid"));
  m.def("overlapping_clusters", &clusters, py::arg("points"), py::arg("size"), doc("overlapping_clusters"));
}

}  // namespace

void bind(py::module_& m) {
  m.attr("SURFACE_COVER") = surface_cover;
  m.attr("CELL_DIAGONAL") = cell_diagonal;
  m.attr("VOLUME_COVER") = volume_cover;
  m.attr("SOLID_COVER") = solid_cover;
  m.attr("ENERGY_SLACK") = energy_slack;
  bind_options(m);
  bind_states(m);
  bind_reports(m);
  bind_checkpoint(m);
  bind_sampling(m);
}

}  // namespace dartcast::python::bodies_records
