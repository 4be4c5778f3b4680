// Errors that name the part of a scene that they are about.
#pragma once

#include <fmt/format.h>

#include <string>

#include "dartcast/error.hpp"

namespace dartcast {

/// Calls make(). Puts kind and name before the message of an Error that it throws.
template <class Make>
auto with_name(const char* kind, const std::string& name, Make&& make) {
  try {
    return make();
  } catch (const Error& e) {
    throw Error(fmt::format("{} \"{}\": {}", kind, name, e.what()));
  }
}

}  // namespace dartcast
