// Cells split along a plane.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

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

}  // namespace dartcast
