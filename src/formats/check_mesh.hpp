// The whole verdict on a mesh file: `dartcast check`.
#pragma once

#include <filesystem>

#include "base/parallel.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Reads and inspects a file; one of a surface in space as check_surface() does. Of a mesh without a defect also
/// divides every cell into simplices: a cell that has no division into positive ones, not even around a point of its
/// own, is a defect of kind "not_star_shaped". With `without_bad_cells` these, and cells that are flat or inverted, are
/// left out, and are a warning (see complex/skip_bad_cells.hpp). Throws nothing for a file's content.
MeshFile check_mesh(const std::filesystem::path& path, Threads threads = {}, const ReadOptions& options = {},
                    bool without_bad_cells = false);

}  // namespace dartcast
