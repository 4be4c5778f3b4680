// Meshes and surfaces made by others, in the folder that DARTCAST_DATA names.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace dartcast::test {

/// Empty: there is none.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("DARTCAST_DATA");
  return folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder);
}

}  // namespace dartcast::test

/// Ends a test that needs the folder where it is not there, and says which test is skipped.
#define NEED_DATA(what) \
  if (::dartcast::test::data_folder().empty()) GTEST_SKIP() << "left out without DARTCAST_DATA: " what
