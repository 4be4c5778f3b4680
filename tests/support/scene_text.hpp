// The text of scenes, and the errors that it gives.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "dartcast/error.hpp"
#include "dartcast/scene_file.hpp"

namespace dartcast::test {

inline const std::string box = "[environment]\ngenerator = 'box'\n";

// The text of the error that a scene gives; empty: none.
inline std::string error_of(const std::string& text) {
  try {
    parse_scene(text, "folder/scene.toml");
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

inline void expect_error(const std::string& text, const std::string& start, const std::string& part) {
  const std::string error = error_of(text);
  EXPECT_EQ(error.rfind("folder/scene.toml:" + start, 0), 0U) << text << "\n-> " << error;
  EXPECT_NE(error.find(part), std::string::npos) << text << "\n-> " << error;
}

}  // namespace dartcast::test
