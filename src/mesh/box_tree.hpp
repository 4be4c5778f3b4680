// A tree of axis-aligned boxes, to find those that overlap without looking at all pairs.
#pragma once

#include <algorithm>
#include <array>
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

/// Built once over a list of boxes; cost n log n. Fewer than 2^32.
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
    std::array<std::uint32_t, 64> open;  // at most one more than the tree's depth: halves of fewer than 2^32
    open[0] = 0;
    for (std::size_t size = 1; size > 0;) {
      const Node& node = nodes_[open[--size]];
      if (!overlap(node.box, query)) continue;
      if (node.child != 0) {
        open[size++] = node.child;
        open[size++] = node.child + 1;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        if (overlap(boxes_[order_[i]], query) && !visit(order_[i])) return;
      }
    }
  }

 private:
  struct Node {
    Box box;
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t child = 0;  // the first of two children; 0: a leaf
  };

  [[nodiscard]] Box box_of(std::uint32_t begin, std::uint32_t end) const;

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace dartcast
