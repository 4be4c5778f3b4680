// Builds the tree of boxes: each node has four parts of its boxes, by medians along their longest sides. Parts are full: only
// the last one of a node may lack boxes.
#include "mesh/box_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace dartcast {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  if (boxes_.empty()) return;
  std::vector<std::uint32_t> order(boxes_.size());
  std::iota(order.begin(), order.end(), 0U);
  add_node(order.data(), order.data() + order.size());
  fit();
}

void BoxTree::refit(std::vector<Box> boxes) {
  boxes_ = std::move(boxes);
  fit();
}

// Those before the middle have the least centres.
void BoxTree::divide(std::uint32_t* begin, std::uint32_t* end, std::uint32_t* middle) const {
  Box all = boxes_[*begin];
  for (const std::uint32_t i : std::span(begin, end)) all = join(all, boxes_[i]);
  const Vec3 size = all.high - all.low;
  double Vec3::*axis =
      size.x >= size.y ? (size.x >= size.z ? &Vec3::x : &Vec3::z) : (size.y >= size.z ? &Vec3::y : &Vec3::z);
  std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
    const double x = boxes_[a].low.*axis + boxes_[a].high.*axis;
    const double y = boxes_[b].low.*axis + boxes_[b].high.*axis;
    return x != y ? x < y : a < b;
  });
}

// Children come behind their parents.
std::uint32_t BoxTree::add_node(std::uint32_t* begin, std::uint32_t* end) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const std::ptrdiff_t count = end - begin;
  std::ptrdiff_t part = 1;
  while (4 * part < count) part *= 4;
  if (count > 2 * part) divide(begin, end, begin + 2 * part);
  std::array<std::uint32_t, 4> child{};
  for (std::size_t k = 0; begin != end; ++k) {
    const std::ptrdiff_t left = std::min(end - begin, (k % 2 == 0 ? 2 : 1) * part);  // of this half
    if (left > part) divide(begin, begin + left, begin + part);
    std::uint32_t* const next = begin + std::min(part, left);
    child[k] = next - begin == 1 ? *begin | is_box : add_node(begin, next);
    begin = next;
  }
  nodes_[number].child = child;
  return number;
}

// A missing child's bounds are no numbers, which no comparison meets: floats of far coordinates are infinite.
void BoxTree::fit() {
  constexpr float far = std::numeric_limits<float>::infinity();
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const auto least = [](const Lanes& v) { return std::min({far, v[0], v[1], v[2], v[3]}); };
  const auto most = [](const Lanes& v) { return std::max({-far, v[0], v[1], v[2], v[3]}); };
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t c = node.child[k];
      std::array<float, 6> box = {none, none, none, none, none, none};
      if ((c & is_box) != 0) {
        const Box& b = boxes_[c & ~is_box];
        const std::array<double, 6> from = {b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z};
        for (std::size_t i = 0; i < 6; ++i) box[i] = static_cast<float>(from[i]);
      } else if (c != 0) {
        const Node& child = nodes_[c];
        box = {least(child.low.x), least(child.low.y), least(child.low.z),
               most(child.high.x), most(child.high.y), most(child.high.z)};
      }
      node.low.x[k] = box[0];
      node.low.y[k] = box[1];
      node.low.z[k] = box[2];
      node.high.x[k] = box[3];
      node.high.y[k] = box[4];
      node.high.z[k] = box[5];
    }
  }
}

}  // namespace dartcast
