// Checks every particle's position in integers, by other code than the walk's.
#include "dartcast/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"

namespace dartcast {

namespace {

using AuditInteger = boost::multiprecision::cpp_int;
using Point = std::array<AuditInteger, 3>;

constexpr std::size_t grain = 256;

// A double is digits * 2^exponent.
struct Digits {
  std::int64_t digits = 0;
  int exponent = 0;

  explicit Digits(double x) {
    const double fraction = std::frexp(x, &exponent);
    digits = static_cast<std::int64_t>(std::ldexp(fraction, 53));
    exponent -= 53;
  }
};

// Points as integers: coordinates over one power of two.
std::array<Point, 5> to_integers(const std::array<Vec3, 5>& points) {
  int lowest = std::numeric_limits<int>::max();
  const auto coordinates = [](const Vec3& p) { return std::array<double, 3>{p.x, p.y, p.z}; };
  for (const Vec3& p : points) {
    for (const double x : coordinates(p)) {
      if (x != 0.0) lowest = std::min(lowest, Digits(x).exponent);
    }
  }
  std::array<Point, 5> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = coordinates(points[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (x[k] == 0.0) continue;
      const Digits d(x[k]);
      result[i][k] = AuditInteger(d.digits) << static_cast<unsigned>(d.exponent - lowest);
    }
  }
  return result;
}

// Six times the volume of a tetrahedron.
AuditInteger volume6(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto minus = [&](const Point& p) {
    return Point{AuditInteger(p[0] - a[0]), AuditInteger(p[1] - a[1]), AuditInteger(p[2] - a[2])};
  };
  const Point u = minus(b);
  const Point v = minus(c);
  const Point w = minus(d);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

// The rule for coordinates (dartcast/predicates.hpp), in words of its own: no point is above 2^300; no particle is
// between 0 and 2^-300, and a corner that is there counts as 0.
bool is_below(const Vec3& p, double limit) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < limit && p == p;
}
Vec3 counted(const Vec3& p) {
  const auto number = [](double x) { return std::abs(x) < 0x1p-300 ? 0.0 : x; };
  return {number(p.x), number(p.y), number(p.z)};
}

std::string check_inside(const std::array<Vec3, 4>& corners, const Vec3& x) {
  if (!is_below(x, 0x1.0000000000001p+300) || counted(x) != x) return "the position is outside the exact range";
  for (const Vec3& corner : corners) {
    if (!is_below(corner, 0x1.0000000000001p+300)) return "a corner is not finite or outside the exact range";
  }
  const auto p = to_integers({counted(corners[0]), counted(corners[1]), counted(corners[2]), counted(corners[3]), x});
  const std::array<AuditInteger, 4> parts = {volume6(p[4], p[1], p[2], p[3]), volume6(p[0], p[4], p[2], p[3]),
                                             volume6(p[0], p[1], p[4], p[3]), volume6(p[0], p[1], p[2], p[4])};
  if (AuditInteger(parts[0] + parts[1] + parts[2] + parts[3]) <= 0) return "the simplex is not positive";
  const bool inside = std::all_of(parts.begin(), parts.end(), [](const AuditInteger& part) { return part >= 0; });
  return inside ? "" : "the position is outside its simplex";
}

std::string check_held(const Weights& weights) {
  const bool good = std::all_of(weights.begin(), weights.end(), [](double w) { return std::isfinite(w) && w >= 0.0; });
  return good ? "" : "a held particle's coordinates are not all finite and at least 0";
}

// The fault of a particle; empty where there is none.
std::string check(const CellComplex& complex, const Particles& particles, std::size_t i) {
  const ParticleState& s = particles[i];
  const CombinatorialMap& map = complex.map();
  if (!map.contains(s.cell)) return "there is no such cell";
  if (s.simplex >= map.shape(s.cell).simplices().size()) return "the cell has no such simplex";
  if (s.held) return check_held(particles.held_weights(i));
  if (!map.is_free(s.cell)) return "the cell is blocked";
  if (map.dimension() == 2 && s.position.z != 0.0) return "the position is not in the plane";
  return check_inside(complex.corners({s.cell, s.simplex}), s.position);
}

std::string describe(const CellComplex& complex, const ParticleState& s, std::size_t i, const std::string& what) {
  const std::string cell = complex.map().contains(s.cell) ? fmt::format("{}", complex.map().source(s.cell)) : "none";
  return fmt::format("particle {} at ({}, {}, {}), cell {}, simplex {}: {}", i, s.position.x, s.position.y,
                     s.position.z, cell, s.simplex, what);
}

}  // namespace

Audit& Audit::operator+=(const Audit& other) {
  checked += other.checked;
  failed += other.failed;
  if (first.empty()) first = other.first;
  return *this;
}

Audit audit(const CellComplex& complex, const Particles& particles, Threads threads) {
  std::vector<Audit> parts(chunk_count(particles.size(), grain));
  parallel_for(particles.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    Audit& part = parts[begin / grain];
    part.checked = end - begin;
    for (std::size_t i = begin; i < end; ++i) {
      const std::string what = check(complex, particles, i);
      if (what.empty()) continue;
      ++part.failed;
      if (part.first.empty()) part.first = describe(complex, particles[i], i, what);
    }
  });
  Audit sum;
  for (const Audit& part : parts) sum += part;
  return sum;
}

}  // namespace dartcast
