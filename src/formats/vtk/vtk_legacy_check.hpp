// Checks of a legacy .vtk file before VTK reads it.
#pragma once

#include <cstdint>
#include <string_view>

namespace dartcast {

/// Walks through the whole file. It checks the header and every section, every count against the bytes that are there,
/// and every number of an ASCII file. It checks the numbers of corners, the faces of polyhedra, and the names of arrays:
/// each once at the points, at the cells, in the file. Throws InvalidMesh with the line (or byte) where something is wrong, or where the data set
/// is not an unstructured grid. VTK may then read the file without reaching beyond its arrays. Point numbers are not
/// checked. `max_memory`: as of ReadOptions, for VTK and the mesh.
void check_legacy_vtk(std::string_view content, std::uint64_t max_memory = 0);

}  // namespace dartcast
