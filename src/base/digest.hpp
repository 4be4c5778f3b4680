// A number for the bytes of files and arrays, to find damage and changes. It does not find forgery.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace dartcast {

/// Mixes in 8 bytes at a time. `start`: the digest of what comes before.
inline std::uint64_t digest(std::string_view bytes, std::uint64_t start = 0) {
  std::uint64_t h = start ^ (bytes.size() * 0x9e3779b97f4a7c15U);
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    h = (h ^ word) * 0xbf58476d1ce4e5b9U;
    h ^= h >> 29U;
  }
  return h;
}

}  // namespace dartcast
