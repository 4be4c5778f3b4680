// A tree of axis-aligned boxes, to find those that overlap without looking at all pairs.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

struct Box {
  Vec3 low;
  Vec3 high;
};

/// The smallest box around both.
inline Box join(const Box& a, const Box& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

/// Whether two closed boxes have a point in common.
inline bool overlap(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

/// Built once over a list of boxes; cost n log n. Fewer than 2^31.
///
/// A query compares four boxes at a time, in floats. Rounding to floats keeps the order, so boxes that overlap still do. Those
/// of the list are then compared as they are. Beyond the range of floats, 1e-38 to 1e38, a query looks at most boxes.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// As many boxes in place of those, which have moved; cost n. Queries take longer the more they have moved.
  void refit(std::vector<Box> boxes);
  /// Gives the boxes back, for refit().
  [[nodiscard]] std::vector<Box> take_boxes() { return std::move(boxes_); }

  /// Calls visit(index) for each box that overlaps `query`, until visit returns false.
  template <class Visit>
  void query(const Box& query, Visit&& visit) const {
    if (nodes_.empty()) return;
    const Lanes3 low = splat(query.low);
    const Lanes3 high = splat(query.high);
    std::array<std::uint32_t, 64> open;  // at most three a level, and one: quarters of fewer than 2^31
    open[0] = 0;
    for (std::size_t size = 1; size > 0;) {
      const Node& node = nodes_[open[--size]];
      unsigned met = lanes_set((node.low.x <= high.x) & (low.x <= node.high.x) & (node.low.y <= high.y) &
                               (low.y <= node.high.y) & (node.low.z <= high.z) & (low.z <= node.high.z));
      for (; met != 0; met &= met - 1) {
        const std::uint32_t child = node.child[std::countr_zero(met)];
        if ((child & is_box) == 0)
          open[size++] = child;
        else if (overlap(boxes_[child & ~is_box], query) && !visit(child & ~is_box))
          return;
      }
    }
  }

 private:
  using Lanes = float __attribute__((vector_size(16)));
  using Mask = int __attribute__((vector_size(16)));
  struct Lanes3 {
    Lanes x, y, z;
  };
  struct Node {
    Lanes3 low, high;  // of four children; of a missing one no numbers
    std::array<std::uint32_t, 4> child;
  };
  static constexpr std::uint32_t is_box = 1U << 31U;  // a child that is no node, but one of the boxes

  static Lanes splat(double x) {
    const auto f = static_cast<float>(x);
    return Lanes{f, f, f, f};
  }
  static Lanes3 splat(const Vec3& v) { return {splat(v.x), splat(v.y), splat(v.z)}; }
  static unsigned lanes_set(const Mask& m) {
#if defined(__SSE__)
    return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Lanes>(m)));
#else
    return static_cast<unsigned>((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8));
#endif
  }

  void divide(std::uint32_t* begin, std::uint32_t* end, std::uint32_t* middle) const;
  std::uint32_t add_node(std::uint32_t* begin, std::uint32_t* end);
  void fit();

  std::vector<Box> boxes_;
  std::vector<Node> nodes_;
};

}  // namespace dartcast
