// Whether cells are valid, and when a motion of the vertices inverts one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

// Validity: whether all implicit simplices are positive. The check of the whole scene is a streaming pass.

/// The outcome of a check of all cells.
struct Validity {
  std::size_t cells_checked = 0;
  std::size_t invalid_count = 0;
  std::vector<InvalidCell> first;  ///< at most `max_count`, by cell

  [[nodiscard]] bool valid() const { return invalid_count == 0; }
};

/// The first simplex of a cell that is not positive at the given positions, or nothing. Exact.
std::optional<InvalidCell> check_cell(const CombinatorialMap& map, std::span<const Vec3> positions, Cell c);

/// Checks every cell at the current positions. Cost: linear, parallel; the result does not depend on the threads.
Validity check_validity(const CellComplex& complex, Threads threads = {}, std::size_t max_count = 10);
/// The same, at other positions.
Validity check_validity(const CombinatorialMap& map, std::span<const Vec3> positions, Threads threads,
                        std::size_t max_count);

// Inversion: the first time at which a simplex with corners on straight lines is not positive any more.

/// Times of inversion are multiples of this. Much finer steps of time would be lost when positions are rounded.
inline constexpr double inversion_resolution = 0x1p-40;

/// The features that meet when a simplex becomes flat: the parts of its corners whose convex hulls then have a point in
/// common.
enum class InversionKind : std::uint8_t {
  vertex_face,     ///< a corner and the inside of the opposite facet
  edge_edge,       ///< the insides of two opposite edges
  vertex_edge,     ///< a corner and the inside of an edge
  vertex_vertex,   ///< two corners
  line,            ///< all corners lie on a line, or at one point
  from_the_start,  ///< the simplex is flat or inverted at the time 0
  undecidable      ///< a coordinate is not finite or outside the exact range
};

/// The first inversion of a simplex in a step.
struct SimplexInversion {
  /// The volume is positive in [0, safe_time], and first zero in (safe_time, safe_time + inversion_resolution]. For the
  /// kinds from_the_start and undecidable it is 0, and that time is not safe.
  double safe_time = 0.0;
  InversionKind kind = InversionKind::line;
  std::uint8_t one = 0;    ///< corners that meet the others, bit i for corner i; 0 if all lie on a line
  std::uint8_t other = 0;  ///< not fewer than in `one`

  bool operator==(const SimplexInversion&) const = default;
};

/// The first time in [0, until] at which the volume of the simplex is not positive. Its corners go from `before` to
/// `after` on straight lines, a + t (b - a) without rounding. Returns nothing if the volume stays positive. A volume
/// that touches zero and is positive again counts. Exact: no inversion is missed, none is invented. Precondition:
/// `until` is in [0, 1]; it is rounded down to a multiple of inversion_resolution.
///
/// The kind names two parts. A corner is counted to one of them if its facet's area along an axis is proved to keep its
/// sign until the root. This is so if the area is above 2^-35 of the simplex's extents before and after. Otherwise the
/// corner is counted to neither. So the kinds from vertex_edge to line mean: this, or too close to it to distinguish.
/// Coordinates outside the exact range may give undecidable even if the volume stays positive.
///
/// Cost: about 20 ns if the filter proves the volume positive, and some 0.1 us if it must halve the step. If exact
/// signs are needed, 2 to 5 us; if the simplex is inverted, 20 us.
///
/// The cubic is that of X. Provot, "Collision and self-collision handling in cloth model dedicated to design garments",
///  1997. Its first root is enclosed by exact signs of its values, its discriminant and Bernstein's coefficients.
std::optional<SimplexInversion> find_inversion(const Corners& before, const Corners& after, double until = 1.0);

// Collisions of the environment with itself: when a motion of the vertices first inverts a simplex, and how far it can
// be followed.

/// A simplex of a cell that a motion inverts.
struct CellInversion {
  SimplexId simplex;
  std::array<Vertex, 4> vertices;  ///< the simplex's corners 0 to 3
  SimplexInversion how;
  std::string message;  ///< names the cell as in the mesh, the time, and the vertices that meet
};

/// The first simplex that is inverted while every vertex goes from `before` to `after` on a straight line. Returns
/// nothing if all stay positive. The order is by safe_time, then by cell. Blocked cells count, because they must stay
/// valid, too. A simplex that is not positive at the start is inverted at the time 0. Steiner points move on straight
/// lines like other vertices: positions are those of all vertices of the map. Exact as find_inversion().
///
/// Throws InvalidArgument if the number of positions is not that of the map's vertices. Cost: linear, parallel, 20
/// to 40 ns a simplex on one thread, about as much as check_validity(). It is more if very many simplices are
/// inverted within inversion_resolution of the first (4 us each). The result does not depend on the threads.
std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Threads threads = {});

/// The same for the last move, from previous_positions() to positions().
std::optional<CellInversion> first_inversion(const CellComplex& complex, Threads threads = {});

/// The same for one cell, up to a time (see find_inversion()). Precondition: as many positions as vertices.
std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Cell c, double until = 1.0);

/// Follows a motion up to `time`, or as far as possible. Writes the rounded positions of the vertices at that time into
/// `positions`, and returns the time. The move from `before` to the written positions inverts nothing:
/// first_inversion() has checked that rounded move. If the move to `time` would invert a simplex, earlier times are
/// tried, at increasing distances that start with inversion_resolution. The last one is 0, which gives `before` itself.
/// Callers usually pass the safe_time of an inversion, or a part of it. Steiner points are computed from the weights.
///
/// Preconditions: `before` is valid, `time` is in [0, 1], the spans do not overlap. Throws InvalidArgument if the
/// number of positions is not that of the map's vertices. Cost: a few passes of first_inversion().
double move_towards(const CombinatorialMap& map, const SteinerWeights& steiner_weights, std::span<const Vec3> before,
                    std::span<const Vec3> after, double time, std::span<Vec3> positions, Threads threads = {});

}  // namespace dartcast
