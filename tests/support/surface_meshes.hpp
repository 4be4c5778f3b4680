// Surfaces for tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/surface.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::test {

using Face = std::vector<std::uint32_t>;

inline MeshData surface_mesh(std::vector<Vec3> points, const std::vector<Face>& faces) {
  MeshData mesh;
  mesh.points = std::move(points);
  for (const Face& f : faces) {
    mesh.add_cell(f.size() == 3 ? CellType::triangle : f.size() == 4 ? CellType::quadrilateral : CellType::polygon, f);
  }
  return mesh;
}

/// The unit cube of six squares, turned outwards; its corners numbered x + 2 y + 4 z.
inline MeshData cube() {
  std::vector<Vec3> points;
  for (unsigned i = 0; i < 8; ++i) points.push_back({(i & 1U) * 1.0, (i >> 1U & 1U) * 1.0, (i >> 2U) * 1.0});
  return surface_mesh(std::move(points),
                      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

/// Edges of length sqrt(8).
inline MeshData tetrahedron() {
  return surface_mesh({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
}

/// A triangle mesh of the sphere: an octahedron, cut `rounds` times; counterclockwise from outside.
inline MeshData sphere(int rounds) {
  std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Face> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (fresh) {
        const Vec3 m = points[a] + points[b];
        points.push_back(m * (1.0 / norm(m)));
      }
      return at->second;
    };
    std::vector<Face> finer;
    for (const Face& f : faces) {
      const std::uint32_t a = middle(f[0], f[1]);
      const std::uint32_t b = middle(f[1], f[2]);
      const std::uint32_t c = middle(f[2], f[0]);
      for (const Face& g : {Face{f[0], a, c}, Face{a, f[1], b}, Face{c, b, f[2]}, Face{a, b, c}}) finer.push_back(g);
    }
    faces = std::move(finer);
  }
  return surface_mesh(std::move(points), faces);
}

/// With hills and valleys: radii in [1 - height, 1 + height].
inline MeshData bumpy(int rounds, double height, std::uint64_t seed) {
  MeshData mesh = sphere(rounds);
  Random random(seed);
  for (Vec3& p : mesh.points) p *= 1.0 + height * random.uniform(-1.0, 1.0);
  return mesh;
}

/// The hull of random points on an ellipsoid, by brute force.
inline MeshData random_hull(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> points;
  while (points.size() < count) {
    const Vec3 v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (const double r = norm(v); r > 0.1 && r < 1.0) points.push_back({v.x / r, 2.0 * v.y / r, 0.5 * v.z / r});
  }
  std::vector<Face> faces;
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      for (std::uint32_t c = b + 1; c < count; ++c) {
        int above = 0;
        int below = 0;
        for (std::uint32_t d = 0; d < count; ++d) {
          if (d == a || d == b || d == c) continue;
          (orient3d(points[a], points[b], points[c], points[d]) == Sign::positive ? above : below) += 1;
        }
        if (above == 0) faces.push_back({a, b, c});
        if (below == 0) faces.push_back({a, c, b});
      }
    }
  }
  return surface_mesh(std::move(points), faces);
}

/// The outer squares of the unit cubes that `solid` holds, with points shared by their places: no edge has four
/// squares where the cubes are chosen so.
template <class Solid>
MeshData voxel_surface(int size, Solid&& solid) {
  std::map<std::array<int, 3>, std::uint32_t> number;
  std::vector<Vec3> points;
  std::vector<Face> faces;
  const auto point = [&](std::array<int, 3> p) {
    const auto [at, fresh] = number.try_emplace(p, static_cast<std::uint32_t>(points.size()));
    if (fresh) points.push_back({p[0] * 1.0, p[1] * 1.0, p[2] * 1.0});
    return at->second;
  };
  for (int i = 0; i < size * size * size; ++i) {
    const std::array<int, 3> c = {i % size, i / size % size, i / size / size};
    if (!solid(c[0], c[1], c[2])) continue;
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        auto beyond = c;
        beyond[axis] += side == 1 ? 1 : -1;
        const bool inside = beyond[axis] >= 0 && beyond[axis] < size;
        if (inside && solid(beyond[0], beyond[1], beyond[2])) continue;
        Face f;
        for (unsigned k = 0; k < 4; ++k) {
          auto p = c;
          p[axis] += side;
          p[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
          p[(axis + 2) % 3] += k >= 2 ? 1 : 0;
          f.push_back(point(p));
        }
        if (side == 0) std::reverse(f.begin(), f.end());
        faces.push_back(f);
      }
    }
  }
  return surface_mesh(std::move(points), faces);
}

/// Some cubes on a floor of nine: vertices of three, four and five squares.
inline MeshData castle() {
  return voxel_surface(3, [](int x, int y, int z) {
    return z == 0 || (z == 1 && (x > 0 || y > 1)) || (z == 2 && x == 2 && y == 2) || (y == 0 && z == 2 && x == 1);
  });
}

/// A rotation about a random axis, and a shift.
struct Motion {
  std::array<Vec3, 3> axes;
  Vec3 shift;

  [[nodiscard]] Vec3 turned(const Vec3& v) const { return axes[0] * v.x + axes[1] * v.y + axes[2] * v.z; }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turned(p) + shift; }
};

inline Motion random_motion(Random& random) {
  const auto draw = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  Motion m;
  const Vec3 a = draw();
  m.axes[0] = a * (1.0 / norm(a));
  const Vec3 b = cross(m.axes[0], draw());
  m.axes[1] = b * (1.0 / norm(b));
  m.axes[2] = cross(m.axes[0], m.axes[1]);
  m.shift = draw();
  return m;
}

/// A random place inside of a triangle of a free face.
inline SurfacePlace random_place(const Surface& surface, Random& random) {
  const auto triangles = surface.triangles();
  SimplexId t;
  do {
    t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
  } while (!surface.map().is_free(t.cell));
  return surface.place(t, {random.uniform(0.01, 1.0), random.uniform(0.01, 1.0), random.uniform(0.01, 1.0)});
}

/// The distance between two points.
inline double gap(const Vec3& a, const Vec3& b) { return norm(a - b); }

/// The triangle of a face of the mesh, by its number there.
inline SimplexId triangle_of(const Surface& surface, std::uint32_t face, std::uint16_t number = 0) {
  for (const SimplexId t : surface.triangles()) {
    if (surface.map().source(t.cell) == face && t.simplex == number) return t;
  }
  return {};
}

}  // namespace dartcast::test
