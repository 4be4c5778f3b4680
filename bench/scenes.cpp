// The scenes of the workloads: meshes, and how their vertices move.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/workload.hpp"
#include "dartcast/generators.hpp"
#include "generators/generate_blocked.hpp"

namespace dartcast::bench {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

MeshData box(std::uint32_t size, double blocked_share) {
  BoxOptions options;
  options.cells = {size, size, size};
  options.size = Vec3{1.0, 1.0, 1.0} * size;
  options.blocked_layer = true;
  options.blocked_share = blocked_share;
  return generate_box(options);
}

MeshData squares(std::uint32_t size, double blocked_share) {
  RectangleOptions options;
  options.cells = {size, size};
  options.size = {double(size), double(size)};
  MeshData mesh = generate_rectangle(options);
  std::vector<std::uint8_t> blocked(mesh.cell_count(), 0);
  for (std::uint32_t i = 0; i < size; ++i) {
    for (const std::uint32_t cell : {i, size * (size - 1) + i, size * i, size * i + size - 1}) blocked[cell] = 1;
  }
  block_share(blocked, blocked_share, options.seed);
  mesh.free.assign(blocked.size(), 1);
  for (std::size_t cell = 0; cell < blocked.size(); ++cell) mesh.free[cell] = blocked[cell] == 0 ? 1 : 0;
  return mesh;
}

// One prism's faces: the two polygons, then the sides. Points of a layer follow one another.
std::vector<std::uint32_t> prism(std::uint32_t corners, std::uint32_t layer) {
  const std::uint32_t low = layer * corners;
  const std::uint32_t high = low + corners;
  std::vector<std::uint32_t> faces = {corners + 2, corners};
  for (std::uint32_t i = corners; i > 0; --i) faces.push_back(low + i - 1);
  faces.push_back(corners);
  for (std::uint32_t i = 0; i < corners; ++i) faces.push_back(high + i);
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t j = (i + 1) % corners;
    faces.insert(faces.end(), {4, low + i, low + j, high + j, high + i});
  }
  return faces;
}

// The polygon's inner circle has the diameter 1, as the prisms have the height 1.
MeshData tube(std::uint32_t corners) {
  constexpr std::uint32_t layers = 1000;
  const double radius = 0.5 / std::cos(0.5 * turn / corners);
  MeshData mesh;
  for (std::uint32_t layer = 0; layer <= layers; ++layer) {
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = turn * i / corners;
      mesh.points.push_back({radius * std::cos(angle), radius * std::sin(angle), static_cast<double>(layer)});
    }
  }
  for (std::uint32_t layer = 0; layer < layers; ++layer) mesh.add_cell(CellType::polyhedron, prism(corners, layer));
  return mesh;
}

DeformationStep about(DeformationKind kind, const Vec3& centre, double amplitude, double period, double length) {
  DeformationStep step;
  step.kind = kind;
  step.centre = centre;
  step.amplitude = amplitude;
  step.period = period;
  step.length = length;
  return step;
}

// Periods grow with the box, so that its vertices are no faster.
std::vector<DeformationStep> box_deformation(double size) {
  constexpr double fastest = 0.02;  // of a vertex in each of the three, cells a step
  constexpr double amplitude = 0.5;
  const Vec3 centre = Vec3{0.5, 0.5, 0.5} * size;
  const double farthest = 0.5 * std::sqrt(3.0) * size;
  // Bent by the angle A over its length s, a box's corner goes as far as 3/8 A s; twisted by as much, a little less.
  const double swing = turn * 0.375 * amplitude * size / fastest;
  return {about(DeformationKind::twist, centre, amplitude, swing, size),
          about(DeformationKind::bend, centre, amplitude, swing, size),
          about(DeformationKind::rotate, centre, 0.0, turn * farthest / fastest, size)};
}

// In the plane: bent about a line across it, and turned.
std::vector<DeformationStep> square_deformation(double size) {
  constexpr double fastest = 0.03;  // of a vertex in each of the two, cells a step
  constexpr double amplitude = 0.5;
  const Vec3 centre = Vec3{0.5, 0.5, 0.0} * size;
  const double farthest = 0.5 * std::sqrt(2.0) * size;
  const double swing = turn * 0.375 * amplitude * size / fastest;
  std::vector<DeformationStep> steps = {about(DeformationKind::bend, centre, amplitude, swing, size),
                                        about(DeformationKind::rotate, centre, 0.0, turn * farthest / fastest, size)};
  steps[0].axis = {0.0, 1.0, 0.0};
  return steps;
}

std::vector<DeformationStep> bar_deformation() {
  const Vec3 centre = {2.5, 2.5, 14.0};
  std::vector<DeformationStep> steps = {about(DeformationKind::twist, centre, 1.5, 4.0, 14.0),
                                        about(DeformationKind::bend, centre, 0.8, 3.0, 14.0),
                                        about(DeformationKind::rotate, centre, 0.0, 10.0, 14.0)};
  steps[2].axis = {0.0, 1.0, 0.0};
  return steps;
}

const std::vector<double>& values(const MeshData& mesh, std::string_view name) {
  return std::find_if(mesh.point_data.begin(), mesh.point_data.end(),
                      [&](const DataArray& a) { return a.name == name; })
      ->values;
}

std::vector<DeformationStep> vessel_deformation(const MeshData& mesh) {
  std::vector<DeformationStep> steps = {about(DeformationKind::pulse, {}, 0.12, 0.1, 1.0),
                                        about(DeformationKind::bend, {}, 0.8, 0.3, 0.06)};
  steps[0].wavelength = 0.12;
  steps[0].path = values(mesh, "path_length");
  steps[0].field = vectors(mesh, "pulse_direction");
  steps[1].direction = {0.0, 1.0, 0.0};
  return steps;
}

}  // namespace

std::vector<Vec3> vectors(const MeshData& mesh, std::string_view name) {
  const std::vector<double>& v = values(mesh, name);
  std::vector<Vec3> list(v.size() / 3);
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  return list;
}

MeshData mesh_of(const WorkloadOptions& options) {
  switch (options.scene) {
    case Scene::tube: return tube(options.size);
    case Scene::bar: return generate_bar();
    case Scene::vessel: return generate_vessel();
    case Scene::squares: return squares(options.size, options.blocked_share);
    case Scene::box:
    case Scene::lattice: break;
  }
  return box(options.size, options.blocked_share);
}

std::vector<DeformationStep> deformation_of(const WorkloadOptions& options, const MeshData& mesh) {
  if (!options.deforms) return {};
  if (options.scene == Scene::bar) return bar_deformation();
  if (options.scene == Scene::vessel) return vessel_deformation(mesh);
  if (options.scene == Scene::squares) return square_deformation(options.size);
  return box_deformation(options.size);
}

}  // namespace dartcast::bench
