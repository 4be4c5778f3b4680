// Cutting and joining: planes, tools, carving, ligatures, reconnections.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

// Cells split along a plane.

/// A plane. A point x is below it if dot(normal, x) < offset, else above or on it.
struct Plane {
  Vec3 normal = {0.0, 0.0, 1.0};  ///< a unit vector
  double offset = 0.0;            ///< m

  [[nodiscard]] double height(const Vec3& x) const { return dot(normal, x) - offset; }
  [[nodiscard]] Plane turned() const { return {-normal, -offset}; }
};

/// The plane through a point. The normal may have any length. Throws InvalidArgument if a number is not finite or
/// the normal is zero.
Plane plane_through(const Vec3& point, const Vec3& normal);

/// How a plane splits cells.
struct SectionOptions {
  /// Vertices nearer to the plane than this share of the mean edge of the cells to be split (or of `finest`, if that is
  /// less) count as on the plane. So no part becomes much thinner than that. If the plane runs along faces nothing
  /// is split. The section bends by no more than that. All vertices share one distance: then no flat face can change
  /// sides more than twice.
  double snap = 1.0 / 32.0;
  /// A smaller value would mistake the rounding of vertices on the plane for a distance.
  static constexpr double min_snap = 0x1p-30;
  /// The smallest feature that must survive, such as the width of a layer between two planes (m).
  double finest = std::numeric_limits<double>::infinity();
};

/// Cells on either side of a plane: parts of cells that were split, and cells that it does not cross. They are cells of
/// the open edit, as in all of surgery. Its commit() may give them Steiner points, and its report maps them to the
/// final cells.
struct Section {
  std::vector<Cell> below, above;
  /// The cells among these that the plane does not cross in a simple loop, even after a division into simplices. They
  /// stay whole, on the side of the mean of their corners.
  std::vector<Cell> whole;
};

/// Splits cells with a plane. The side of each vertex is decided once, so that all cells agree. The new vertex of an
/// edge lies where the plane crosses it, rounded. Cells around that are not named take the new vertices and edges into
/// their faces, and stay whole. Parts keep the free mark of the cell and the patches of its faces. The new faces have
/// no patch.
///
/// A cell with bent faces may have no valid parts, or none at all. Then it is divided into its simplices first (see
/// divide_into_simplices()), whether it is named or beside one that is. If vertices that snap to the plane still bend
/// thin parts inside out, the cut is made with `min_snap`. Other cuts stay as they are.
///
/// Throws InvalidArgument if there is no such cell, if a cell is named twice, or if snap is not in [2^-30,
/// 1/4]. Throws as the edits of dartcast/map_edits.hpp. Then everything is unchanged. commit() checks whether the parts
/// are valid. Cost: linear in the cells named and those around them.
Section split_by_plane(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane,
                       const SectionOptions& options = {});

// Tools to cut with: convex bodies, given by the planes that bound them.

/// The points below all of its planes.
struct ConvexTool {
  std::vector<Plane> planes;
  double finest = std::numeric_limits<double>::infinity();  ///< its smallest width (m): see SectionOptions
};

/// A flat disc, taken as the regular polygon in its circle.
struct Disc {
  Vec3 centre;
  Vec3 normal = {0.0, 0.0, 1.0};  ///< of any length
  double radius = 1.0;            ///< m
  std::uint32_t sides = 24;
};

/// The region that a straight blade sweeps: its two ends, place after place.
struct BladePath {
  std::vector<std::array<Vec3, 2>> places;
};

// Tools that hold the points at most width / 2 from a surface, up to corners. All throw InvalidArgument if a number
// is not finite, or a width or radius is not positive, and as they say.

/// The layer between two planes, width / 2 to both sides.
std::vector<ConvexTool> thicken(const Plane& plane, double width);
/// Throws also if the number of sides is not 3 to 1000.
std::vector<ConvexTool> thicken(const Disc& disc, double width);
/// One tool for the region between two places of the blade, or two tools if that region is not flat. The tools
/// join along planes that halve the angles between them. It also throws if there are fewer than two places, or the
/// blade has no length, does not move, or turns back onto itself.
std::vector<ConvexTool> thicken(const BladePath& path, double width);

/// An upright box. Throws InvalidArgument if it is empty or not finite.
ConvexTool box_tool(const Vec3& low, const Vec3& high);
/// A rod with round ends, or a ball (if a is b), as 26 planes that touch it. The tool holds all of the capsule, and
/// reaches at most 1.13 radii from the line between a and b. Throws as above.
ConvexTool capsule_tool(const Vec3& a, const Vec3& b, double radius);

/// The cells of the complex that no plane of a tool has on its outside. These are all cells that the tools meet, and
/// perhaps some near the tools' edges. In the order of CombinatorialMap::cells(). Cost: one pass over the scene.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools);
/// The same, but only cells that are connected to `start` through such cells. Empty if `start` is not one of them.
/// Throws InvalidArgument if there is no such cell. Cost: that of the cells returned and their neighbours.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools, Cell start);

// Cutting and carving: cells in a tool become free, or are removed.

/// The change that a tool makes to the cells in it.
enum class Carving : std::uint8_t {
  open,    ///< blocked cells in the tool become free: particles can enter. Free cells are not split.
  remove,  ///< cells in the tool are removed, free ones, too: their neighbours' faces become boundary
};

/// How a tool treats cells that it meets in part.
struct CarveOptions {
  /// Whether cells stay whole. Then a cell is taken if the mean of its corners is in the tool.
  bool whole_cells = false;
  double snap = SectionOptions{}.snap;  ///< see SectionOptions
};

