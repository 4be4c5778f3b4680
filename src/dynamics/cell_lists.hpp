// Each cell's list of the particles in it, kept up as they cross from cell to cell.
//
// "Each cell stores the list of its particles": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism
// for continuous collision detection in deformable environments", SPM 2009, section 7.3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/particle_state.hpp"

namespace dartcast {

class CellLists {
 public:
  /// Cells with more particles than this are crowded: lists are slow to find pairs there (sphere_pairs.hpp).
  static constexpr std::uint32_t short_list = 8;

  /// Updates the lists to the cells that the states name, after motion, edits, and particles added or removed. Cost:
  /// a look at each particle, and a constant for each that changed cells. It allocates only if there are more
  /// particles or cells than ever before.
  void update(const CombinatorialMap& map, std::span<const ParticleState> states);

  [[nodiscard]] std::size_t size() const { return cell_of_.size(); }
  /// Number of particles in a cell.
  [[nodiscard]] std::uint32_t count(Cell c) const {
    const auto& pool = pools_[c.pool()];
    return c.index() < pool.size() ? pool[c.index()].count : 0;
  }
  /// Number of cells that hold more than `short_list`.
  [[nodiscard]] std::size_t crowded() const { return crowded_; }
  /// Number of particles that the last update() moved to another list.
  [[nodiscard]] std::size_t crossed() const { return crossed_; }

  /// Whether the particle is the first of its cell's for_each().
  [[nodiscard]] bool leads(std::uint32_t particle) const { return links_[particle].previous == none; }

  /// Calls visit(particle) for each in the cell. The order depends on the history: sort results that must not depend
  /// on it.
  template <class Visit>
  void for_each(Cell c, Visit&& visit) const {
    const auto& pool = pools_[c.pool()];
    if (c.index() >= pool.size()) return;
    for (std::uint32_t i = pool[c.index()].first; i != none; i = links_[i].next) visit(i);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  struct List {
    std::uint32_t first = none;
    std::uint32_t count = 0;
  };
  struct Link {
    std::uint32_t next = none;
    std::uint32_t previous = none;
  };

  void fit(const CombinatorialMap& map);
  void insert(std::uint32_t particle, Cell c);
  void remove(std::uint32_t particle);
  [[nodiscard]] List& list(Cell c) { return pools_[c.pool()][c.index()]; }

  std::array<std::vector<List>, 5> pools_;  // by a cell's pool and index
  std::vector<Link> links_;                 // by particle
  std::vector<Cell> cell_of_;               // by particle: the cell whose list holds it
  std::size_t crowded_ = 0;
  std::size_t crossed_ = 0;
};

}  // namespace dartcast
