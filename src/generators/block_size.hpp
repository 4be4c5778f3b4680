// The size of what a generator makes. Not installed.
#pragma once

#include "dartcast/vec3.hpp"

namespace dartcast {

/// The size that the options give, else that of cubes of edge 1.
template <class Options>
Vec3 block_size(const Options& o) {
  const auto& n = o.cells;
  return o.size.value_or(Vec3{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])});
}

}  // namespace dartcast
