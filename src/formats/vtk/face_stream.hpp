// VTK's way to write a polyhedron: its number of faces, then for each face its number of corners and the corners.
#pragma once

#include <cstdint>
#include <span>

namespace dartcast {

/// Whether the numbers are exactly one polyhedron.
inline bool is_face_stream(std::span<const std::int64_t> numbers) {
  if (numbers.empty() || numbers[0] < 0) return false;
  std::size_t at = 1;
  for (std::int64_t f = 0; f < numbers[0]; ++f) {
    if (at >= numbers.size()) return false;
    const std::int64_t n = numbers[at++];
    if (n < 0 || n > static_cast<std::int64_t>(numbers.size() - at)) return false;
    at += static_cast<std::size_t>(n);
  }
  return at == numbers.size();
}

}  // namespace dartcast
