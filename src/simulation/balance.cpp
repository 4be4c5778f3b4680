// Moves cells between ranks.
//
// Phases: Compare the ranks' loads. Divide the cells anew. Compare the loads that this gives. Move the cells, build the
// environment of the new part at rest, and give it all that belongs to its points. Move the particles, as a checkpoint
// and a resume on another number of ranks would.
#include "simulation/balance.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "parts/bisected.hpp"
#include "parts/moved_part.hpp"
#include "parts/part_cutter.hpp"
#include "simulation/simulation_parts.hpp"

namespace dartcast {

namespace {

// The time of a particle's step is that of moving the vertices of so many cells, about.
constexpr std::uint64_t weight_of_particle = 16 * weight_of_free_cell;

// Cells of a part by their handles in its own map.
class PlacesInMesh {
 public:
  explicit PlacesInMesh(const MeshData& mesh) {
    const std::vector<Cell> handles = handles_of(mesh);
    for (std::uint32_t c = 0; c < handles.size(); ++c) places_[handles[c].pool()].push_back(c);
  }
  [[nodiscard]] std::uint32_t operator[](Cell c) const { return places_[c.pool()][c.index()]; }

 private:
  std::array<std::vector<std::uint32_t>, 5> places_;
};

// The weight of each cell of the part; ghosts weigh nothing here.
std::vector<std::uint64_t> weights_of(const MeshPart& part, const Particles& particles, const PlacesInMesh& places) {
  std::vector<std::uint64_t> weights(part.cells.size());
  for (std::size_t c = 0; c < weights.size(); ++c) {
    if (part.owners[c] == part.part) weights[c] = weight_of_cell(part.mesh, c);
  }
  for (const ParticleState& p : particles.states()) weights[places[p.cell]] += weight_of_particle;
  return weights;
}

// Sums over all ranks of the loads that each has once the cells are with these owners.
std::vector<std::uint64_t> loads(const std::vector<std::uint64_t>& weights, std::span<const std::uint32_t> owners,
                                 Ranks& ranks) {
  std::vector<std::uint64_t> sums(ranks.size());
  for (std::size_t c = 0; c < weights.size(); ++c) sums[owners[c]] += weights[c];
  ranks.sum(sums);
  return sums;
}

std::uint64_t largest(const std::vector<std::uint64_t>& sums) { return *std::max_element(sums.begin(), sums.end()); }

bool is_uneven(const std::vector<std::uint64_t>& sums) {
  std::uint64_t all = 0;
  for (const std::uint64_t s : sums) all += s;
  return 5 * largest(sums) * sums.size() > 6 * all;
}

// The parts of own cells by the bisection; of ghosts, which others divide, the owner.
std::vector<std::uint32_t> divided(const MeshPart& part, const std::vector<std::uint64_t>& weights, Ranks& ranks) {
  const std::vector<Vec3> middles = middles_of(part.mesh);
  std::vector<Vec3> own;
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint64_t> own_weights;
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    if (part.owners[c] != part.part) continue;
    own.push_back(middles[c]);
    numbers.push_back(part.cells[c]);
    own_weights.push_back(weights[c]);
  }
  const std::vector<std::uint32_t> parts = bisected(own, numbers, own_weights, ranks.size(), &ranks);
  std::vector<std::uint32_t> next = part.owners;
  std::size_t at = 0;
  for (std::size_t c = 0; c < next.size(); ++c) {
    if (part.owners[c] == part.part) next[c] = parts[at++];
  }
  return next;
}

}  // namespace

void balance(Simulation::Parts& parts) {
  Ranks& ranks = *parts.particles.options().ranks;
  const MeshPart& part = *parts.part_mesh;
  const PlacesInMesh places(part.mesh);
  const std::vector<std::uint64_t> weights = weights_of(part, parts.particles.set().states, places);
  const std::vector<std::uint64_t> now = loads(weights, part.owners, ranks);
  if (!is_uneven(now)) return;
  std::vector<std::uint32_t> next = divided(part, weights, ranks);
  if (10 * largest(loads(weights, next, ranks)) > 9 * largest(now)) return;
  next = next_owners(part, std::move(next), ranks);
  const std::vector<std::string> leaving = parts.particles.packed_for([&](Cell here) { return next[places[here]]; });
  MeshPart moved = moved_part(part, next, ranks);
  parts.part->change(moved);
  *parts.part_mesh = std::move(moved);
  parts.set_motion(parts.motion_of_part(*parts.part_mesh, parts.environment.complex()));
  parts.inlets.change_part(parts.particles.sampled_part());
  parts.motion.stand_at(parts.motion.steps());
  parts.particles.take_over(ranks.exchange(leaving));
  ++parts.balanced;
}

}  // namespace dartcast
