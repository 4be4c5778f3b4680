// A simulation's sums over all ranks that share its particles, and one checkpoint of their parts.
//
// Particles count on each rank. Bodies and other parts that are repeated on each count on the first alone.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/reduced.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"
#include "environment/audit_of_all.hpp"
#include "simulation/particle_share.hpp"
#include "simulation/simulation_parts.hpp"
#include "simulation/simulation_state.hpp"

namespace dartcast {

namespace {

// All but what is the same on each rank, and times.
void add_sums(SimulationTotals& all, const SimulationTotals& t) {
  all.absorbed += t.absorbed;
  all.escaped += t.escaped;
  all.counters += t.counters;
  all.collisions += t.collisions;
  all.wall_overlaps += t.wall_overlaps;
  all.deepest_in_wall = std::max(all.deepest_in_wall, t.deepest_in_wall);
  for (std::size_t i = 0; i < all.contacts_by_patch.size(); ++i) {
    all.contacts_by_patch[i] += t.contacts_by_patch[i];
    all.deposited_by_patch[i] += t.deposited_by_patch[i];
    all.escaped_by_patch[i] += t.escaped_by_patch[i];
  }
}

// Digits of 32 bits, which are carried where they are read (CellTally::words()).
void add_words(std::span<const std::uint64_t> words, std::span<std::uint64_t> all) {
  for (std::size_t i = 0; i < words.size(); ++i) all[i] += words[i];
}

std::string packed(const SimulationTotals& t) {
  ByteWriter out;
  out.put(t.absorbed);
  out.put(t.escaped);
  out.put(t.counters);
  out.put(t.collisions);
  out.put(t.wall_overlaps);
  out.put(t.deepest_in_wall);
  out.put(t.contacts_by_patch);
  out.put(t.deposited_by_patch);
  out.put(t.escaped_by_patch);
  return out.bytes();
}

// In place of these fields of `t`.
void unpack(const std::string& bytes, SimulationTotals& t) {
  ByteReader in(bytes);
  t.absorbed = in.take<std::uint64_t>();
  t.escaped = in.take<std::uint64_t>();
  t.counters = in.take<Counters>();
  t.collisions = in.take<CollisionCounts>();
  t.wall_overlaps = in.take<std::uint64_t>();
  t.deepest_in_wall = in.take<double>();
  t.contacts_by_patch = in.take_list<std::uint64_t>();
  t.deposited_by_patch = in.take_list<std::uint64_t>();
  t.escaped_by_patch = in.take_list<std::uint64_t>();
}

}  // namespace

SimulationTotals Simulation::totals_of_all() const {
  const auto unpacked = [this](const std::string& bytes) {
    SimulationTotals t = totals();
    unpack(bytes, t);
    return t;
  };
  const auto pack = [](const SimulationTotals& t) { return packed(t); };
  return reduced(options().ranks, totals(), add_sums, pack, unpacked);
}

std::uint64_t Simulation::alive() const {
  std::uint64_t count = particles().size();
  sum_over(options().ranks, {&count, 1});
  return count;
}

std::optional<CellTally> Simulation::cell_tally() const {
  const CellTally* own = parts_->statistics.tally();
  if (own == nullptr) return {};
  CellTally all = *own;
  if (!are_several(options().ranks)) return all;
  std::vector<std::uint64_t> words = own->words();
  options().ranks->sum(words);
  all.set_words(words);
  return all;
}

SimulationEnergy Simulation::energy() const { return parts_->particles.energy(); }

Audit Simulation::audit() const {
  Audit own = parts_->particles.audit();
  for (const SimulationComponent* component : parts_->components) {
    if (component != &parts_->particles && parts_->particles.share().is_first()) own += component->audit();
  }
  return audit_of_all(options().ranks, own);
}

StateHash Simulation::state_hash() const {
  StateHash own = parts_->particles.state_hash();
  for (const SimulationComponent* component : parts_->components) {
    if (component != &parts_->particles && parts_->particles.share().is_first()) own += component->state_hash();
  }
  StateHash::Words words = own.words();
  sum_over(options().ranks, words);
  return StateHash(words);
}

SimulationCheckpoint joined(std::span<const SimulationCheckpoint> parts) {
  if (parts.empty()) throw InvalidArgument("joined: there is no checkpoint");
  SimulationState all = parts.front().state();
  for (const SimulationCheckpoint& part : parts.subspan(1)) {
    const ParticleSystemState& p = part.state().particles;
    if (p.steps != all.particles.steps)
      throw InvalidArgument(
          fmt::format("joined: one checkpoint is of step {}, another of step {}: join those that the "
                      "ranks have saved after the same step",
                      all.particles.steps, p.steps));
    // Without rows a file does not say how much user data they would have.
    if (all.particles.table.rows() == 0) (all.particles.table = p.table).truncate(0);
    for (std::size_t i = 0; i < p.table.rows(); ++i) all.particles.table.append(p.table, i);
    all.particles.gone += p.gone;
    const std::vector<std::uint64_t>& cells = part.state().statistics.cells;
    if (cells.size() == all.statistics.cells.size()) add_words(cells, all.statistics.cells);
    add_sums(all.particles.totals, p.totals);
  }
  all.particles.table.sort_by(all.particles.table.id);  // as one process has them
  return SimulationCheckpoint(std::move(all));
}

}  // namespace dartcast
