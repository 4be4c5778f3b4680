// Builds the tree of boxes: each node divides its boxes by the median along its longest side.
#include "mesh/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace dartcast {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  constexpr std::uint32_t leaf_size = 4;
  if (boxes_.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(order_.size())});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    Node node = nodes_[n];
    node.box = box_of(node.begin, node.end);
    if (node.end - node.begin > leaf_size) {
      const Vec3 size = node.box.high - node.box.low;
      double Vec3::*axis =
          size.x >= size.y ? (size.x >= size.z ? &Vec3::x : &Vec3::z) : (size.y >= size.z ? &Vec3::y : &Vec3::z);
      const std::uint32_t middle = node.begin + (node.end - node.begin) / 2;
      std::nth_element(order_.begin() + node.begin, order_.begin() + middle, order_.begin() + node.end,
                       [&](std::uint32_t a, std::uint32_t b) {
                         const double x = boxes_[a].low.*axis + boxes_[a].high.*axis;
                         const double y = boxes_[b].low.*axis + boxes_[b].high.*axis;
                         return x != y ? x < y : a < b;
                       });
      node.child = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({{}, node.begin, middle});
      nodes_.push_back({{}, middle, node.end});
    }
    nodes_[n] = node;
  }
}

Box BoxTree::box_of(std::uint32_t begin, std::uint32_t end) const {
  Box box = boxes_[order_[begin]];
  for (std::uint32_t i = begin + 1; i < end; ++i) box = join(box, boxes_[order_[i]]);
  return box;
}

// Children come behind their parents.
void BoxTree::refit(std::vector<Box> boxes) {
  boxes_ = std::move(boxes);
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    node.box =
        node.child == 0 ? box_of(node.begin, node.end) : join(nodes_[node.child].box, nodes_[node.child + 1].box);
  }
}

}  // namespace dartcast
