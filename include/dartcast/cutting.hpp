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

/// A plane with a side below, where dot(normal, x) < offset, and one above.
struct Plane {
  Vec3 normal = {0.0, 0.0, 1.0};  ///< a unit vector
  double offset = 0.0;            ///< m

  [[nodiscard]] double height(const Vec3& x) const { return dot(normal, x) - offset; }
  [[nodiscard]] Plane turned() const { return {-normal, -offset}; }
};

/// Throws InvalidArgument where a number is not finite or the normal, of any length, has none.
Plane plane_through(const Vec3& point, const Vec3& normal);

struct SectionOptions {
  /// Vertices count as on the plane that are nearer to it than this share of the mean edge of the cells to be split (or
  /// of `finest`, where that is less): so no part comes out much thinner than that, where the plane runs along faces
  /// nothing is split, and the section bends by no more. It is one distance for all vertices: then no flat face can
  /// change sides more than twice.
  double snap = 1.0 / 32.0;
  /// Less would take the rounding of vertices that lie on the plane for a distance.
  static constexpr double min_snap = 0x1p-30;
  /// What must not be lost to that: say, the width of a layer that two planes bound (m).
  double finest = std::numeric_limits<double>::infinity();
};

/// Cells on either side of a plane: parts of those that were split, and cells that it does not cross. As in all of
/// surgery they are those of the open edit: commit() may give them points, and its report tells what they are then.
struct Section {
  std::vector<Cell> below, above;
  /// Among these, cells that the plane crosses in no simple loop, for their faces are strongly warped: they stay whole,
  /// on the side of the mean of their corners.
  std::vector<Cell> whole;
};

/// Splits cells by a plane. Each vertex is judged once, so that all cells agree; the new vertex of an edge lies where
/// the plane crosses it, rounded. Cells around that are not named take the new vertices and edges into their faces, and
/// stay whole. Parts keep the cell's free mark, and a face's its patch; the new faces have none.
///
/// Throws InvalidArgument where there is no such cell, or it is named twice, or snap is not in [2^-30, 1/4]; and what
/// the edits of dartcast/map_edits.hpp throw; everything is then as it was. That parts are valid is for commit() to
/// judge. Cost: linear in the cells named and those around them.
Section split_by_plane(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane,
                       const SectionOptions& options = {});

// Bodies to cut with: convex ones, as the planes that bound them.

/// The points below all of its planes.
struct ConvexTool {
  std::vector<Plane> planes;
  double finest = std::numeric_limits<double>::infinity();  ///< its least width (m): see SectionOptions
};

/// A flat disc, taken as the regular polygon in its circle.
struct Disc {
  Vec3 centre;
  Vec3 normal = {0.0, 0.0, 1.0};  ///< of any length
  double radius = 1.0;            ///< m
  std::uint32_t sides = 24;
};

/// What a straight blade sweeps: its two ends, place after place.
struct BladePath {
  std::vector<std::array<Vec3, 2>> places;
};

// What is at most width / 2 from a surface, up to corners. These throw InvalidArgument where a number is not finite, a
// width or radius is not positive, or as they say.

std::vector<ConvexTool> thicken(const Plane& plane, double width);
/// Throws where there are not 3 to 1000 sides.
std::vector<ConvexTool> thicken(const Disc& disc, double width);
/// One tool for what the blade sweeps between two places, or two where that is not flat, joined along planes that
/// halve the angles between them. Throws where there are not two places, the blade has no length or
/// does not move, or turns back onto itself.
std::vector<ConvexTool> thicken(const BladePath& path, double width);

/// An upright box. Throws InvalidArgument where it is empty or not finite.
ConvexTool box_tool(const Vec3& low, const Vec3& high);
/// The ends of a rod with a round head and foot, or of a ball (where a is b), as 26 planes that touch it: it holds all
/// of the capsule, and reaches at most 1.13 radii from the line between a and b. Throws as above.
ConvexTool capsule_tool(const Vec3& a, const Vec3& b, double radius);

/// The cells of the complex that no plane of a tool has on its outside: all that the tools meet, and perhaps some near
/// their edges. In the order of CombinatorialMap::cells(). Cost: one pass over the scene.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools);
/// The same, of the cells that are reached from `start` through such cells. Throws InvalidArgument where there is no
/// such cell; empty where it is none of them. Cost: that of the cells returned and their neighbours.
std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools, Cell start);

// Cutting and carving: what lies in a tool becomes free, or is taken away.

enum class Carving : std::uint8_t {
  open,    ///< blocked cells in the tool become free: particles can enter. Free ones are not split at all.
  remove,  ///< cells in the tool are taken away, free ones, too: their neighbours' faces are the boundary
};

struct CarveOptions {
  /// Cells are not split: those are taken whole whose corners' mean is in the tool.
  bool whole_cells = false;
  double snap = SectionOptions{}.snap;  ///< see SectionOptions
};

