// When a segment of the lattice is in which closed cell, and what of it lies in: in integers, cell by cell and face by
// face of the mesh itself. Cells must be convex and faces flat.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/cell_shape.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/vec3.hpp"
#include "mesh/cell_types.hpp"
#include "support/exact_vectors.hpp"

namespace dartcast::test {

using Coordinate = std::int64_t;
using Whole = std::array<Coordinate, 3>;

inline Whole whole(const Vec3& v) {
  return {static_cast<Coordinate>(v.x), static_cast<Coordinate>(v.y), static_cast<Coordinate>(v.z)};
}

/// n / d, d > 0.
struct Ratio {
  Coordinate n, d;
  Ratio(Coordinate above, Coordinate below) : n(below < 0 ? -above : above), d(below < 0 ? -below : below) {
    const Coordinate g = std::gcd(n, d);
    n /= g;
    d /= g;
  }
  friend bool operator<(const Ratio& a, const Ratio& b) { return a.n * b.d < b.n * a.d; }
  friend bool operator==(const Ratio& a, const Ratio& b) { return a.n == b.n && a.d == b.d; }
  [[nodiscard]] double rounded() const { return static_cast<double>(n) / static_cast<double>(d); }
};

/// A point with coordinates x[i] / w.
struct WeightedPoint {
  Whole x;
  Coordinate w;
  WeightedPoint(const Whole& p, const Whole& q, const Ratio& t) : x{}, w(t.d) {
    for (std::size_t i = 0; i < 3; ++i) x[i] = p[i] * t.d + (q[i] - p[i]) * t.n;
  }
  [[nodiscard]] Vec3 rounded() const {
    const auto at = [&](std::size_t i) { return static_cast<double>(x[i]) / static_cast<double>(w); };
    return {at(0), at(1), at(2)};
  }
};

class CellsPassed {
 public:
  explicit CellsPassed(const MeshData& mesh) : cells_(mesh.cell_count()) {
    plane_ = dimension(mesh.types[0]) == 2;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      for_each_face(mesh, c, [&](std::span<const std::uint32_t> f) {
        std::vector<Whole> corners;
        for (const std::uint32_t v : f) corners.push_back(whole(mesh.points[v]));
        const Whole inwards =
            plane_ ? Whole{corners[0][1] - corners[1][1], corners[1][0] - corners[0][0], 0} : normal_of(corners);
        cells_[c].push_back({std::move(corners), inwards});
      });
    }
  }

  struct Stay {
    Ratio first, last;
  };
  /// While the segment is in the closed cell.
  [[nodiscard]] std::optional<Stay> stay(std::size_t cell, const Whole& p, const Whole& q) const {
    Stay stay{{0, 1}, {1, 1}};
    for (const Side& side : cells_[cell]) {
      const Coordinate before = side.height(p);
      const Coordinate after = side.height(q);
      if (before < 0 && after < 0) return {};
      if (before >= 0 && after >= 0) continue;
      const Ratio zero(before, before - after);
      if (before < 0 && stay.first < zero) stay.first = zero;
      if (after < 0 && zero < stay.last) stay.last = zero;
    }
    if (stay.last < stay.first) return {};
    return stay;
  }

  [[nodiscard]] bool holds(std::size_t cell, const WeightedPoint& x) const {
    for (const Side& side : cells_[cell]) {
      if (side.height(x) < 0) return false;
    }
    return true;
  }

  /// The kind of feature of the closed cell that x lies in.
  [[nodiscard]] Kind kind(std::size_t cell, const WeightedPoint& x) const {
    Kind found = plane_ ? Kind::face : Kind::volume;
    for (const Side& side : cells_[cell]) {
      if (side.height(x) != 0) continue;
      found = std::min(found, plane_ ? Kind::edge : Kind::face);
      for (std::size_t i = 0; i < side.corners.size(); ++i) {
        if (at_corner(side.corners[i], x)) return Kind::vertex;
        if (on_edge(side.corners[i], side.corners[(i + 1) % side.corners.size()], x))
          found = std::min(found, Kind::edge);
      }
    }
    return found;
  }

  [[nodiscard]] std::size_t size() const { return cells_.size(); }

  static bool at_corner(const Whole& a, const WeightedPoint& x) {
    return Whole{a[0] * x.w, a[1] * x.w, a[2] * x.w} == x.x;
  }
  /// Between a and b, the ends too.
  static bool on_edge(const Whole& a, const Whole& b, const WeightedPoint& x) {
    const Whole along = minus(b, a);
    const Whole from = minus(x.x, {a[0] * x.w, a[1] * x.w, a[2] * x.w});
    if (test::cross(along, from) != Whole{}) return false;
    const Coordinate place = dot(along, from);
    return place >= 0 && place <= dot(along, along) * x.w;
  }

 private:
  struct Side {
    std::vector<Whole> corners;
    Whole inwards;
    [[nodiscard]] Coordinate height(const Whole& x) const { return dot(inwards, minus(x, corners[0])); }
    [[nodiscard]] Coordinate height(const WeightedPoint& x) const {
      const Whole& a = corners[0];
      return dot(inwards, minus(x.x, {a[0] * x.w, a[1] * x.w, a[2] * x.w}));
    }
  };

  static Whole normal_of(const std::vector<Whole>& corners) {
    Whole sum{};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      const Whole n = test::cross(minus(corners[i + 1], corners[0]), minus(corners[i], corners[0]));
      for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k];
    }
    return sum;
  }

  bool plane_ = false;
  std::vector<std::vector<Side>> cells_;
};

}  // namespace dartcast::test
