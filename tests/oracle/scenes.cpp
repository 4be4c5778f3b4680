#include "oracle/scenes.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "oracle/triangulation.hpp"

namespace dartcast::oracle {
namespace {

constexpr double edge = 2.0;  // of a cube of the box; the lattice of octahedra has twice that

double pick(Random& random, std::initializer_list<double> choices) {
  return choices.begin()[random.below(static_cast<std::uint32_t>(choices.size()))];
}

MeshData octahedra(Random& random) {
  OctahedraOptions o;
  for (std::uint32_t& n : o.cells) n = 1 + random.below(3);
  o.size = {2.0 * edge * o.cells[0], 2.0 * edge * o.cells[1], 2.0 * edge * o.cells[2]};
  o.blocked_layer = o.cells == std::array<std::uint32_t, 3>{3, 3, 3} && random.below(2) == 0;
  o.blocked_share = pick(random, {0.0, 0.1, 0.3, 0.5});
  o.seed = random.next();
  return generate_octahedra(o);
}

MeshData box(SceneKind kind, Random& random) {
  BoxOptions o;
  const std::uint32_t least = kind == SceneKind::slivers ? 2 : 1;  // they need points inside
  const std::uint32_t most = kind == SceneKind::hexahedra || kind == SceneKind::flat_corners ? 5 : 3;
  for (std::uint32_t& n : o.cells) n = least + random.below(most + 1 - least);
  o.size = {edge * o.cells[0], edge * o.cells[1], edge * o.cells[2]};
  o.mixed = kind == SceneKind::mixed;
  o.blocked_share = pick(random, {0.0, 0.1, 0.3, 0.5});
  o.seed = random.next();
  switch (kind) {
    case SceneKind::prisms: o.type = CellType::prism; break;
    case SceneKind::pyramids: o.type = CellType::pyramid; break;
    case SceneKind::tetrahedra:
    case SceneKind::slivers: o.type = CellType::tetrahedron; break;
    default: break;
  }
  return generate_box(o);
}

// Puts a vertex in the middle of some edges; every cell becomes a polyhedron.
MeshData with_flat_corners(MeshData mesh, Random& random) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;  // none: not cut
  MeshData result = mesh;
  result.types.clear();
  result.offsets = {0};
  result.connectivity.clear();
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto faces = faces_of(mesh, c);
    std::vector<std::uint32_t> cell = {static_cast<std::uint32_t>(faces.size())};
    for (const auto& face : faces) {
      const std::size_t count_at = cell.size();
      cell.push_back(0);
      for (std::size_t i = 0; i < face.size(); ++i) {
        const std::uint32_t a = face[i];
        const std::uint32_t b = face[(i + 1) % face.size()];
        const auto [found, is_new] = middle.try_emplace({std::min(a, b), std::max(a, b)}, none);
        if (is_new && random.below(8) == 0) {
          found->second = static_cast<std::uint32_t>(result.points.size());
          result.points.push_back((mesh.points[a] + mesh.points[b]) * 0.5);
        }
        cell.push_back(a);
        if (found->second != none) cell.push_back(found->second);
      }
      cell[count_at] = static_cast<std::uint32_t>(cell.size() - count_at - 1);
    }
    result.add_cell(CellType::polyhedron, cell);
  }
  result.patch_faces.clear();
  result.patch_offsets = {0};
  result.patch_tags.clear();
  return result;
}

// Fans and cones start at lowest-numbered vertices: other numbers, other simplices.
void renumber(MeshData& mesh, Random& random) {
  std::vector<std::uint32_t> number(mesh.points.size());
  std::iota(number.begin(), number.end(), 0U);
  for (std::uint32_t i = static_cast<std::uint32_t>(number.size()); i > 1; --i)
    std::swap(number[i - 1], number[random.below(i)]);
  std::vector<Vec3> points(mesh.points.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[number[i]] = mesh.points[i];
  mesh.points = std::move(points);
  for (std::uint32_t& v : mesh.patch_faces) v = number[v];
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    std::uint32_t* at = mesh.connectivity.data() + mesh.offsets[c];
    std::uint32_t* const end = mesh.connectivity.data() + mesh.offsets[c + 1];
    if (mesh.types[c] != CellType::polyhedron) {
      for (; at != end; ++at) *at = number[*at];
      continue;
    }
    for (++at; at != end;) {
      for (std::uint32_t left = *at++; left > 0; --left, ++at) *at = number[*at];
    }
  }
}

// Blocks one cell after another at random where the generator blocked whole cubes, so that walls run through cubes,
// too.
void block_single_cells(MeshData& mesh, Random& random) {
  const double share = pick(random, {0.0, 0.0, 0.1, 0.3});
  if (share == 0.0) return;
  mesh.free.resize(mesh.cell_count(), 1);
  for (auto& f : mesh.free) f = random.uniform() < share ? 0 : f;
}

void keep_one_free(MeshData& mesh) {
  if (!mesh.free.empty() && std::find(mesh.free.begin(), mesh.free.end(), 1) == mesh.free.end()) mesh.free[0] = 1;
}

