// Numbers for people. Not installed.
#pragma once

#include <cstdint>
#include <string>

namespace dartcast {

/// 1,234,567.
inline std::string grouped(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

}  // namespace dartcast
