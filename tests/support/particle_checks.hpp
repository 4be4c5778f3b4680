// Checks of every particle after every call, without the library's predicates, and comparison to the bit.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"

namespace dartcast::test {

/// The first error of the particles that are not held: empty if each lies in the closed simplex named, of a free cell.
std::string check_states(const Environment& environment, const Particles& particles);

std::array<std::uint64_t, 3> bits(const Vec3& p);

bool same_bits(const ParticleState& a, const ParticleState& b);

std::vector<ParticleState> copy_of(const Particles& p);

bool same_bits(const std::vector<ParticleState>& a, const Particles& b);

Cell cell_at(Environment& environment, const Vec3& x);

std::vector<Vec3> positions_of(const Particles& particles);

/// Uniform points in a box.
template <class Random>
std::vector<Vec3> random_points(std::size_t n, const Vec3& low, const Vec3& high, Random& random) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = random.uniform(low.x, high.x);
    const double y = random.uniform(low.y, high.y);
    points.push_back({x, y, random.uniform(low.z, high.z)});
  }
  return points;
}

}  // namespace dartcast::test
