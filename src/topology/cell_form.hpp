// The form of a cell in a record: its first corner, and the key of its shape.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_shape.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Corners of a cell of a standard type. Places that the type does not use are zero.
using StandardCorners = std::array<std::uint32_t, 8>;

/// The same cell with its corners in the order that comes first among the rotations of the type onto itself. So few
/// shapes serve all cells, and the order is still valid for the type. Cost: rotations times corners.
StandardCorners turned(CellType type, std::span<const std::uint32_t> corners);

/// The signature of a standard cell's shape: its type and the lowest-numbered corner of each face.
std::uint32_t standard_signature(CellType type, std::span<const std::uint32_t> corners);

/// The key of that shape: faces in the order of standard_faces(), corners as given.
ShapeKey standard_key(CellType type, std::span<const std::uint32_t> corners);

/// A face of local numbers, rotated to start at its lowest-numbered vertex. `vertices`: by local number.
void set_from_lowest(std::vector<std::uint16_t>& face, std::span<const std::uint16_t> corners,
                     std::span<const std::uint32_t> vertices);

/// Local number of the lowest-numbered vertex.
std::uint16_t lowest_corner(std::span<const std::uint32_t> vertices);

}  // namespace dartcast
