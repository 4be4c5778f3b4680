// The message of an edit that is refused.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <string>

#include "dartcast/error.hpp"

namespace dartcast::test {

inline std::string refusal(const std::function<void()>& apply_impulse) {
  try {
    apply_impulse();
  } catch (const EditRefused& e) {
    return std::string("refused: ") + e.what();
  } catch (const InvalidArgument& e) {
    return std::string("invalid: ") + e.what();
  }
  return "done";
}

inline void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << "no \"" << part << "\" in: " << text;
}

}  // namespace dartcast::test
