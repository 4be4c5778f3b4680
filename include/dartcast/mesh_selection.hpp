// Which cells particles may enter: by region or by an array of the file.
#pragma once

#include <span>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Sets mesh.free to 1 in the cells of the regions named, 0 elsewhere. A region goes by its name or by its tag in
/// digits. Throws InvalidMesh, naming the regions there are, where a name is none of them; mesh.free is unchanged then.
void select_free_regions(MeshData& mesh, std::span<const std::string> regions);

/// The same by a cell array of one component: free where its value is one of `values`.
/// Throws InvalidMesh, naming the arrays there are, where there is no such array or it has several components, or where
/// no cell has one of the values.
void select_free_values(MeshData& mesh, const std::string& array, std::span<const double> values);

}  // namespace dartcast
