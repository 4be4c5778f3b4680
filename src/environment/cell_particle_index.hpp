// Which particles are in a cell, or touch a wall of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "dartcast/particle_state.hpp"

namespace dartcast::detail {

/// Lists of particles by cell. An entry may be out of date, if a particle has left since. A reader checks the
/// particle's state. Such entries stay: most are soon out of date if particles follow many edits without a step.
class CellParticleIndex {
 public:
  /// Cost: linear in the particles.
  explicit CellParticleIndex(std::span<const ParticleState> states) {
    first_.reserve(states.size());
    entries_.reserve(states.size());
    for (std::uint32_t i = 0; i < states.size(); ++i) add(i, states[i]);
    made_with_ = entries_.size();
  }

  /// Whether most entries may be out of date. A new index then costs no more than adding them did.
  [[nodiscard]] bool is_outdated() const { return entries_.size() > 2 * made_with_ + smallest; }

  void add(std::uint32_t particle, const ParticleState& state) {
    add(particle, state.cell);
    for (unsigned k = 0; k < state.touching_count; ++k) {
      if (state.touching[k].cell != state.cell) add(particle, state.touching[k].cell);
    }
  }

  /// Forgets a cell's list.
  void clear(Cell c) { first_.erase(c.value); }

  template <class Visit>
  void for_each(Cell c, Visit&& visit) const {
    const auto found = first_.find(c.value);
    if (found == first_.end()) return;
    for (std::size_t e = found->second; e != none; e = entries_[e].next) visit(entries_[e].particle);
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  static constexpr std::size_t smallest = 64;  // entries for which a new index is not worth it

  struct Entry {
    std::uint32_t particle;
    std::size_t next;  // there may be more entries than particles
  };

  void add(std::uint32_t particle, Cell c) {
    const auto [found, fresh] = first_.try_emplace(c.value, none);
    entries_.push_back({particle, found->second});
    found->second = entries_.size() - 1;
  }

  std::unordered_map<std::uint32_t, std::size_t> first_;  // entry of a cell
  std::vector<Entry> entries_;
  std::size_t made_with_ = 0;  // entries of the first lists
};

}  // namespace dartcast::detail
