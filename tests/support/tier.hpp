// The size of tests: quick, full (DARTCAST_FULL is set), and a twentieth of either, at least one case, under sanitizers
// (DARTCAST_SANITIZED).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <vector>

namespace dartcast::test {

inline bool full_tier() { return std::getenv("DARTCAST_FULL") != nullptr; }
inline bool sanitized() { return std::getenv("DARTCAST_SANITIZED") != nullptr; }

/// How many cases to take.
template <class Count>
Count scaled(Count quick, Count full) {
  const Count count = full_tier() ? full : quick;
  return sanitized() && count > 0 ? std::max(Count{1}, static_cast<Count>(count / 20)) : count;
}

/// The distance between the cases of a list that are taken: all in the full tier, fewer in the quick one and under
/// sanitizers.
inline std::size_t stride(std::size_t quick, std::size_t under_sanitizers) {
  return full_tier() ? 1 : sanitized() ? under_sanitizers : quick;
}

/// The cases of a list; under sanitizers the first alone.
template <class Case>
std::vector<Case> all_or_first(std::initializer_list<Case> cases) {
  return {cases.begin(), sanitized() ? cases.begin() + 1 : cases.end()};
}

/// Whether a mesh of so many points only repeats smaller ones at a larger size. Under sanitizers such meshes are left
/// to the full tier.
inline bool repeats_smaller_ones(std::size_t points) { return sanitized() && !full_tier() && points > 1000; }

}  // namespace dartcast::test