struct Carved {
  std::vector<Cell> opened;  ///< cells that are free now
  std::size_t removed = 0;   ///< cells taken away
  std::vector<Cell> whole;   ///< cells that could not be split (see Section), and may reach into the tools or out
};

/// Opens or takes away what lies in some tools: cells that a tool meets are split by its planes, one after another, and
/// only what is left inside goes on to the next, so that a tool may end inside cells. `cells`: those that are
/// concerned, such as cells_near() finds; others are not split. The scene is watertight where tissue has become
/// free: nothing is parted.
///
/// Throws InvalidArgument where a cell is not there or is named twice, or snap is not in [2^-30, 1/4]; and what
/// split_by_plane() throws; everything is then as it was. Cost: that of the cells named and those around them.
Carved carve(ComplexEdit& edit, std::span<const Cell> cells, std::span<const ConvexTool> tools, Carving what,
             const CarveOptions& options = {});

/// Opens tissue along a surface (Plane, Disc, BladePath): blocked cells are split by its two sides, and the layer
/// between becomes free. As carve(); and throws as thicken().
template <class Surface>
Carved cut(ComplexEdit& edit, std::span<const Cell> cells, const Surface& surface, double width,
           const CarveOptions& options = {}) {
  return carve(edit, cells, thicken(surface, width), Carving::open, options);
}

/// Open faces of some cells (all corners at most `within` metres from a plane), such as those of an end of a vessel
/// that was cut through. Cost: linear in the cells.
std::vector<CellFace> open_faces(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane, double within);

// Tying a vessel.

/// Ties a vessel: blocks the free cells of one cross-section, those that the plane crosses and that hang together with
/// `start` by faces within it. Cells that touch the plane from below count as crossed, so that it always seals: no free
/// cell below the plane is a neighbour of one above there. Returns the cells blocked; freeing them unties it.
///
/// Throws InvalidArgument where `start` is not there, is blocked, or is not crossed. Cost: that of the cells blocked
/// and their neighbours.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, Cell start);
/// The same at the crossed free cell whose corners' mean is nearest to `place`. Throws InvalidArgument where the plane
/// crosses no free cell. Cost: one pass over the scene besides.
std::vector<Cell> ligature(ComplexEdit& edit, const Plane& plane, const Vec3& place);

struct TyingOptions {
  double share = 0.5;  ///< of the way to the middle of the section that its walls go, in [0, 1)
  double reach = 1.0;  ///< m: the motion fades out at this distance from the plane, and from the section's rim
};

/// Where vertices go when a ligature draws the walls of the vessel together: towards the middle of the section in
/// parallel to the plane, those of the section by `share` of the way, others less, fading out smoothly. For
/// Environment::move_until_inverted(). `section`: cells of the complex, such as ligature() returned; `positions`: some
/// or all of the complex's, changed in place. Throws InvalidArgument where a cell is not there, none is named, or an
/// option is out of range. Cost: linear in the positions.
void draw_together(const CellComplex& complex, std::span<const Cell> section, const Plane& plane,
                   const TyingOptions& options, std::span<Vec3> positions);

// Sewing the ends of a vessel together.

struct ReconnectOptions {
  /// Ends are sewn where each corner lies within this share of its shortest edge in the end from its counterpart.
  double tolerance = 0.1;
  Patch side;  ///< of the new faces between the rims of two ends; none by default
};

enum class Reconnection : std::uint8_t {
  sewn,    ///< faces matched and lay together: they are inner faces now
  paired,  ///< faces matched but lay apart: a cell is between each two of them
  bridged  ///< faces did not match: one cell has all of them
};

struct Reconnected {
  Reconnection how = Reconnection::sewn;
  std::vector<Cell> cells;  ///< sewn: cells whose faces or corners changed; else: the new cells
  double shift = 0.0;       ///< sewn: the farthest that a corner of b went to its counterpart in a (m)
};

/// Joins two ends: sets of open faces, of which each is named once. Ends match where their faces have the same degrees
/// and meet in the same way, seen from opposite sides; of several ways to match them the one with the least sum of
/// squared distances is taken. Where they match and lie together they are sewn: corners of a keep their places and
/// numbers. Where they match and are apart the gap is filled with a cell for each pair of faces. Otherwise it is filled
/// with a single cell, with a strip of triangles between the two rims, each of which must then be one simple loop; it
/// must be star-shaped, or commit() refuses it. A new cell is free where the cells that it joins are; one between a
/// free and a blocked cell is blocked.
///
/// Throws InvalidArgument where an end has no faces, a face is not there or is named twice, the tolerance is negative
/// or there is no such patch; EditRefused where a face is not open, ends in need of a filling have a corner in common,
/// a single cell would join free and blocked cells, or a rim is no simple loop; everything is then as it was. Cost:
/// that of the cells at the ends, times the ways to begin a match that look better than the best (few, where ends face
/// each other).
Reconnected reconnect(ComplexEdit& edit, std::span<const CellFace> a, std::span<const CellFace> b,
                      const ReconnectOptions& options = {});

}  // namespace dartcast
