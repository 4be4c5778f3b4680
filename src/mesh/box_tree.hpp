// A tree of axis-aligned boxes, to find those that overlap without looking at all pairs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

struct Box {
  Vec3 low;
  Vec3 high;
};

/// The smallest box around both.
Box join(const Box& a, const Box& b);

/// Whether two closed boxes have a point in common.
bool overlap(const Box& a, const Box& b);

/// Built once over a list of boxes; cost n log n.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// Calls visit(index) for each box that overlaps `query`, until visit returns false.
  template <class Visit>
  void query(const Box& query, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::vector<std::uint32_t> open = {0};
    while (!open.empty()) {
      const Node node = nodes_[open.back()];
      open.pop_back();
      if (!overlap(node.box, query)) continue;
      if (node.child != 0) {
        open.push_back(node.child);
        open.push_back(node.child + 1);
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

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace dartcast
