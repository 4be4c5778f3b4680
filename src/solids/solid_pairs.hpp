// The touches of two solids.
#pragma once

#include <span>
#include <vector>

#include "solids/element_touches.hpp"
#include "solids/elements.hpp"
#include "solids/wall_parts.hpp"

namespace dartcast {

/// Memory of the search, for one thread at a time.
class SolidPairFinder {
 public:
  /// All parts that touch on the way. In a touch the elements of `other` are the walls. Cost: n log n, and some 0.2 us for
  /// each pair of parts whose boxes meet.
  std::vector<ElementTouch> find(std::span<const SolidElement> solid, std::span<const SolidElement> other,
                                 const SolidMotion& motion);

 private:
  TouchFinder finder_;
  WallParts parts_;
};

}  // namespace dartcast
