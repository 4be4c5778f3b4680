// Cells yet to be made: what an edit puts in the place of others.
//
// In the plane the faces of a draft are its edges, each from its first corner to its second, one behind another
// counterclockwise; marks count at the first corner.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

/// A corner of a face, and the edge from it to the next.
struct DraftCorner {
  Vertex vertex;
  bool straight = false;  ///< the face may be straight here: a vertex put on an edge, a split that was merged away
  bool coplanar = false;  ///< the cell's face beyond the edge may lie in the same plane
};

/// What a face is sewn to: nothing, a face of a cell of the map, or a face of another draft of the same call. Where the
/// cell named is one of those to be replaced, the draft's face that continues its face is meant.
struct DraftLink {
  static constexpr std::uint32_t no_draft = 0xffffffffU;

  CellFace face;
  std::uint32_t draft = no_draft;
  std::uint16_t draft_face = 0;
};

struct DraftFace {
  std::vector<DraftCorner> corners;  ///< counterclockwise seen from the outside
  DraftLink across;
  CellFace from;  ///< the face of a replaced cell that this one continues; invalid where it is new
  Patch patch;
  Vertex point;  ///< fanned from a point of its own, the same from both sides; invalid: it has none
};

struct CellDraft {
  std::vector<DraftFace> faces;
  Vertex point;  ///< coned from a point of its own; invalid: it has none
  bool free = true;
  std::uint32_t source = 0;  ///< the number in the mesh that errors and output name
};

/// A draft of the cell as it is, corner k of face f for dart first_dart(f) + k, but without a point of its own: what is
/// to be coned anew has to find a new one. Faces keep their points. Precondition: contains(c).
CellDraft draft_of(const CombinatorialMap& map, Cell c);

/// How a draft goes into a record.
struct DraftForm {
  std::uint32_t pool = CombinatorialMap::general_pool;
  std::vector<std::uint32_t> corners;  ///< in the record's order
  std::vector<std::uint16_t> local;    ///< general pool: place of each face's corners in these, one face after another
  std::vector<std::uint16_t> face;     ///< the record's number of each of the draft's faces
  std::string defect;                  ///< why it is no cell; empty: it is one
};

/// Judges a draft by itself: at least four faces of at least three distinct corners; every edge once in each direction;
/// the surface a sphere; points distinct from corners; at most 16383 darts. In the plane: at least three edges, one
/// cycle of distinct corners. What is combinatorially a tetrahedron, hexahedron, prism, pyramid, triangle or
/// quadrilateral, without points, takes that form. Cost: linear in its darts, on average.
DraftForm form_of(const CellDraft& draft, unsigned dimension = 3);
std::vector<DraftForm> forms_of(std::span<const CellDraft> drafts, unsigned dimension);

}  // namespace dartcast
