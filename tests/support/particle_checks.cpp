#include "support/particle_checks.hpp"

#include <bit>

#include "support/dyadic.hpp"

namespace dartcast::test {

std::string check_states(const Environment& environment, const Particles& particles) {
  const CombinatorialMap& map = environment.map();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const ParticleState& s = particles[i];
    if (s.held) continue;
    const std::string who = "particle " + std::to_string(i);
    if (!map.contains(s.cell) || s.simplex >= map.shape(s.cell).simplices().size()) return who + " is in no simplex";
    if (!map.is_free(s.cell)) return who + " is in blocked cell " + std::to_string(map.source(s.cell));
    const auto v = environment.complex().corners(s.at());
    for (unsigned k = 0; k < 4; ++k) {
      auto replaced = v;
      replaced[k] = s.position;
      if (!is_finite(s.position) || exact_sign(replaced[0], replaced[1], replaced[2], replaced[3]) < 0) {
        return who + " lies outside its simplex, in cell " + std::to_string(map.source(s.cell));
      }
    }
  }
  return {};
}

std::array<std::uint64_t, 3> bits(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y), std::bit_cast<std::uint64_t>(p.z)};
}

bool same_bits(const ParticleState& a, const ParticleState& b) {
  return bits(a.position) == bits(b.position) && a.cell == b.cell && a.simplex == b.simplex &&
         a.touching_count == b.touching_count && a.held == b.held && a.touching == b.touching;
}

std::vector<ParticleState> copy_of(const Particles& p) { return {p.states().begin(), p.states().end()}; }

bool same_bits(const std::vector<ParticleState>& a, const Particles& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!same_bits(a[i], b[i])) return false;
  }
  return true;
}

Cell cell_at(Environment& environment, const Vec3& x) { return environment.locate(x).simplex.cell; }

std::vector<Vec3> positions_of(const Particles& particles) {
  std::vector<Vec3> all;
  for (const ParticleState& s : particles.states()) all.push_back(s.position);
  return all;
}

}  // namespace dartcast::test
