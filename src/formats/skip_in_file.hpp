// Bad cells of a mesh file, left out. Not installed.
#pragma once

#include "base/parallel.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Leaves the bad cells out of a file that was read (complex/skip_bad_cells.hpp), and reports on what is left: those
/// left out are its first warning. Where the file has other defects it stays as it is, refused.
void skip_bad_cells(MeshFile& file, Threads threads = {});

}  // namespace dartcast
