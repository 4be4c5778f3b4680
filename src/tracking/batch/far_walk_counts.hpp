// The tests that a batch counts on a far walk (tracking/batch/batch_far_walks.inl), for one particle that walks from rank
// to rank: a batch on one rank would walk along the line, which asks other questions. Not installed.
#pragma once

#include <array>
#include <cstdint>

#include "tracking/batch/particle_cache.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

/// Where a batch would be in its walk, at a place where the walk leaves a rank.
struct FarWalk {
  enum class By : std::uint8_t {
    determinants,   ///< as one particle walks, from the start of the step
    line,           ///< simplex by simplex, to the end
    line_alone,     ///< the same; where the line is undecided, the whole step is left to one particle's walk
    line_to_cells,  ///< the same up to the next hexahedron
    cells,          ///< one whole hexahedron after the other
    rounds          ///< as one particle walks, from a simplex in which the line was undecided
  };
  By by = By::determinants;
  std::array<std::uint8_t, 3>
      slots{};         ///< by line: the triangle's corners, by their places in the simplex that it leaves
  double reach = 0.0;  ///< by line, and by cells: that of its first simplex
  TestCounts counts;   ///< by line, and by cells: so far; in rounds: what they add to those of one particle

  [[nodiscard]] bool by_line() const { return by == By::line || by == By::line_alone || by == By::line_to_cells; }

  /// The tests that the batch has counted, where one particle has counted `scalar`.
  [[nodiscard]] TestCounts counted(const TestCounts& scalar) const {
    if (by_line() || by == By::cells) return counts;
    return {scalar.tests + counts.tests, scalar.exact + counts.exact};  // modulo 2^64: less may be added than counted
  }
};

namespace detail {

/// Visits the simplices of one particle's walk in space, and asks there what a batch asks, to the same bits.
class FarWalkCounts {
 public:
  /// The walk from p to q, among vertices where they are at this time of the step. `scalar`: what the walk itself counts.
  FarWalkCounts(const CellComplex& complex, double time, const Vec3& p, const Vec3& q, const TestCounts& scalar)
      : complex_(complex),
        positions_{complex.previous_positions().data(), complex.positions().data(), time},
        p_(p),
        q_(q),
        scalar_(scalar) {}

  /// The walk begins there, in a batch. Where its target is near, both count the same. `carried`: vertices have moved, and
  /// have carried p along.
  void begin(SimplexId start, bool carried);
  /// The walk has left a rank by that facet.
  void go_on(const FarWalk& walk, SimplexId left, unsigned facet);

  /// The walk leaves a simplex by this facet.
  void operator()(SimplexId simplex, unsigned facet) {
    if (now_.by != FarWalk::By::determinants) pass(simplex, facet);
  }
  /// The walk has ended, at a wall, in a simplex or for want of one.
  void end(const Walk& walk);

  /// For go_on(), after the facet that was passed last.
  [[nodiscard]] const FarWalk& walk() const { return now_; }

 private:
  using Triangle = std::array<std::uint32_t, 3>;

  void look_at(SimplexId simplex, const VertexNumbers& v);
  void look_at_cell(SimplexId entered, const VertexNumbers& v, unsigned facet);
  void look_along_line(const VertexNumbers& v, unsigned apex);
  void go_to_rounds();
  [[nodiscard]] bool is_known_in_rounds(const VertexNumbers& v, unsigned tested) const;
  void pass(SimplexId simplex, unsigned facet);

  const CellComplex& complex_;
  Between positions_;
  const Vec3& p_;
  const Vec3& q_;
  const TestCounts& scalar_;
  TestCounts scalar_before_;  // the next simplex
  FarWalk now_;
  Triangle triangle_{};  // the vertices that the next simplex is entered by
  bool in_first_ = false;
  bool enters_cell_ = false;  // the next simplex is the first one of its cell
};

}  // namespace detail

}  // namespace dartcast
