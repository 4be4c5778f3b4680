// The exact walk along a segment, through simplices, up to its end or to the first wall.
//
// After T. Jund, D. Cazier, J.-F. Dufourd, SPM 2009, section 5, made exact: every decision is the sign of a determinant
// of vertices and of the segment's ends, and ties are broken by an infinitesimal shift of the whole segment
// (docs/method.md).
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>

#include "dartcast/base/error.hpp"
#include "dartcast/walk/counters.hpp"
#include "dartcast/walk/space.hpp"
#include "dartcast/walk/star.hpp"

namespace dartcast {

enum class WalkEnd : std::uint8_t {
  arrived,      ///< q lies in the closed simplex named, and on no wall
  wall,         ///< the segment meets a wall: passes it, or ends on it
  invalid_cell  ///< a simplex on the way is not positive, or has a vertex that is not finite or outside the exact range
};

struct Walk {
  WalkEnd end = WalkEnd::arrived;
  SimplexId simplex;       ///< the last one reached
  std::uint8_t zeros = 0;  ///< arrived, or ends on a wall: bit i is set where q lies on the facet opposite to corner i
  SimplexId wall_simplex;  ///< wall: the free simplex at the wall, and which of its facets is the wall
  std::uint8_t wall_facet = 0;
  bool at_start = false;  ///< wall: met at p itself
  bool at_end = false;    ///< wall: met at q itself, which is in `simplex`
};

/// Sees every simplex that a walk leaves: visit(SimplexId, facet through which it leaves).
struct NoVisitor {
  void operator()(SimplexId, unsigned) const {}
};

namespace detail {

// (k, l) such that (i, j, k, l) is an even permutation: orient3d(v_k, v_l, p, q) > 0 where the segment leaves by i
// before j.
inline constexpr std::uint8_t side_edge[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                                    {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                                    {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                                    {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};

/// The shift that breaks a walk's ties, made at the first tie.
template <class Positions>
class Ties {
 public:
  Ties(const Space<Positions>& space, SimplexId start, const Vec3& p, const Vec3& q)
      : space_(space), start_(start), p_(p), q_(q) {}

  [[nodiscard]] Sign plane(const Corners& v, unsigned facet) {
    const auto& f = facet_corners[facet];
    return shift().of_plane(v[f[0]], v[f[1]], v[f[2]]);
  }
  [[nodiscard]] Sign line(const Vec3& a, const Vec3& b) { return shift().of_line(a, b, p_, q_); }

 private:
  const Shift& shift() {
    if (!shift_) {
      const Corners v = space_.corners(start_);
      std::array<Vec3, 3> opposite;
      unsigned count = 0;
      for (unsigned i = 0; i < 4; ++i) {
        if (count < 3 && orient_facet(v, i, p_) == Sign::zero) opposite[count++] = v[i];
      }
      shift_.emplace(p_, std::span<const Vec3>(opposite.data(), count));
    }
    return *shift_;
  }

  const Space<Positions>& space_;
  SimplexId start_;
  const Vec3& p_;
  const Vec3& q_;
  std::optional<Shift> shift_;
};

[[noreturn]] void throw_overrun(const Map& map, SimplexId start, const Vec3& p, const Vec3& q);

/// One simplex of a walk: which facets q lies beyond, and by which of them the segment leaves.
template <class Positions>
class Crossing {
 public:
  Crossing(const Corners& v, const Vec3& p, const Vec3& q, Ties<Positions>& ties, TestCounts& counts)
      : v_(v), p_(p), q_(q), d_(v, q), ties_(ties), counts_(counts) {}

  [[nodiscard]] bool valid() const { return d_.proves_positive() || volume_sign(v_) == Sign::positive; }

  /// Tests the facets other than the one entered by; sets behind() and zeros().
  void test(unsigned entered) {
    for (unsigned i = 0; i < 4; ++i) {
      if (i == entered) continue;
      ++counts_.tests;
      Sign s = sign_of(d_, i, v_, q_, counts_.exact);
      if (s == Sign::zero) {
        zeros_ |= 1U << i;
        s = ties_.plane(v_, i);
      }
      if (s == Sign::negative) behind_ |= 1U << i;
    }
  }

  /// The facet by which the segment leaves. Precondition: behind() is not empty.
  [[nodiscard]] unsigned exit() {
    unsigned best = static_cast<unsigned>(std::countr_zero(behind_));
    for (unsigned j = best + 1; j < 4; ++j) {
      if (((behind_ >> j) & 1U) != 0 && !leaves_first(best, j)) best = j;
    }
    return best;
  }

  [[nodiscard]] unsigned behind() const { return behind_; }
  [[nodiscard]] unsigned zeros() const { return zeros_; }

 private:
  [[nodiscard]] bool leaves_first(unsigned i, unsigned j) {
    const Vec3& a = v_[side_edge[i][j][0]];
    const Vec3& b = v_[side_edge[i][j][1]];
    ++counts_.tests;
    Sign s = orient3d(a, b, p_, q_, counts_.exact);
    if (s == Sign::zero) s = ties_.line(a, b);
    return s == Sign::positive;
  }

  const Corners& v_;
  const Vec3& p_;
  const Vec3& q_;
  const Determinants d_;
  Ties<Positions>& ties_;
  TestCounts& counts_;
  unsigned behind_ = 0;
  unsigned zeros_ = 0;
};

/// The walk of the shifted segment: up to the simplex that holds q, or to the first wall facet.
template <class Positions, class Visitor>
Walk walk_shifted(const Space<Positions>& space, SimplexId start, const Vec3& p, const Vec3& q, TestCounts& counts,
                  Visitor& visit) {
  Ties<Positions> ties(space, start, p, q);
  Walk walk;
  walk.simplex = start;
  unsigned entered = 4;
  bool entered_on_zero = false;
  for (std::uint64_t met = 0; met <= space.simplex_count; ++met) {
    const CellView cell = space.map->view(walk.simplex.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[walk.simplex.simplex];
    const Corners v = space.corners(cell, s);
    Crossing<Positions> crossing(v, p, q, ties, counts);
    if (!crossing.valid()) {
      walk.end = WalkEnd::invalid_cell;
      return walk;
    }
    crossing.test(entered);
    const unsigned zeros = crossing.zeros() | (entered_on_zero ? 1U << entered : 0U);
    if (crossing.behind() == 0) {
      walk.zeros = static_cast<std::uint8_t>(zeros);
      return walk;
    }
    const unsigned facet = crossing.exit();
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
    entered = next.facet;
    entered_on_zero = ((zeros >> facet) & 1U) != 0;
  }
  throw_overrun(*space.map, start, p, q);
}

/// The corners that span the feature of a simplex in whose interior a point with these zero facets lies.
inline Feature feature_of(const CellView& cell, const ImplicitSimplex& s, unsigned zeros) {
  Feature feature;
  for (unsigned i = 0; i < 4; ++i) {
    if (((zeros >> i) & 1U) == 0) feature.add(cell.vertex(s.vertex[i]));
  }
  return feature;
}

/// Bit i is set where x lies on the facet opposite to corner i.
inline unsigned zeros_of(const Corners& v, const Vec3& x) {
  unsigned zeros = 0;
  for (unsigned i = 0; i < 4; ++i) zeros |= orient_facet(v, i, x) == Sign::zero ? 1U << i : 0U;
  return zeros;
}

/// A free simplex around p from which the segment to q does not leave at once: no facet that holds p has q strictly
/// beyond.
template <class Positions>
SimplexId simplex_towards(const Space<Positions>& space, SimplexId at, const Vec3& p, const Vec3& q,
                          TestCounts& counts) {
  const CellView first = space.map->view(at.cell);
  const ImplicitSimplex& s0 = first.shape().simplices()[at.simplex];
  const Feature around = feature_of(first, s0, zeros_of(space.corners(first, s0), p));
  SimplexId found;
  search_star(
      *space.map, at, around,
      [&](SimplexId id, const CellView& cell, const ImplicitSimplex& s) {
        const Corners v = space.corners(cell, s);
        for (unsigned i = 0; i < 4; ++i) {
          if (around.has(cell.vertex(s.vertex[i]))) continue;
          ++counts.tests;
          const auto& f = facet_corners[i];
          if (orient3d(v[f[0]], v[f[1]], v[f[2]], q, counts.exact) == Sign::negative) return true;
        }
        found = id;
        return false;
      },
      [](SimplexId, const CellView&, const ImplicitSimplex&, unsigned) { return true; });
  return found;
}

/// Walls are closed: where q lies exactly on one, the walk ends at it.
template <class Positions>
void find_wall_at_end(const Space<Positions>& space, Walk& walk) {
  const CellView cell = space.map->view(walk.simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[walk.simplex.simplex];
  if (std::has_single_bit(walk.zeros)) {  // inside a facet: no other wall can be there
    const Across across = s.across[static_cast<unsigned>(std::countr_zero(walk.zeros))];
    if (!across.outer() || !cell.is_wall(across.face())) return;
  }
  search_star(
      *space.map, walk.simplex, feature_of(cell, s, walk.zeros),
      [](SimplexId, const CellView&, const ImplicitSimplex&) { return true; },
      [&](SimplexId id, const CellView&, const ImplicitSimplex&, unsigned facet) {
        walk.end = WalkEnd::wall;
        walk.at_end = true;
        walk.wall_simplex = id;
        walk.wall_facet = static_cast<std::uint8_t>(facet);
        return false;
      });
}

}  // namespace detail

/// Walks from p to q. Preconditions: p lies in the closed simplex `start` of a free cell; p and q are finite and in the
/// exact range; p differs from q. Cost: three or four orientation tests in each simplex met, whatever the size of the
/// scene. Throws InternalError with a replay where a walk among valid cells does not end (guarantee G4: a bug).
template <class Positions, class Visitor = NoVisitor>
Walk walk(const Space<Positions>& space, SimplexId start, const Vec3& p, const Vec3& q, TestCounts& counts,
          Visitor&& visit = {}) {
  if (Determinants(space.corners(start), q).all_proved_positive()) {  // the usual case: the forecast is kept
    counts.tests += 4;
    Walk here;
    here.simplex = start;
    return here;
  }
  Walk result = detail::walk_shifted(space, start, p, q, counts, visit);
  if (result.end == WalkEnd::wall) {
    ++counts.tests;
    if (orient_facet(space.corners(result.wall_simplex), result.wall_facet, p) == Sign::zero) {
      // p lies on the wall itself. It is met only if no free simplex around p leads towards q.
      const SimplexId restart = detail::simplex_towards(space, result.wall_simplex, p, q, counts);
      result.at_start = !restart.valid();
      if (restart.valid()) result = detail::walk_shifted(space, restart, p, q, counts, visit);
    }
  }
  if (result.end == WalkEnd::arrived && result.zeros != 0) detail::find_wall_at_end(space, result);
  if (result.end == WalkEnd::wall && !result.at_start && !result.at_end)
    result.at_end = detail::zeros_of(space.corners(result.wall_simplex), q) >> result.wall_facet & 1U;
  return result;
}

}  // namespace dartcast
