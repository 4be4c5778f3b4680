// Saving the particles, going on from a saved state, and their hash.
#include <algorithm>

#include "dartcast/error.hpp"
#include "simulation/particle_system.hpp"
#include "tracking/batch/traveller.hpp"

namespace dartcast {

void ParticleSystem::save(SimulationState& state) const {
  ParticleSystemState& saved = state.particles;
  saved.steps = motion_.steps();
  saved.next_id = set_.next_id;
  saved.table = SavedParticles(set_.table);
  for (std::size_t i = 0; i < set_.states.size(); ++i) {
    saved.table[saved.table.state][i] = whole_state(i);
    saved.table[saved.table.held_weights][i] = set_.states.held_weights(i);
  }
  saved.totals = totals_;
  saved.gone = gone_;
  contacts_.save(saved);
}

void ParticleSystem::restore(const SimulationState& state) {
  const ParticleSystemState& saved = state.particles;
  const std::size_t patches = totals_.contacts_by_patch.size();
  if (saved.totals.contacts_by_patch.size() != patches || saved.totals.deposited_by_patch.size() != patches ||
      saved.totals.escaped_by_patch.size() != patches)
    throw InvalidArgument(
        "simulation: the checkpoint is of an environment with other patches: use the mesh that it was saved with");
  if (saved.table[saved.table.user_data].size() != saved.table.rows() * options_.user_data.size())
    throw InvalidArgument("simulation: the checkpoint has other user data: give the options that it was saved with");
  put_in_place_of_all(saved.table);
  contacts_.restore(saved);
  set_.next_id = saved.next_id;
  totals_ = {};
  totals_.start = saved.totals.start;
  totals_.injected = saved.totals.injected;
  for (auto* counts : {&totals_.contacts_by_patch, &totals_.deposited_by_patch, &totals_.escaped_by_patch})
    counts->resize(patches);
  gone_ = {};
  if (!share().is_first()) return;  // sums over all ranks have them once
  totals_ = saved.totals;
  gone_ = saved.gone;
}

bool ParticleSystem::is_mine(std::uint64_t id, const ParticleState& state) const {
  if (part_ == nullptr) return share().holds(id);
  const Cell here = part_->cells().here(state.cell);
  return here.valid() && part_->cells().is_own(here);
}

// Those that this rank holds.
void ParticleSystem::put_in_place_of_all(const SavedParticles& saved) {
  ParticleTable table = set_.table;
  table.truncate(0);
  std::vector<ParticleState> states;
  std::vector<Weights> weights;
  for (std::size_t i = 0; i < saved.rows(); ++i) {
    const ParticleState& state = saved[saved.state][i];
    if (!is_mine(saved[saved.id][i], state)) continue;
    states.push_back(part_ == nullptr ? state : state_here(part_->cells(), state));
    weights.push_back(saved[saved.held_weights][i]);
    table.append(saved, i);
    table[table.held].back() = state.held ? 1 : 0;
  }
  set_.states = environment_.restored(states, weights);
  set_.table = std::move(table);
  set_.count_spheres();
}

Audit ParticleSystem::audit() const {
  return dartcast::audit(environment_.complex(), set_.states, environment_.threads());
}

StateHash ParticleSystem::state_hash() const {
  StateHash hash = gone_;
  for (std::size_t i = 0; i < set_.states.size(); ++i)
    hash.add(set_.ids()[i], whole_state(i), set_.velocities()[i], static_cast<std::uint64_t>(set_.statuses()[i]));
  return hash;
}

}  // namespace dartcast
