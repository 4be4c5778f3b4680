// The full check of a mesh file, with the division of its cells into simplices.
#include <fmt/format.h>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/skip_in_file.hpp"

namespace dartcast {

namespace {

Finding indivisible_cells(const MeshData& mesh, Threads threads) {
  const CellComplex complex(mesh, threads);
  Finding finding{
      "not_star_shaped", 0, {}, "cells that cannot be divided into positive simplices; mend or remesh them"};
  for (const InvalidCell& invalid : complex.invalid_cells()) finding.add(complex.map().source(invalid.cell));
  return finding;
}

}  // namespace

MeshFile check_mesh(const std::filesystem::path& path, Threads threads, const ReadOptions& options,
                    bool without_bad_cells) {
  if (is_surface_file(path)) return check_surface(path, options);
  MeshFile file = read_mesh(path, options);
  if (without_bad_cells) skip_bad_cells(file, threads);
  if (!file.report.valid()) return file;
  try {
    add_finding(file.report.defects, indivisible_cells(file.mesh, threads));
  } catch (const InvalidMesh& e) {
    file.report.defects.push_back({"structure", 1, {}, e.what()});
  }
  return file;
}

}  // namespace dartcast
