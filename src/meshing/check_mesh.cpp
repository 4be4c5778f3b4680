// The full check of a file: of a mesh, with the division of its cells into simplices; of a surface, as one to mesh around.
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/skip_in_file.hpp"
#include "mesh/patch_walls.hpp"
#include "meshing/closed_surfaces.hpp"

namespace dartcast {

namespace {

Finding indivisible_cells(const MeshData& mesh, Threads threads) {
  const CellComplex complex(mesh, threads);
  Finding finding{
      "not_star_shaped", 0, {}, "cells that cannot be divided into positive simplices; mend or remesh them"};
  for (const InvalidCell& invalid : complex.invalid_cells()) finding.add(complex.map().source(invalid.cell));
  return finding;
}

// The counts are of the faces as they are in the file, not of the triangles that they are cut into.
MeshFile check_closed_surface(const std::filesystem::path& path, const ReadOptions& options) {
  MeshFile file = check_surface(path, options);
  SurfaceScene alone;
  alone.surfaces = {{"inside", path}};
  MeshReport closed = read_closed_surfaces(alone, options).report;
  file.report.repairs = std::move(closed.repairs);
  file.report.warnings = std::move(closed.warnings);
  file.report.defects = std::move(closed.defects);
  return file;
}

}  // namespace

MeshFile check_mesh(const std::filesystem::path& path, Threads threads, const ReadOptions& options,
                    bool without_bad_cells) {
  if (is_surface_file(path)) return check_closed_surface(path, options);
  MeshFile file = read_mesh(path, options);
  if (without_bad_cells) skip_bad_cells(file, threads);
  if (!file.report.valid()) return file;
  add_finding(file.report.warnings, inner_patch_faces(file.mesh));
  try {
    add_finding(file.report.defects, indivisible_cells(file.mesh, threads));
  } catch (const InvalidMesh& e) {
    file.report.defects.push_back({"structure", 1, {}, e.what()});
  }
  return file;
}

}  // namespace dartcast
