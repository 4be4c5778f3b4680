// Statistics as files for ParaView.
#pragma once

#include <filesystem>
#include <span>

#include "dartcast/environment.hpp"
#include "dartcast/statistics.hpp"

namespace dartcast {

/// Writes a .vtp: all walls of free cells as polygons, in the plane as lines, at the environment's positions. Arrays of
/// the faces: `hits` (Int64), `hits_per_area` (per m^2; in the plane per m; 0 if a face has no area), `patch` (the
/// number of the patch; 0: none), `cell` (`source` of the free cell). The field array `patch_names` has a text "NUMBER
/// NAME" for each patch. `hits`: of this environment. Throws InvalidArgument if the name does not end in .vtp; Error
/// if the file cannot be written.
void write_wall_hits(const Environment& environment, const WallHits& hits, const std::filesystem::path& file);

/// Writes a .vtp: a polyline for each particle, by id. `points`: of any number of steps, one after the other
/// (Statistics::path_points). Arrays of the points: `time`, `velocity`, `contact` (1 at contacts). Array of the lines:
/// `id`. Throws as above, and Error if there are more than 2^32 - 1 points.
void write_pathlines(std::span<const PathPoint> points, const std::filesystem::path& file);

}  // namespace dartcast
