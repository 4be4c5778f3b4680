// Checks a mesh step by step, repairs it if the repair is certain, and reports the rest.
#include <algorithm>

#include "dartcast/mesh_check.hpp"
#include "dartcast/predicates.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/conformity.hpp"
#include "mesh/faces.hpp"
#include "mesh/manifold.hpp"
#include "mesh/orientation.hpp"
#include "mesh/planar_mesh.hpp"
#include "mesh/polyhedron.hpp"
#include "mesh/repeated_points.hpp"
#include "mesh/structure.hpp"

namespace dartcast {
namespace {

std::size_t source_of(const MeshData& mesh, std::size_t c) { return mesh.source.empty() ? c : mesh.source[c]; }

void count_contents(const MeshData& mesh, MeshReport& report) {
  report.points = mesh.points.size();
  report.periodic = mesh.periodic;
  std::size_t by_type[cell_type_names.size()] = {};
  for (const CellType t : mesh.types) ++by_type[static_cast<std::size_t>(t)];
  for (std::size_t t = 0; t < cell_type_names.size(); ++t) {
    if (by_type[t] > 0) report.cells[std::string(cell_type_names[t])] = by_type[t];
  }
  std::map<std::int32_t, std::size_t> by_tag;
  for (const std::int32_t tag : mesh.regions) ++by_tag[tag];
  for (const auto& [tag, count] : by_tag) {
    const auto name = mesh.region_names.find(tag);
    report.regions[name != mesh.region_names.end() ? name->second : std::to_string(tag)] += count;
  }
}

void check_coordinates(const MeshData& mesh, const std::vector<std::uint32_t>& point_source, MeshReport& report) {
  Finding not_finite{"not_finite", 0, {}, "points with a coordinate that is not a finite number"};
  Finding out{"out_of_range", 0, {}, "points with a coordinate too large for exact signs (above 2^300, 2e+90)"};
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (in_exact_range(mesh.points[p])) continue;
    (is_finite(mesh.points[p]) ? out : not_finite).add(point_source[p]);
  }
  add_finding(report.defects, not_finite);
  add_finding(report.defects, out);
}

void check_repeated_points(const MeshData& mesh, const std::vector<std::uint32_t>& point_source, MeshReport& report) {
  Finding finding{
      "repeated_points",
      0,
      {},
      "points at the place of another one: the cells on both sides are not connected, and particles meet a wall "
      "there; merge the points unless that is meant"};
  for (const std::uint32_t p : find_repeated_points(mesh.points)) finding.add(point_source[p]);
  add_finding(report.warnings, finding);
}

void close_polyhedra(MeshData& mesh, MeshReport& report) {
  Finding turned{"polyhedron_faces", 0, {}, "polyhedra with faces that disagreed; they have been turned over"};
  Finding open{"polyhedron", 0, {}, "polyhedra whose faces are not one closed surface with every edge used twice"};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.types[c] != CellType::polyhedron) continue;
    const Closure closure = close_polyhedron(mesh, c);
    if (closure == Closure::repaired) turned.add(source_of(mesh, c));
    if (closure == Closure::open) open.add(source_of(mesh, c));
  }
  add_finding(report.repairs, turned);
  add_finding(report.defects, open);
}

void orient_cells(MeshData& mesh, MeshReport& report) {
  const bool plane = mesh.dimension() == 2;
  Finding mirrored{"orientation",
                   0,
                   {},
                   plane ? "cells ran clockwise; their corners have been reordered"
                         : "cells were inside out; their corners have been reordered"};
  Finding flat{
      "flat",
      0,
      {},
      plane ? "cells without area; remove them from the mesh" : "cells without volume; remove them from the mesh"};
  Finding inverted{"inverted",
                   0,
                   {},
                   plane ? "cells that are not convex, cross themselves, or have two corners in a row at one place; "
                           "check the order of their corners, or remesh them"
                         : "cells that stay inverted in whichever order: as many corners turn inwards as outwards; "
                           "check the order of their corners, or remesh them"};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    switch (orient_cell(mesh, c)) {
      case Orientation::positive: break;
      case Orientation::mirrored: mirrored.add(source_of(mesh, c)); break;
      case Orientation::flat: flat.add(source_of(mesh, c)); break;
      case Orientation::inverted: inverted.add(source_of(mesh, c)); break;
    }
  }
  add_finding(report.repairs, mirrored);
  add_finding(report.defects, flat);
  add_finding(report.defects, inverted);
}

