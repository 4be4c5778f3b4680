// Where the boundary of a mesh is pinched.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/faces.hpp"

namespace dartcast {

struct Pinches {
  std::vector<std::uint32_t> edges;  ///< one end of each boundary edge that more or fewer than two boundary faces use
  std::vector<std::uint32_t>
      points;  ///< points where the boundary of one part touches itself, ends of such edges left out
};

/// In the plane points alone can be pinched. Precondition: the result of match_faces() for oriented cells. Cost: n
/// log n in the boundary faces.
Pinches find_pinches(const FaceMatch& match);

}  // namespace dartcast
