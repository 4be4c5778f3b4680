// How much a test does: quick, full (DARTCAST_FULL is set), and a twentieth of either under sanitizers
// (DARTCAST_SANITIZED).
#pragma once

#include <cstdlib>

namespace dartcast::test {

inline bool full_tier() { return std::getenv("DARTCAST_FULL") != nullptr; }
inline bool sanitized() { return std::getenv("DARTCAST_SANITIZED") != nullptr; }

/// How many cases to take.
template <class Count>
Count scaled(Count quick, Count full) {
  const Count count = full_tier() ? full : quick;
  return sanitized() ? count / 20 : count;
}

}  // namespace dartcast::test