void add_cells(const MeshData& mesh, std::vector<std::uint32_t> cells, Finding finding, std::vector<Finding>& list) {
  std::sort(cells.begin(), cells.end());
  for (const std::uint32_t c : cells) finding.add(source_of(mesh, c));
  add_finding(list, std::move(finding));
}

void check_faces(const MeshData& mesh, const FaceMatch& match, MeshReport& report) {
  report.parts = match.parts;
  add_cells(mesh, match.crowded,
            {"face_shared", 0, {}, "faces (in the plane edges) used by three cells or more; one of the cells is named"},
            report.defects);
  std::vector<std::uint32_t> same_side;
  for (const auto& cells : match.same_side) same_side.push_back(cells[0]);
  add_cells(
      mesh, std::move(same_side),
      {"same_side",
       0,
       {},
       "faces (in the plane edges) that two cells use from the same side: the cells overlap; one of them is named"},
      report.defects);
  add_cells(mesh, match.twisted,
            {"face_order", 0, {}, "faces whose corners two cells give in different orders; one of the cells is named"},
            report.defects);
}

void check_boundary(const MeshData& mesh, const FaceMatch& match, const std::vector<std::uint32_t>& point_source,
                    MeshReport& report) {
  const BoundaryFaces& boundary = match.boundary;
  const bool plane = mesh.dimension() == 2;
  const Conformity conformity = plane ? find_unmatched_edges(mesh, boundary) : find_unmatched_faces(mesh, boundary);
  std::vector<std::uint32_t> cells;
  for (const std::uint32_t f : conformity.faces) cells.push_back(boundary.cells[f]);
  add_cells(
      mesh, std::move(cells),
      {"non_conforming",
       0,
       {},
       plane ? "edges that lie against other cells' edges without matching them, or have a point inside: particles "
               "meet a wall there; make the mesh conforming unless that is meant"
             : "faces that lie against other cells' faces without matching them: particles meet a wall "
               "there; make the mesh conforming unless that is meant"},
      report.warnings);
  if (!conformity.complete) {
    report.warnings.push_back(
        {"unfinished", 1, {0}, "too many boundary faces overlap for all non-conforming ones to be found"});
  }
  const Pinches pinches = find_pinches(match);
  Finding edges{"boundary_edges", 0, {}, "edges where the boundary meets itself; one end of each is named"};
  for (const std::uint32_t p : pinches.edges) edges.add(point_source[p]);
  add_finding(report.warnings, edges);
  Finding points{"boundary_points", 0, {}, "points where the boundary of one part touches itself"};
  for (const std::uint32_t p : pinches.points) points.add(point_source[p]);
  add_finding(report.warnings, points);
}

void check_cells(MeshData& mesh, const std::vector<std::uint32_t>& point_source, MeshReport& report) {
  close_polyhedra(mesh, report);
  if (!report.valid()) return;
  orient_cells(mesh, report);
  const FaceMatch match = match_faces(mesh);
  check_faces(mesh, match, report);
  drop_stray_patch_faces(mesh, report);
  check_boundary(mesh, match, point_source, report);
}

}  // namespace

MeshReport check_and_repair(MeshData& mesh) {
  MeshReport report;
  check_arrays(mesh, report);
  if (!report.valid()) return report;
  check_and_repair_structure(mesh, report);
  if (report.valid()) {
    const std::vector<std::uint32_t> point_source = drop_unused_points(mesh, report);
    check_coordinates(mesh, point_source, report);
    if (report.valid()) {
      if (mesh.dimension() == 2) put_in_plane(mesh, point_source, report);
      check_repeated_points(mesh, point_source, report);
      if (report.valid()) check_cells(mesh, point_source, report);
    }
  }
  report.dimension = static_cast<int>(mesh.dimension());
  count_contents(mesh, report);
  return report;
}

}  // namespace dartcast
