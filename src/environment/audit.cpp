// Checks every particle's position in integers, by other code than the walk's.
#include "dartcast/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "environment/audit_integers.hpp"
#include "environment/audit_state.hpp"

namespace dartcast {

namespace {

using detail::AuditInteger;
using detail::counted;
using detail::is_in_range;
using detail::to_integers;
using detail::volume6;

constexpr std::size_t grain = 256;

std::string check_inside(const std::array<Vec3, 4>& corners, const Vec3& x) {
  if (!is_in_range(x) || counted(x) != x) return "the position is outside the exact range";
  for (const Vec3& corner : corners) {
    if (!is_in_range(corner)) return "a corner is not finite or outside the exact range";
  }
  const auto p =
      to_integers<5>({counted(corners[0]), counted(corners[1]), counted(corners[2]), counted(corners[3]), x});
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

}  // namespace

std::string detail::fault_of(const CellComplex& complex, const ParticleState& s, const Weights& held_weights) {
  const CombinatorialMap& map = complex.map();
  if (!map.contains(s.cell)) return "there is no such cell";
  if (s.simplex >= map.shape(s.cell).simplices().size()) return "the cell has no such simplex";
  if (s.held) return check_held(held_weights);
  if (!map.is_free(s.cell)) return "the cell is blocked";
  if (map.dimension() == 2 && s.position.z != 0.0) return "the position is not in the plane";
  return check_inside(complex.corners({s.cell, s.simplex}), s.position);
}

namespace {

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
      const std::string what = detail::fault_of(complex, particles[i], particles.held_weights(i));
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
