// Pairs of spheres that may meet in a step: each pair once, sorted.
//
// If cells hold few and small particles, the search follows the cells' lists through free neighbours, as far as a
// sphere and its motion reach. If cells hold many, or spheres are larger, it uses a grid of several levels, one
// for each power of two of the spheres' extents. The cost of the grid per sphere depends neither on the crowd in a
// cell nor on the range of radii. Both give the same pairs, except pairs with walls in between. The grid is searched
// with wider boxes, and again only when a sphere has left its own. The pairs of the boxes are picked from those of the
// wider ones, so the result does not depend on earlier steps. L. Verlet, "Computer experiments on classical fluids I",
// 1967, keeps lists of neighbours in this way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/cell_lists.hpp"
#include "dynamics/sphere_grid.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

/// The method of the search.
enum class PairSearch : std::uint8_t {
  automatic,  ///< by lists if no cell is crowded and spheres reach a small part of a cell, else by the grid
  lists,
  grid
};

/// Finds pairs of spheres, and keeps its memory from step to step.
class PairFinder {
 public:
  /// The pairs whose swept boxes (centre, motion and radius) overlap or touch, sorted. Spheres of radius 0 meet no
  /// other. The search through cells starts in the cells of the centres and passes free cells alone. So it leaves out
  /// pairs that no way within the box of both connects, as on two sides of a blocked layer. For the others, separated()
  /// decides whether a wall is between them. `states`, `spheres`: by particle; `lists` up to date with the states. The
  /// result holds until the next call. It is the same for any number of threads. Throws InvalidArgument if a sphere's
  /// box is not finite or reaches beyond 2^1000.
  std::span<const SpherePair> find(const CellComplex& complex, const CellLists& lists,
                                   std::span<const ParticleState> states, std::span<const SphereMotion> spheres,
                                   Threads threads = {}, PairSearch search = PairSearch::automatic);
  /// By the grid, without an environment.
  std::span<const SpherePair> find(std::span<const SphereMotion> spheres, Threads threads = {});

  /// Whether the last search used lists.
  [[nodiscard]] bool by_lists() const { return by_lists_; }

 private:
  void make_boxes(std::span<const SphereMotion> spheres, Threads threads);
  [[nodiscard]] bool lists_do(const CellComplex& complex, const CellLists& lists,
                              std::span<const ParticleState> states) const;
  [[nodiscard]] detail::SweptBox room_of(std::uint32_t sphere) const;
  void search_lists(const CellComplex& complex, const CellLists& lists, std::span<const ParticleState> states,
                    Threads threads);
  void search_grid(Threads threads);
  void find_by_grid(std::span<const SphereMotion> spheres, Threads threads);
  [[nodiscard]] bool wide_boxes_hold(Threads threads);
  void widen(std::span<const SphereMotion> spheres);
  void pick(Threads threads);
  void merge(std::vector<SpherePair>& pairs);

  std::vector<detail::SweptBox> boxes_;
  // Wider boxes, and the pairs of them that meet. While each box is in its wide one, these are all pairs to look at.
  std::vector<detail::SweptBox> wide_boxes_;
  std::vector<SpherePair> wide_pairs_;
  std::vector<std::vector<SpherePair>> picked_;  // by chunk of those
  std::vector<std::uint8_t> hold_;               // by chunk of boxes: whether the wide ones hold them
  unsigned wide_uses_ = 0;                       // searches that the wide boxes have saved
  unsigned narrow_left_ = 0;                     // searches to make without wide boxes
  std::vector<double> reaches_;                  // by sphere: the reach of its box from the centre
  std::vector<std::vector<SpherePair>> parts_;   // by chunk
  std::vector<std::uint32_t> starts_;            // of each sphere's pairs
  std::vector<SpherePair> pairs_;
  detail::SphereGrid grid_;
  bool by_lists_ = false;
};

/// Whether a wall is between the centres, on the straight way. Exact. Precondition: both states are of the complex as
/// it stands; held ones are separated from none. Cost: a walk; a comparison if both are in one cell.
bool separated(const CellComplex& complex, const ParticleState& a, const ParticleState& b);

}  // namespace dartcast
