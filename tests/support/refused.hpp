// What tests of refusals share.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::test {

/// n x n x n unit cubes.
inline MeshData cubes(std::uint32_t n) {
  BoxOptions o;
  o.cells = {n, n, n};
  o.size = {double(n), double(n), double(n)};
  return generate_box(o);
}

/// The call must throw InvalidArgument, with these words in it.
inline void expect_refused(const std::function<void()>& call, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

}  // namespace dartcast::test
