// When a motion of the vertices first flattens a simplex of the scene, and how far it can be followed: collisions of
// the environment with itself.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "complex/simplex_inversion.hpp"
#include "dartcast/cell_complex.hpp"

namespace dartcast {

/// A simplex of a cell that a motion flattens.
struct CellInversion {
  SimplexId simplex;
  std::array<Vertex, 4> vertices;  ///< the simplex's corners 0 to 3
  SimplexInversion how;
  std::string message;  ///< names the cell as in the mesh, the time, and the vertices that meet
};

/// The first simplex that is flattened while every vertex goes from `before` to `after` on a straight line; nothing
/// where all stay positive. First by safe_time, then in the order of cells. Blocked cells count: they must stay valid,
/// too. A simplex that is not positive to begin with is flattened at the time 0. Interior points move on straight lines
/// like other vertices: positions are those of all vertices of the map. Exact as find_inversion(). Cost: linear,
/// parallel, 20 to 40 ns a simplex on one thread, about as check_validity(); more where very many simplices are
/// flattened within inversion_resolution of the first (4 us each). The result does not depend on the threads. Throws
/// InvalidArgument where the positions are not as many as the map's vertices.
std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Threads threads = {});

/// The same for the last move, from previous_positions() to positions().
std::optional<CellInversion> first_inversion(const CellComplex& complex, Threads threads = {});

/// The same for one cell, up to a time (see find_inversion()). Precondition: as many positions as vertices.
std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Cell c, double until = 1.0);

/// Follows a motion up to `time`, or as far as it can be: writes into `positions` where the vertices are then, rounded,
/// and returns the time. The move from `before` to the positions written flattens nothing: that very move, rounded as
/// it is, has been checked by first_inversion(). Where it does at `time`, earlier times are tried, further and further
/// back from inversion_resolution on, and in the end 0, which gives `before` itself. Typically called with the
/// safe_time of a flattening, or with part of it. Interior points are computed from the weights. Preconditions:
/// `before` is valid, `time` is in [0, 1], the spans do not overlap. Cost: a few passes of first_inversion(). Throws
/// InvalidArgument where the positions are not as many as the map's vertices.
double move_towards(const CombinatorialMap& map, const SteinerWeights& steiner_weights, std::span<const Vec3> before,
                    std::span<const Vec3> after, double time, std::span<Vec3> positions, Threads threads = {});

}  // namespace dartcast
