// All darts of a map.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast::test {

inline std::vector<Dart> all_darts(const CombinatorialMap& map) {
  std::vector<Dart> darts;
  for (const Cell c : map.cells()) {
    for (std::uint16_t d = 0; d < map.shape(c).dart_count(); ++d) darts.push_back({c, d});
  }
  return darts;
}

}  // namespace dartcast::test
