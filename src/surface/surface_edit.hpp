// Edits of a surface: those of the plane (dartcast/map_edits.hpp), with positions. All or nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "complex/created_positions.hpp"
#include "dartcast/surface.hpp"
#include "dartcast/transaction.hpp"

namespace dartcast {

/// A triangle of a face that an edit replaced, as it was.
struct GoneTriangle {
  SimplexId triangle;
  std::uint32_t source = 0;  ///< number of the face in the mesh
  std::array<Vec3, 3> corners;
};

struct SurfaceEditReport {
  EditReport map;
  std::vector<GoneTriangle> gone;  ///< sorted by triangle
};

/// A sequence of edits: split_edge(), split_face(), merge_faces(), merge_edges(), sew(), unsew(), remove(), and
/// set_free() of the transaction. What is not committed when it ends is taken back. While it is open, nobody else
/// edits, moves or copies the surface. Cost: that of the faces touched.
class SurfaceEdit {
 public:
  explicit SurfaceEdit(Surface& surface);
  SurfaceEdit(const SurfaceEdit&) = delete;
  SurfaceEdit& operator=(const SurfaceEdit&) = delete;
  SurfaceEdit(SurfaceEdit&&) = delete;
  SurfaceEdit& operator=(SurfaceEdit&&) = delete;
  ~SurfaceEdit();

  [[nodiscard]] Transaction& topology() { return transaction_; }
  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }
  /// Where a vertex is. One put on an edge lies in its middle until it is placed, one that was parted where the other
  /// does; of two that were sewn to each other the lower-numbered one stays where it is. Throws InvalidArgument where
  /// there is no such vertex.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument where it made no such vertex, or x is not finite or
  /// out of the exact range.
  void place(Vertex v, const Vec3& x);

  /// Makes everything final. Places in the faces replaced are to follow (followed()); moves give positions of the new
  /// vertices, too. Throws EditRefused, everything taken back, where a new face has a triangle without area: a face
  /// with a vertex on its edge has one, unless it is split there in the same edit.
  SurfaceEditReport commit();

 private:
  Surface& surface_;
  Transaction transaction_;
  detail::CreatedPositions<std::vector<Vec3>> created_;
};

/// A place after an edit: as it was where its face was not replaced; in a triangle with the same corners, if one of the
/// new faces from its face (by source) has it, with the same weights; else the nearest place in the new faces, of
/// several at the same distance that in a face from its own, then the first. So what lies on an edge that is opened
/// stays on its side. Nothing where no face took the place of those removed. Every place must follow each edit before
/// the next. Cost: linear in the new faces.
std::optional<SurfacePlace> followed(const Surface& surface, const SurfaceEditReport& report,
                                     const SurfacePlace& place);

}  // namespace dartcast