void displace(std::vector<Vec3>& points, Random& random, double amplitude) {
  if (amplitude == 0.0) return;
  for (Vec3& p : points) {
    p += Vec3{random.uniform(-amplitude, amplitude), random.uniform(-amplitude, amplitude),
              random.uniform(-amplitude, amplitude)};
  }
}

void rotate(std::vector<Vec3>& points, Random& random) {
  const Vec3 axis = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.1, 1.0)};
  const Vec3 n = axis * (1.0 / norm(axis));
  const double angle = random.uniform(0.0, 6.28);
  for (Vec3& p : points) p = n * dot(n, p) + (p - n * dot(n, p)) * std::cos(angle) + cross(n, p) * std::sin(angle);
}

int orientation(const std::vector<Vec3>& points, std::span<const std::uint32_t> v) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto point = [&](std::size_t i) { return Kernel::Point_3(points[v[i]].x, points[v[i]].y, points[v[i]].z); };
  return static_cast<int>(CGAL::orientation(point(0), point(1), point(2), point(3)));
}

// Which points lie inside of the box that the points span.
std::vector<bool> inner_points(const std::vector<Vec3>& points) {
  Vec3 high;
  for (const Vec3& p : points) high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  std::vector<bool> inner;
  for (const Vec3& p : points)
    inner.push_back(p.x > 0 && p.y > 0 && p.z > 0 && p.x < high.x && p.y < high.y && p.z < high.z);
  return inner;
}

// Moves a corner of some tetrahedra almost into the opposite facet, where all around it stay positive. Inner points
// only: a boundary folded over itself would make cells overlap.
void squash(MeshData& mesh, const std::vector<bool>& inner, Random& random) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto v = mesh.cell(c);
    const std::uint32_t corner = random.below(4);
    if (!inner[v[corner]]) continue;
    Vec3& moved = mesh.points[v[corner]];
    const Vec3 before = moved;
    std::array<double, 3> weight = {random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), random.uniform(0.1, 1.0)};
    const double sum = weight[0] + weight[1] + weight[2];
    Vec3 foot;
    for (std::uint32_t i = 0; i < 3; ++i) foot += mesh.points[v[(corner + 1 + i) % 4]] * (weight[i] / sum);
    moved = foot + (before - foot) * pick(random, {1e-12, 1e-9, 1e-4});
    for (std::size_t other = 0; other < mesh.cell_count(); ++other) {
      if (orientation(mesh.points, mesh.cell(other)) <= 0) {
        moved = before;
        break;
      }
    }
  }
}

void scale_and_shift(std::vector<Vec3>& points, Random& random) {
  const Vec3 shift = Vec3{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)} *
                     pick(random, {0.0, 0.0, 10.0, 1e4});
  const double scale = std::ldexp(1.0, static_cast<int>(pick(random, {0.0, 0.0, 7.0, -20.0, 150.0, -150.0})));
  for (Vec3& p : points) p = (p + shift) * scale;
}

}  // namespace

std::string name_of(SceneKind kind) {
  static const std::array<const char*, scene_kinds> names = {"tetrahedra", "hexahedra", "prisms",       "pyramids",
                                                             "mixed",      "octahedra", "flat_corners", "slivers"};
  return names[static_cast<std::size_t>(kind)];
}

MeshData lattice_scene(SceneKind kind, std::uint64_t seed) {
  Random random(seed, 1);
  MeshData mesh = kind == SceneKind::octahedra ? octahedra(random) : box(kind, random);
  if (kind == SceneKind::flat_corners) mesh = with_flat_corners(std::move(mesh), random);
  block_single_cells(mesh, random);
  keep_one_free(mesh);
  renumber(mesh, random);
  return mesh;
}

MeshData random_scene(SceneKind kind, std::uint64_t seed, double warp) {
  MeshData mesh = lattice_scene(kind, seed);
  const std::vector<bool> inner = inner_points(mesh.points);
  Random random(seed, 2);
  const double most = kind == SceneKind::octahedra ? 0.15 : 0.3;
  displace(mesh.points, random, warp * most * edge * pick(random, {0.0, 0.01, 0.3, 0.6, 1.0}));
  if (kind == SceneKind::slivers) squash(mesh, inner, random);
  if (random.below(2) == 0 && kind != SceneKind::slivers) rotate(mesh.points, random);
  if (kind != SceneKind::slivers) scale_and_shift(mesh.points, random);
  return mesh;
}

MeshData long_box(std::uint64_t seed) {
  Random random(seed, 3);
  BoxOptions o;
  for (std::uint32_t& n : o.cells) n = 4 + random.below(7);
  o.size = {edge * o.cells[0], edge * o.cells[1], edge * o.cells[2]};
  o.mixed = seed % 4 == 1;
  o.blocked_share = pick(random, {0.0, 0.02, 0.1});
  o.seed = random.next();
  MeshData mesh = generate_box(o);
  renumber(mesh, random);
  if (seed % 4 == 0) return mesh;
  displace(mesh.points, random, 0.15 * edge * pick(random, {0.0, 0.01, 0.6, 1.0}));
  if (random.below(2) == 0) rotate(mesh.points, random);
  scale_and_shift(mesh.points, random);
  return mesh;
}

}  // namespace dartcast::oracle