/// The effects of a tool.
struct Carved {
  std::vector<Cell> opened;  ///< cells that are free now
  std::size_t removed = 0;   ///< number of removed cells
  std::vector<Cell> whole;   ///< cells that could not be split (see Section), and may reach into the tools or out
};

/// Opens or removes the cells in some tools. Cells that a tool meets are split by its planes, one after another. Only
/// the part inside a plane is split by the next plane, so a tool may end inside cells. `cells`: the cells that may be
/// split, such as cells_near() finds; other cells stay whole. Bent cells are divided first as in split_by_plane(). The
/// scene stays watertight where tissue becomes free: no face is opened.
///
/// Throws InvalidArgument if a cell does not exist or is named twice, or snap is not in [2^-30, 1/4]. Throws as
/// split_by_plane(). Then everything is unchanged. Cost: that of the cells named and those around them.
Carved carve(ComplexEdit& edit, std::span<const Cell> cells, std::span<const ConvexTool> tools, Carving what,
             const CarveOptions& options = {});

/// Opens tissue along a surface (Plane, Disc, BladePath): blocked cells are split by its two sides, and the layer
/// between becomes free. As carve(); and throws as thicken().
template <class Surface>
Carved cut(ComplexEdit& edit, std::span<const Cell> cells, const Surface& surface, double width,
           const CarveOptions& options = {}) {
  return carve(edit, cells, thicken(surface, width), Carving::open, options);
}

/// The open faces of some cells that have all corners at most `within` metres from a plane. An end of a vessel that
/// was cut through is an example. Cost: linear in the cells.
std::vector<CellFace> open_faces(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane, double within);

// Tying a vessel.

/// Ties a vessel: blocks the free cells of one cross-section. These are the cells that the plane crosses and that are
/// connected to `start` by faces within the section. Cells that touch the plane from below count as crossed, so that
/// the section always seals. No free cell below the plane is a neighbour of one above there. Returns the blocked cells.
/// To untie the vessel, free them.
///
/// Throws InvalidArgument if `start` does not exist, is blocked, or is not crossed. Cost: that of the cells blocked
/// and their neighbours.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, Cell start);
/// The same, with `start` the crossed free cell whose mean of corners is nearest to `place`. Throws InvalidArgument
/// if the plane crosses no free cell. Cost: one pass over the scene besides.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, const Vec3& place);

/// How a ligature draws the walls together.
struct TyingOptions {
  double share = 0.5;  ///< share of the distance to the middle of the section by which its walls move, in [0, 1)
  double reach = 1.0;  ///< m: the motion fades out at this distance from the plane, and from the section's rim
};

/// The motion of vertices when a ligature draws the walls of the vessel together. They move towards the middle of the
/// section, parallel to the plane. Those of the section move by `share` of the distance. Others move less, fading out
/// smoothly. For Environment::move_until_inverted(). `section`: cells of the complex, such as ligature() returned.
/// `positions`: some or all of the complex's, changed in place. Throws InvalidArgument if a cell does not exist, none
/// is named, or an option is out of range. Cost: linear in the positions.
void draw_together(const CellComplex& complex, std::span<const Cell> section, const Plane& plane,
                   const TyingOptions& options, std::span<Vec3> positions);

// Sewing the ends of a vessel together.

/// How two ends are matched.
struct ReconnectOptions {
  /// Ends are sewn if the distance of each corner to its counterpart is within this share of its shortest edge in the
  /// end.
  double tolerance = 0.1;
  Patch side;  ///< patch of the new faces between the rims of two ends; none by default
};

/// How two ends were joined.
enum class Reconnection : std::uint8_t {
  sewn,    ///< faces matched and lay together: they are inner faces now
  paired,  ///< faces matched but lay apart: a cell is between each two of them
  bridged  ///< faces did not match: one cell has all of them
};

/// The effects of reconnect().
struct Reconnected {
  Reconnection how = Reconnection::sewn;
  std::vector<Cell> cells;  ///< sewn: cells with changed faces or corners; else: the new cells
  double shift = 0.0;       ///< sewn: largest distance that a corner of b moved to its counterpart in a (m)
};

/// Joins two ends. An end is a set of open faces, each named once. Ends match if their faces have the same degrees and
/// meet in the same way, seen from opposite sides. If there are several ways to match them, the one with the smallest
/// sum of squared distances is taken.
///
///  - Ends that match and lie together are sewn. Corners of a keep their places and numbers.
///  - Ends that match and are apart: the gap is filled with a cell for each pair of faces.
///  - Ends that do not match: the gap is filled with a single cell, with a strip of triangles between the two rims.
///    Each rim must then be one simple loop. The cell must be star-shaped, or commit() refuses it.
///
/// A new cell is free if the cells that it joins are free. A cell between a free and a blocked cell is blocked.
///
/// Throws InvalidArgument if an end has no faces, or a face does not exist or is named twice. It also throws if the
/// tolerance is negative or there is no such patch. Throws EditRefused if a face is not open, ends with a gap have a
/// corner in common, or a rim is not a simple loop. It also does so if a single cell would join free and blocked
/// cells. Then everything is unchanged. Cost: that of the cells at the ends, times the number of starts of a match
/// that look better than the best (few, where ends face each other).
Reconnected reconnect(ComplexEdit& edit, std::span<const CellFace> a, std::span<const CellFace> b,
                      const ReconnectOptions& options = {});

}  // namespace dartcast
