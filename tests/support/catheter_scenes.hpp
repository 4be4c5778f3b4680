// Scenes that a catheter is tried in: the demo's vessel and pipes.
#pragma once

#include <cmath>
#include <vector>

#include "dartcast/catheter.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::test {

/// The vessel of scenes/vessel.toml, that pulses and bends in the same way.
struct MovingVessel {
  explicit MovingVessel(const VesselOptions& options = {}) : mesh(generate_vessel(options)) {}

  MeshData mesh;
  Environment environment{mesh};
  Deformation deformation{steps(), mesh.points};
  std::vector<Vec3> positions{mesh.points};

  void move_to(double time) {
    deformation.positions(time, positions);
    environment.move(positions);
  }
  /// With the catheter in it. Returns the share of the way that was made.
  double move_to(double time, Catheter& catheter) {
    deformation.positions(time, positions);
    return catheter.move_with(positions);
  }

  /// How far a point of the mesh is from the inlet, along the vessel.
  [[nodiscard]] double path(std::size_t point) const { return array("path_length").values[point]; }

  /// Where the middle of the trunk is now, so far from the inlet: the mean of the points there.
  [[nodiscard]] Vec3 centre(double from_inlet) const {
    Vec3 sum;
    double count = 0.0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      if (std::abs(path(i) - from_inlet) > 0.5e-3) continue;
      sum += environment.positions()[i];
      count += 1.0;
    }
    return sum * (1.0 / count);
  }

 private:
  [[nodiscard]] const DataArray& array(const char* name) const {
    for (const DataArray& a : mesh.point_data) {
      if (a.name == name) return a;
    }
    throw InvalidArgument(name);
  }

  [[nodiscard]] std::vector<DeformationStep> steps() const {
    DeformationStep pulse;
    pulse.kind = DeformationKind::pulse;
    pulse.amplitude = 0.12;
    pulse.period = 0.1;
    pulse.wavelength = 0.12;
    const std::vector<double>& e = array("pulse_direction").values;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) pulse.field.push_back({e[3 * i], e[3 * i + 1], e[3 * i + 2]});
    pulse.path = array("path_length").values;
    DeformationStep bend;
    bend.kind = DeformationKind::bend;
    bend.amplitude = 0.8;
    bend.period = 0.3;
    bend.direction = {0.0, 1.0, 0.0};
    bend.length = 0.06;
    return {pulse, bend};
  }
};

/// The same vessel of a tenth of the cells.
inline VesselOptions coarse_vessel() {
  VesselOptions o;
  o.core = 4;
  o.rings = 2;
  o.tissue_layers = 1;
  o.step_length = 1.5e-3;
  return o;
}

/// A straight pipe along z from 0 to `length` with a square lumen of width 3 (unit cubes) around the line x = y = 2.5,
/// closed at both ends.
inline MeshData pipe(std::uint32_t length) {
  BoxOptions box;
  box.cells = {5, 5, length};
  box.size = {5.0, 5.0, static_cast<double>(length)};
  box.blocked_layer = true;
  return generate_box(box);
}

}  // namespace dartcast::test
