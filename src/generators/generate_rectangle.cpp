// A rectangle of squares in the plane.
#include <vector>

#include "dartcast/generators.hpp"
#include "generators/generate_blocked.hpp"
#include "generators/generate_squares.hpp"

namespace dartcast {

MeshData generate_rectangle(const RectangleOptions& options) {
  check_squares(options, "rectangle");
  std::vector<std::uint8_t> blocked;
  if (options.blocked_share > 0.0) {
    blocked.resize(std::size_t{options.cells[0]} * options.cells[1]);
    block_share(blocked, options.blocked_share, options.seed);
  }
  return generate_squares(options, blocked);
}

}  // namespace dartcast
