// How a cell is put down in a record: which corner comes first, and the key of its shape.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dartcast/cell_shape.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Corners of a cell of a standard type; behind the type's own number of them, zeros.
using StandardCorners = std::array<std::uint32_t, 8>;

/// The same cell with its corners in the order that comes first among the rotations of the type onto itself: so few
/// shapes serve all cells, and the order is still a valid one of the type. Cost: rotations times corners.
StandardCorners turned(CellType type, std::span<const std::uint32_t> corners);

/// What tells the shape of a standard cell: its type and, for each face, which corner is the lowest-numbered.
std::uint32_t standard_signature(CellType type, std::span<const std::uint32_t> corners);

/// The key of that shape: faces in the order of standard_faces(), corners as given.
ShapeKey standard_key(CellType type, std::span<const std::uint32_t> corners);

/// A face of local numbers, turned to begin at its lowest-numbered vertex; `vertices` by local number.
ShapeKey::Face from_lowest(std::span<const std::uint16_t> corners, std::span<const std::uint32_t> vertices);

/// Local number of the lowest-numbered vertex.
std::uint16_t lowest_corner(std::span<const std::uint32_t> vertices);

}  // namespace dartcast
