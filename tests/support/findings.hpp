// The findings of a mesh check, by kind.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
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

}  // namespace dartcast::test
