// Use of a mesh with some bad cells: these are left out, and the rest has walls around them.
#pragma once

#include <string_view>

#include "base/parallel.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Whether a defect that check_and_repair() finds is one of single cells, which skip_bad_cells() can leave out: flat,
/// inverted, same_side.
bool is_of_bad_cells(std::string_view defect);

/// Leaves out the cells that are not positive:
///
///  - flat cells;
///  - cells that no order of their corners makes positive;
///  - cells that lie inverted among their neighbours (if cells use a face from the same side, the fewer of them);
///  - cells that cannot be divided into positive simplices.
///
/// Their faces at other cells become walls without a patch, so that every guarantee holds for the rest. Regions,
/// arrays, patches and `source` are kept. The mesh is then as check_and_repair() leaves it. Returns a finding of kind
/// "bad_cells" with their number and the first of them, as indices in the input. It is empty if the mesh is good.
/// Throws InvalidMesh if the mesh has other defects, or no cell remains. Cost: that of check_and_repair() and of
/// building a complex, once more for each kind of bad cell.
Finding skip_bad_cells(MeshData& mesh, Threads threads = {});

}  // namespace dartcast
