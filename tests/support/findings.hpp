// The findings of a mesh check, by kind; cells written in short.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dartcast/mesh_check.hpp"

namespace dartcast::test {

using Kinds = std::map<std::string, std::size_t>;

inline Kinds kinds(const std::vector<Finding>& findings) {
  Kinds out;
  for (const Finding& f : findings) {
    EXPECT_FALSE(f.message.empty());
    EXPECT_EQ(f.first.size(), std::min<std::size_t>(f.count, 10));
    out[f.kind] += f.count;
  }
  return out;
}

inline void add(MeshData& mesh, CellType type, const std::vector<std::uint32_t>& corners) {
  mesh.add_cell(type, corners);
}

}  // namespace dartcast::test
