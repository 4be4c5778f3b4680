// Removal of bad cells from a mesh file.
#pragma once

#include "base/parallel.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Leaves the bad cells out of a file that was read (complex/skip_bad_cells.hpp). The report is then of the other
/// cells, and its first warning counts those left out. A file with other defects stays as it is, refused.
void skip_bad_cells(MeshFile& file, Threads threads = {});

}  // namespace dartcast
