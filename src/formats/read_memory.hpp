// Upper bounds of the memory that reading a file takes, checked before it is taken.
#pragma once

#include <cstdint>
#include <string_view>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Sizes that a file announces, summed up.
struct ReadSizes {
  std::uint64_t file = 0;  ///< bytes
  std::uint64_t points = 0;
  std::uint64_t cells = 0;
  std::uint64_t corners = 0;  ///< numbers of their connectivity, and of the faces of polyhedra
  std::uint64_t values = 0;   ///< numbers at points and cells
  std::uint64_t decoded = 0;  ///< bytes of all arrays as they are decoded, those of cells apart
};

/// Bytes that the process takes at most while it reads a file of VTK with these sizes and builds the map from the
/// mesh. The sum in bytes: 48 * 2^20 for the program and for free small blocks that the allocator keeps; the file;
/// and the largest of three stages. Reading: the decoded arrays, 18 a corner and 20 a cell for cells as they are read,
/// and the mesh. Check: the mesh, 32 a corner for faces, 48 a point, 8 a cell. The map: the mesh, 32 a corner, 24 a point
/// and a cell. The mesh takes 32 a point, 10 a corner, 32 a cell and 8 a value. Sums stop at 2^63. Steiner points
/// inside cells are not counted.
std::uint64_t memory_of_vtk(const ReadSizes& sizes);

/// The same for a file whose numbers are read one by one, up to its mesh: no format takes more than ten times the
/// file.
std::uint64_t memory_of_text(std::uint64_t file);

/// The same for a mesh that has been read: the memory that its check and the map add.
std::uint64_t memory_of_mesh(const MeshData& mesh);

/// The limit that is meant: 0 is half of the machine's memory.
std::uint64_t allowed_memory(std::uint64_t limit);

/// Throws InvalidMesh, with both numbers and the remedy, if `bytes` is more than the limit; 0: half of the machine's
/// memory.
void check_memory(std::uint64_t bytes, std::uint64_t limit);

}  // namespace dartcast
