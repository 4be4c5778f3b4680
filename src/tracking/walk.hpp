// The exact walk along a segment, through simplices, up to its end or to the first wall.
//
// After T. Jund, D. Cazier, J.-F. Dufourd, SPM 2009, section 5, made exact. Every decision is the sign of a determinant
// of vertices and of the segment's ends. An infinitesimal shift of the whole segment breaks ties (docs/method.md). The
// walk ends in the first closed simplex that holds q.
//
// Up to there it is the walk of the shifted segment. The shifted walk leaves a simplex by the first facet that the
// shifted q is beyond. Suppose that q itself is strictly beyond some facet. Then a facet whose plane holds q is never
// the first. The segment meets that plane at its end, or lies in it. If it lies in it, the shift is to the inner side,
// because the shifted segment passes through the simplex. So only facets that q is strictly beyond count, and ties
// occur only between two of these.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>

#include "dartcast/error.hpp"
#include "dartcast/step.hpp"
#include "tracking/space.hpp"
#include "tracking/star.hpp"

namespace dartcast {

enum class WalkEnd : std::uint8_t {
  arrived,      ///< q lies in the closed simplex named, and on no wall
  wall,         ///< the segment meets a wall: passes it, or ends on it
  invalid_cell  ///< a simplex on the way is not positive, or has a vertex that is not finite or outside the exact range
};

struct Walk {
  WalkEnd end = WalkEnd::arrived;
  SimplexId simplex;       ///< the last one reached
  std::uint8_t zeros = 0;  ///< arrived, or ends on a wall: bit i is set if q lies on the facet opposite to corner i
  SimplexId wall_simplex;  ///< wall: the free simplex at the wall, and which of its facets is the wall
  std::uint8_t wall_facet = 0;
  bool at_start = false;  ///< wall: met at p itself
  bool at_end = false;    ///< wall: met at q itself, which is in `simplex`
};

/// Is called for every simplex that a walk leaves: visit(SimplexId, facet through which it leaves).
struct NoVisitor {
  void operator()(SimplexId, unsigned) const {}
};

namespace detail {

// (k, l) such that (i, j, k, l) is an even permutation: orient3d(v_k, v_l, p, q) > 0 if the segment leaves by i
// before j.
inline constexpr std::uint8_t side_edge[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                                    {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                                    {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                                    {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};

/// Bit i is set if x lies on the facet opposite to corner i.
template <std::size_t N>
unsigned zeros_of(const std::array<Vec3, N>& v, const Vec3& x) {
  constexpr unsigned all = (1U << N) - 1U;
  const Determinants d(v, x);
  for (unsigned i = 0; i < N; ++i) {  // a corner: on all facets but the one opposite to it
    if (v[i] == x && d.decides(i) && in_exact_range(x)) return all & ~(1U << i);
  }
  std::uint64_t exact = 0;
  return signs_of(d, v, x, all, exact).zero;
}

/// The shift that breaks a walk's ties, made at the first tie.
template <class Positions, std::size_t N>
class Ties {
 public:
  /// `zeros`: the facets of `start` that p lies on, if they are known.
  Ties(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q,
       std::optional<unsigned> zeros = {})
      : space_(space), start_(start), p_(p), q_(q), zeros_(zeros) {}
  /// `opposite`: the corners opposite to the facets that p lies on, where the walk started.
  Ties(const Space<Positions, N>& space, const Vec3& p, const Vec3& q, std::span<const Vec3> opposite)
      : space_(space), p_(p), q_(q) {
    shift_.emplace(p, opposite);
  }

  /// Sign of orient3d(a, b, p, q) of the shifted segment, if it is zero.
  [[nodiscard]] Sign line(const Vec3& a, const Vec3& b) {
    if (!shift_) make_perturbation();
    return shift_->of_line(a, b, q_);
  }
  /// Sign of orient2d(p, q, c) of the shifted segment, if it is zero.
  [[nodiscard]] Sign line() {
    if (!shift_) make_perturbation();
    return shift_->of_line(q_);
  }

 private:
  void make_perturbation() {
    const std::array<Vec3, N> v = space_.corners(start_);
    const unsigned zeros = zeros_ ? *zeros_ : zeros_of(v, p_);
    std::array<Vec3, N - 1> opposite;
    unsigned count = 0;
    for (unsigned i = 0; i < N; ++i) {
      if (count < N - 1 && ((zeros >> i) & 1U) != 0) opposite[count++] = v[i];
    }
    shift_.emplace(p_, std::span<const Vec3>(opposite.data(), count));
  }

  const Space<Positions, N>& space_;
  SimplexId start_ = {};
  const Vec3& p_;
  const Vec3& q_;
  std::optional<unsigned> zeros_;
  std::optional<std::conditional_t<N == 4, SymbolicPerturbation, PlanarSymbolicPerturbation>> shift_;
};

[[noreturn]] void throw_overrun(const CombinatorialMap& map, Stored places, SimplexId start, const Vec3& p,
                                const Vec3& q);
[[noreturn]] void throw_overrun(const CombinatorialMap& map, Between places, SimplexId start, const Vec3& p,
                                const Vec3& q);

/// Whether the shifted segment leaves by facet i before facet j, both of which q is strictly beyond.
template <class Positions>
bool leaves_before(const Corners& v, unsigned i, unsigned j, const Vec3& p, const Vec3& q, Ties<Positions, 4>& ties,
                   std::uint64_t& exact) {
  const Vec3& a = v[side_edge[i][j][0]];
  const Vec3& b = v[side_edge[i][j][1]];
  Sign s = orient3d(a, b, p, q, exact);
  if (s == Sign::zero) s = ties.line(a, b);
  return s == Sign::positive;
}
/// In the plane: by which side of the corner they share it passes.
template <class Positions>
bool leaves_before(const PlaneCorners& v, unsigned i, unsigned j, const Vec3& p, const Vec3& q,
                   Ties<Positions, 3>& ties, std::uint64_t& exact) {
  Sign s = orient2d(p, q, v[3 - i - j], exact);
  if (s == Sign::zero) s = ties.line();
  return s == ((j + 3 - i) % 3 == 1 ? Sign::positive : Sign::negative);
}

/// The facet by which the shifted segment leaves a simplex that it passes through: one of those that q is strictly
/// beyond. Precondition: `behind`, their bits, is not 0.
template <class Positions, std::size_t N>
unsigned exit_facet(const std::array<Vec3, N>& v, unsigned behind, const Vec3& p, const Vec3& q,
                    Ties<Positions, N>& ties, TestCounts& counts) {
  auto best = static_cast<unsigned>(std::countr_zero(behind));
  while ((behind &= behind - 1) != 0) {
    const auto other = static_cast<unsigned>(std::countr_zero(behind));
    ++counts.tests;
    if (!leaves_before(v, best, other, p, q, ties, counts.exact)) best = other;
  }
  return best;
}

/// The walk of the shifted segment, from a simplex that it passes through. It ends at the closed simplex that holds q,
/// or at the first wall facet that q is beyond. `tested`: all facets but the one entered by, because q is strictly on
/// this side of that one; `tests`: their number.
template <class Positions, std::size_t N, class Visitor>
[[gnu::always_inline]] inline Walk walk_on(const Space<Positions, N>& space, SimplexId start, unsigned tested,
                                           unsigned tests, const Vec3& p, const Vec3& q, Ties<Positions, N>& ties,
                                           TestCounts& counts, Visitor& visit) {
  constexpr unsigned all = (1U << N) - 1U;
  Walk walk;
  walk.simplex = start;
  for (std::uint64_t met = 0; met <= space.simplex_count; ++met) {
    const CellView cell = space.map->view(walk.simplex.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[walk.simplex.simplex];
    const std::array<Vec3, N> v = space.corners(cell, s);
    const Determinants d(v, q);
    if (!d.proves_positive() && volume_sign(v) != Sign::positive) {
      walk.end = WalkEnd::invalid_cell;
      return walk;
    }
    const DeterminantSigns signs = signs_of(d, v, q, tested, counts.exact);
    counts.tests += met == 0 ? tests : N - 1;
    if (signs.negative == 0) {
      walk.zeros = static_cast<std::uint8_t>(signs.zero);
      return walk;
    }
    const unsigned facet = exit_facet(v, signs.negative, p, q, ties, counts);
    visit(walk.simplex, facet);
    const Across across = s.across[facet];
    if (across.outer() && cell.is_wall(across.face())) {
      walk.end = WalkEnd::wall;
      walk.wall_simplex = walk.simplex;
      walk.wall_facet = static_cast<std::uint8_t>(facet);
      return walk;
    }
    const Passage next = pass(*space.map, walk.simplex, cell, across);
    walk.simplex = next.simplex;
    tested = all & ~(1U << next.facet);
  }
  throw_overrun(*space.map, space.positions, start, p, q);
}

/// The same from the simplex that holds p on.
template <class Positions, std::size_t N, class Visitor>
Walk walk_to_wall(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q, TestCounts& counts,
                  Visitor& visit) {
  Ties<Positions, N> ties(space, start, p, q);
  return walk_on(space, start, (1U << N) - 1U, N, p, q, ties, counts, visit);
}

/// The corners that span the feature of a simplex in whose interior a point with these zero facets lies.
template <std::size_t N = 4>
Feature feature_of(const CellView& cell, const ImplicitSimplex& s, unsigned zeros) {
  Feature feature;
  for (unsigned i = 0; i < N; ++i) feature.add_if(((zeros >> i) & 1U) == 0, cell.vertex(s.vertex[i]));
  return feature;
}

/// A free simplex around p from which the segment to q does not leave at once: no facet that holds p has q strictly
/// beyond.
template <class Positions, std::size_t N>
SimplexId simplex_towards(const Space<Positions, N>& space, SimplexId at, const Vec3& p, const Vec3& q,
                          TestCounts& counts) {
  const CellView first = space.map->view(at.cell);
  const ImplicitSimplex& s0 = first.shape().simplices()[at.simplex];
  const Feature around = feature_of<N>(first, s0, zeros_of(space.corners(first, s0), p));
  SimplexId found;
  search_star<N>(*space.map, at, around, [&](SimplexId id, const CellView& cell, const ImplicitSimplex& s) {
    const unsigned tested = facets_holding<N>(around, cell, s);
    for (unsigned left = tested; left != 0; left &= left - 1) ++counts.tests;
    const std::array<Vec3, N> v = space.corners(cell, s);
    if (signs_of(Determinants(v, q), v, q, tested, counts.exact).negative != 0) return true;
    found = id;
    return false;
  });
  return found;
}

/// Walls are closed: if q lies exactly on one, the walk ends at it.
template <std::size_t N>
void find_wall_at_end(const CombinatorialMap& map, Walk& walk) {
  const CellView cell = map.view(walk.simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[walk.simplex.simplex];
  const auto wall = find_wall<N>(map, walk.simplex, walk.zeros, feature_of<N>(cell, s, walk.zeros));
  if (!wall) return;
  walk.end = WalkEnd::wall;
  walk.at_end = true;
  walk.wall_simplex = wall->simplex;
  walk.wall_facet = static_cast<std::uint8_t>(wall->facet);
}

/// Ends a walk that has come to its first wall, or to the closed simplex that holds q. `restarted`: it has begun anew,
/// from a wall that p lies on. If `leaves(walk, start)` holds, the walk is returned as it is. `start`: that of a walk
/// that begins anew here, else null. It is always_inline because g++ 12 would call it from both.
template <class Positions, std::size_t N, class Visitor, class Leaves>
[[gnu::always_inline]] inline Walk end_walk(const Space<Positions, N>& space, Walk walk, bool restarted, const Vec3& p,
                                            const Vec3& q, TestCounts& counts, Visitor& visit, const Leaves& leaves) {
  if (leaves(walk, nullptr)) return walk;
  if (walk.end == WalkEnd::wall && !walk.at_end && !restarted) {
    ++counts.tests;
    if (orient_facet(space.corners(walk.wall_simplex), walk.wall_facet, p) == Sign::zero) {
      // p lies on the wall itself. It is met only if no free simplex around p leads towards q.
      const SimplexId restart = simplex_towards(space, walk.wall_simplex, p, q, counts);
      walk.at_start = !restart.valid();
      if (restart.valid()) {
        walk = walk_to_wall(space, restart, p, q, counts, visit);
        if (leaves(walk, &restart)) return walk;
      }
    }
  }
  if (walk.end == WalkEnd::arrived && walk.zeros != 0) find_wall_at_end<N>(*space.map, walk);
  return walk;
}

/// The same if all cells are known.
template <class Positions, std::size_t N, class Visitor = NoVisitor>
Walk end_walk(const Space<Positions, N>& space, const Walk& walk, const Vec3& p, const Vec3& q, TestCounts& counts,
              Visitor&& visit = {}) {
  return end_walk(space, walk, false, p, q, counts, visit, [](const Walk&, const SimplexId*) { return false; });
}

}  // namespace detail

/// Walks from p to q. Preconditions: p lies in the closed simplex `start` of a free cell. Both p and q are finite and
/// in the exact range, and p differs from q. Cost: three or four orientation tests in each simplex met, whatever the
/// size of the scene; in the plane two or three. Throws InternalError with a replay if a walk among valid cells does
/// not end (guarantee G4: a bug).
template <class Positions, std::size_t N, class Visitor = NoVisitor>
Walk walk(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q, TestCounts& counts,
          Visitor&& visit = {}) {
  return detail::end_walk(space, detail::walk_to_wall(space, start, p, q, counts, visit), p, q, counts, visit);
}

}  // namespace dartcast
