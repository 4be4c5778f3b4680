// Leaves repeated corners out of faces. The faces that stay are those of the new cell.
#include "mesh/collapsed.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "mesh/cell_faces.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

using CornerList = std::vector<std::uint32_t>;

bool names_twice(CornerList corners) {
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

/// Without corners that are the one before them, around the face.
CornerList without_repeats(std::span<const std::uint32_t> face) {
  CornerList out;
  for (const std::uint32_t p : face) {
    if (out.empty() || out.back() != p) out.push_back(p);
  }
  while (out.size() > 1 && out.front() == out.back()) out.pop_back();
  return out;
}

/// Whether each edge is used once in each direction.
bool is_closed(const CellFaces& faces) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      if (!edges.insert({face[k], face[(k + 1) % face.size()]}).second) return false;
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) { return edges.contains({e.second, e.first}); });
}

/// Adds cell c of the mesh without its repeated corners. Whether that is a cell; of a standard type, if c is of one.
bool add_collapsed(const MeshData& mesh, std::size_t c, MeshData& to) {
  if (dimension(mesh.types[c]) == 2) {
    const CornerList corners = without_repeats(mesh.cell(c));
    if (corners.size() < 3 || names_twice(corners)) return false;
    to.add_cell(corners.size() == 3   ? CellType::triangle
                : corners.size() == 4 ? CellType::quadrilateral
                                      : CellType::polygon,
                corners);
    return true;
  }
  CellFaces faces;
  bool plain = true;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    const CornerList corners = without_repeats(face);
    if (corners.size() < 3) return;
    plain = plain && !names_twice(corners);
    faces.add(corners.begin(), corners.end());
  });
  if (!plain || faces.size() < 4 || !is_closed(faces)) return false;
  MeshData made;
  add_cell(faces, made);
  if (made.types[0] == CellType::polyhedron && mesh.types[c] != CellType::polyhedron) return false;
  to.add_cell(made.types[0], made.cell(0));
  return true;
}

}  // namespace

bool repeats_corner(const MeshData& mesh, std::size_t c) {
  if (mesh.types[c] != CellType::polyhedron) return names_twice({mesh.cell(c).begin(), mesh.cell(c).end()});
  bool found = false;
  for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
    found = found || names_twice({face.begin(), face.end()});
  });
  return found;
}

void retype_collapsed(MeshData& mesh, MeshReport& report) {
  Finding cells{"collapsed", 0, {}, "cells that named a point twice; they have the type of their other corners now"};
  Finding faces{"collapsed", 0, {}, "patch faces that named a point twice; it has been left out"};
  MeshData out;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (repeats_corner(mesh, c) && add_collapsed(mesh, c, out)) {
      cells.add(mesh.source.empty() ? c : mesh.source[c]);
    } else {
      out.add_cell(mesh.types[c], mesh.cell(c));
    }
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto face = mesh.patch_face(f);
    const CornerList corners = without_repeats(face);
    const bool smaller = mesh.dimension() == 3 && corners.size() > 2 && corners.size() < face.size();
    if (smaller) faces.add(mesh.patch_source.empty() ? f : mesh.patch_source[f]);
    out.add_patch_face(smaller ? std::span<const std::uint32_t>(corners) : face, mesh.patch_tags[f]);
  }
  mesh.types = std::move(out.types);
  mesh.offsets = std::move(out.offsets);
  mesh.connectivity = std::move(out.connectivity);
  mesh.patch_faces = std::move(out.patch_faces);
  mesh.patch_offsets = std::move(out.patch_offsets);
  add_finding(report.repairs, cells);
  add_finding(report.repairs, faces);
}

}  // namespace dartcast
