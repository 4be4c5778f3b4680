// A group of cells: its outer surface, and the cells that can fill it. Private to editing.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "complex/cone_point.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast::detail {

using Position = std::function<Vec3(Vertex)>;

/// Whether all simplices of a cell are positive. Precondition: it exists.
bool is_positive(ComplexEdit& edit, Cell c);

/// The cells of one kind, free or blocked, around a vertex. They are connected to the first one through faces with that
/// vertex.
struct Star {
  Vertex vertex;
  std::vector<Cell> cells;
  bool closed = true;      ///< no face at the vertex is on the boundary or has a cell of the other kind beyond
  bool too_large = false;  ///< there are more than `limit`; some are missing
};
Star star_of(const CombinatorialMap& map, Cell first, Vertex v, std::size_t limit);

/// The cells and their neighbours of the same kind; sorted.
std::vector<Cell> grown(const CombinatorialMap& map, std::span<const Cell> cells);

/// The faces of the cells with none of the cells beyond; `from` is the cell's own face. In the plane they are one
/// behind another, as far as they are one cycle. `cells`: sorted.
std::vector<DraftFace> surface_of(const CombinatorialMap& map, std::span<const Cell> cells);

/// Whether the faces bound one solid (in the plane: one polygon) without holes.
bool bounds_solid(const std::vector<DraftFace>& faces);

std::vector<Vertex> corners_of(std::span<const DraftFace> faces);

/// All triangles of the faces' fans. In the plane: the upright triangles over the edges.
std::vector<ConeTriangle> fans_of(std::span<const DraftFace> faces, const Position& position);

/// A pyramid on each face, all with the same apex. Its source is that of the cell that had the face. In the plane: a
/// triangle on each edge. Precondition: bounds_solid().
std::vector<CellDraft> pyramids_on(const CombinatorialMap& map, std::span<const DraftFace> faces, Vertex apex);

}  // namespace dartcast::detail
