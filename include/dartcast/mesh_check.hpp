// Checks of a mesh before anything is built from it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

// The report on a mesh: its content, its repairs and its defects. `dartcast check` prints it.

/// One kind of finding in a mesh: how often it occurs, and the first places (indices in the input file, at most ten).
struct Finding {
  std::string kind;
  std::size_t count = 0;
  std::vector<std::size_t> first;
  std::string message;

  /// Counts one more occurrence, at this place.
  void add(std::size_t place) {
    ++count;
    if (first.size() < 10) first.push_back(place);
  }
};

/// The outcome of a check: the mesh is taken as it is, repaired, taken with warnings, or refused.
enum class Verdict { accept, repair, warn, refuse };

/// The report. A mesh with a defect is refused. Other meshes can be used as they are, repaired, or with warnings.
struct MeshReport {
  std::string file;
  std::string format;
  int dimension = 3;                           ///< 2: a planar mesh, whose cells are polygons and whose faces are edges
  bool surface = false;                        ///< cells of two dimensions in space
  std::size_t points = 0;                      ///< after repairs
  std::map<std::string, std::size_t> cells;    ///< cells by type
  std::map<std::string, std::size_t> regions;  ///< cells by region; the tag is the name of a region without one
  std::size_t parts = 0;                       ///< groups of cells connected by faces
  std::vector<PeriodicPair> periodic;          ///< the mesh's pairs of patches
  std::vector<Finding> repairs;
  std::vector<Finding> warnings;
  std::vector<Finding> defects;

  [[nodiscard]] bool valid() const { return defects.empty(); }
  [[nodiscard]] Verdict verdict() const {
    if (!defects.empty()) return Verdict::refuse;
    if (!warnings.empty()) return Verdict::warn;
    return repairs.empty() ? Verdict::accept : Verdict::repair;
  }
};

/// The name of a verdict: accept, repair, warn or refuse.
constexpr std::string_view verdict_name(Verdict v) {
  constexpr std::string_view names[] = {"accept", "repair", "warn", "refuse"};
  return names[static_cast<int>(v)];
}

/// Appends a finding unless it is empty.
inline void add_finding(std::vector<Finding>& list, Finding finding) {
  if (finding.count > 0) list.push_back(std::move(finding));
}

/// Repairs a mesh in place if no guess is needed, and reports it:
///
///  - collapsed: cells with repeated corners, as a prism in the form of a hexahedron, get the type that they have
///    without;
///  - orientation: cells that were inside out;
///  - polyhedron_faces: faces that disagreed with their neighbours;
///  - unused_points: dropped;
///  - plane: points of a planar mesh with one z that is not 0.
///
/// Warns about findings with which the mesh can be used with care:
///
///  - repeated_points;
///  - non_conforming: cells next to each other without matching faces. Particles meet a wall there;
///  - boundary_edges and boundary_points: pinched;
///  - patch_faces: faces that are not a cell's face; dropped;
///  - inner_faces, of check_mesh() alone: patch faces between two free cells, which are no walls;
///  - unfinished.
///
/// Refuses a mesh for:
///
///  - empty;
///  - structure: array sizes, cells of two dimensions;
///  - polyhedron: faces that are not closed, more than 1000 faces, fewer than three corners;
///  - id_out_of_range, repeated_corner;
///  - not_finite, out_of_range: coordinates;
///  - flat, inverted;
///  - face_shared: by three cells or more;
///  - same_side: two cells on one side of a face;
///  - face_order: one set of corners in two orders;
///  - no_volume: a surface in space;
///  - too_large.
///
/// Places are indices in the input: of cells (MeshData::source), of patch faces (MeshData::patch_source), or of points
/// for findings about points.
///
/// In a mesh of the plane (report.dimension = 2) faces are edges, and cells that are not weakly convex are inverted.
/// `non_conforming` are edges that hold a point of another, or lie against others. There are no boundary_edges.
///
/// It never throws, whatever the arrays contain. Cost: n log n, about 2 us a hexahedron; 40 bytes a face.
MeshReport check_and_repair(MeshData& mesh);

}  // namespace dartcast
