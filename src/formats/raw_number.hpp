// A number from its bytes in a file, of either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

namespace dartcast {

/// Precondition: as many bytes as T has.
template <class T>
T raw_number(std::string_view bytes, std::endian order) {
  std::array<char, sizeof(T)> own{};
  std::copy_n(bytes.begin(), sizeof(T), own.begin());
  if (order != std::endian::native) std::reverse(own.begin(), own.end());
  return std::bit_cast<T>(own);
}

}  // namespace dartcast
