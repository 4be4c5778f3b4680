// Squares of a plane lattice, cut or merged into cells, for the generators.
#pragma once

#include <cstdint>
#include <span>

#include "dartcast/generators.hpp"

namespace dartcast {

/// generate_rectangle() with the squares to block given: one mark each, x fastest, or none if all are free.
/// Preconditions: options that check_squares() takes, and no blocked_share.
MeshData generate_squares(const RectangleOptions& options, std::span<const std::uint8_t> blocked);

/// Throws InvalidArgument, with the name of the generator, as generate_rectangle() says.
void check_squares(const RectangleOptions& options, const char* generator);

}  // namespace dartcast
