// Bodies made of triangles and edges, tossed about among walls.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "dartcast/solids.hpp"
#include "support/element_checks.hpp"

namespace dartcast::test {

/// An icosahedron, its triangles counterclockwise as seen from the outside; each halving quarters them.
inline SolidMesh ball(double radius, unsigned halvings = 0) {
  SolidMesh mesh;
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      mesh.points.insert(mesh.points.end(), {Vec3{0.0, a, b}, Vec3{a, b, 0.0}, Vec3{b, 0.0, a}});
    }
  }
  const auto near = [&](std::uint32_t i, std::uint32_t j) { return norm(mesh.points[i] - mesh.points[j]) < 2.1; };
  for (std::uint32_t i = 0; i < 12; ++i) {
    for (std::uint32_t j = i + 1; j < 12; ++j) {
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
        const Vec3 &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
        const bool outward = dot(cross(b - a, c - a), a + b + c) > 0.0;
        mesh.triangles.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  for (; halvings > 0; --halvings) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] = middles.insert({std::minmax(a, b), static_cast<std::uint32_t>(mesh.points.size())});
      if (added) mesh.points.push_back((mesh.points[a] + mesh.points[b]) * 0.5);
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> smaller;
    for (const auto& t : mesh.triangles) {
      const std::array m = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
      smaller.insert(smaller.end(), {{t[0], m[0], m[2]}, {t[1], m[1], m[0]}, {t[2], m[2], m[1]}, {m[0], m[1], m[2]}});
    }
    mesh.triangles = smaller;
  }
  for (Vec3& p : mesh.points) p = p * (radius / norm(p));
  return mesh;
}

/// A chain of edges along x.
inline SolidMesh rod(unsigned points, double spacing) {
  std::vector<Vec3> line;
  for (unsigned i = 0; i < points; ++i) line.push_back({spacing * i, 0.0, 0.0});
  return solid_of_polyline(line);
}

inline SolidMesh moved(SolidMesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.points) p += by;
  return mesh;
}

/// Bodies with velocities and stiff sides in a set of solids.
class TossedSolids {
 public:
  TossedSolids(Environment& environment, std::uint64_t seed) : solids(environment), random_(seed) {}

  /// Copies at random places of a box, as many as find room; each meets those before it, or none.
  void fill(const SolidMesh& mesh, std::size_t count, double box, bool meet = false) {
    std::vector<std::uint32_t> met;
    for (int tries = 0; tries < 5000 && solids.size() < count; ++tries) {
      const Vec3 at = {random_.uniform(0.0, box), random_.uniform(0.0, box), random_.uniform(0.0, box)};
      SolidMesh here = moved(mesh, at);
      const auto outside = [&](const Vec3& p) {
        return std::min({p.x, p.y, p.z}) < 0.0 || std::max({p.x, p.y, p.z}) > box;
      };
      if (std::any_of(here.points.begin(), here.points.end(), outside)) continue;
      const std::size_t first = solids.positions().size();
      for (auto s = static_cast<std::uint32_t>(met.size()); meet && s < solids.size(); ++s) met.push_back(s);
      if (solids.add(here, met).refusal != SolidRefusal::none) continue;
      std::vector<std::array<std::uint32_t, 2>> pairs = here.edges;
      for (const auto& t : here.triangles) pairs.insert(pairs.end(), {{t[0], t[1]}, {t[1], t[2]}, {t[2], t[0]}});
      for (const auto& [a, b] : pairs) sides_.push_back({first + a, first + b, norm(here.points[a] - here.points[b])});
    }
    velocities_.resize(solids.positions().size());
  }

  /// Targets of the next step: velocities, a pull that turns with time, and sides that keep their lengths.
  std::vector<Vec3> targets(double pull = 9.0, double dt = 0.02) {
    const double angle = 0.02 * steps_++;
    const auto x = solids.positions();
    std::vector<Vec3> y(x.begin(), x.end());
    const auto first = solids.first_vertices();
    for (std::size_t s = 0; s + 1 < first.size(); ++s) {
      const auto phase = angle + static_cast<double>(s);
      const Vec3 force = Vec3{std::cos(phase), std::sin(1.3 * angle), std::sin(phase)} * pull;
      for (std::size_t v = first[s]; v < first[s + 1]; ++v) {
        velocities_[v] = (velocities_[v] + force * dt) * 0.995;
        y[v] += velocities_[v] * dt;
      }
    }
    for (int sweep = 0; sweep < 10; ++sweep) {
      for (const Side& s : sides_) {
        const Vec3 way = y[s.b] - y[s.a];
        const double length = norm(way);
        if (!(length > 0.0)) continue;
        const Vec3 by = way * (0.5 * (length - s.length) / length);
        y[s.a] += by;
        y[s.b] -= by;
      }
    }
    before_.assign(x.begin(), x.end());
    return y;
  }

  /// Velocities of the step that was made.
  void follow(double dt = 0.02) {
    for (std::size_t v = 0; v < velocities_.size(); ++v)
      velocities_[v] = (solids.positions()[v] - before_[v]) * (1.0 / dt);
  }

  [[nodiscard]] const std::vector<Vec3>& before() const { return before_; }

  SolidSet solids;

 private:
  struct Side {
    std::size_t a, b;
    double length;
  };
  Random random_;
  std::vector<Side> sides_;
  std::vector<Vec3> velocities_;
  std::vector<Vec3> before_;
  int steps_ = 0;
};

}  // namespace dartcast::test
