// Makes cells of OpenFOAM's faces.
#include "formats/openfoam/poly_cells.hpp"

#include <utility>

#include "mesh/cell_faces.hpp"

namespace dartcast {
namespace {

/// The faces of a cell.
void take_faces(const PolyMesh& mesh, std::uint32_t cell, std::span<const std::uint32_t> labels, CellFaces& to) {
  to.clear();
  for (const std::uint32_t f : labels) {
    const auto face = mesh.faces[f];
    if (mesh.owner[f] == cell) {
      to.add(face.begin(), face.end());
    } else {
      to.add(face.rbegin(), face.rend());
    }
  }
}

}  // namespace

FoamLists faces_of_cells(const PolyMesh& mesh) {
  FoamLists of;
  of.offsets.assign(mesh.cells + 1, 0);
  const auto for_each = [&](auto&& visit) {
    for (std::uint32_t f = 0; f < mesh.owner.size(); ++f) {
      visit(mesh.owner[f], f);
      if (mesh.neighbour[f] != none) visit(mesh.neighbour[f], f);
    }
  };
  for_each([&](std::uint32_t cell, std::uint32_t /*face*/) { ++of.offsets[cell + 1]; });
  for (std::size_t c = 0; c < mesh.cells; ++c) of.offsets[c + 1] += of.offsets[c];
  of.labels.resize(of.offsets.back());
  std::vector<std::size_t> at(of.offsets.begin(), of.offsets.end() - 1);
  for_each([&](std::uint32_t cell, std::uint32_t face) { of.labels[at[cell]++] = face; });
  return of;
}

ParsedMesh mesh_in_space(PolyMesh mesh) {
  ParsedMesh parsed;
  CellFaces faces;
  const FoamLists of_cells = faces_of_cells(mesh);
  for (std::uint32_t c = 0; c < mesh.cells; ++c) {
    take_faces(mesh, c, of_cells[c], faces);
    add_cell(faces, parsed.mesh);
  }
  parsed.mesh.points = std::move(mesh.points);
  add_zones_and_patches(
      mesh, [&](std::uint32_t f) { return mesh.faces[f]; }, parsed);
  return parsed;
}

}  // namespace dartcast
