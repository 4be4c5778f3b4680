// Finds boxes that overlap a box. Comparisons and monotone rounding only, so nothing is missed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast::oracle {

struct Box {
  Vec3 low;
  Vec3 high;

  static Box around(std::initializer_list<Vec3> points) {
    Box b{*points.begin(), *points.begin()};
    for (const Vec3& p : points) {
      b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
      b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
    }
    return b;
  }

  [[nodiscard]] bool overlaps(const Box& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y && low.z <= b.high.z &&
           b.low.z <= high.z;
  }
};

/// A uniform grid over some boxes.
class BoxGrid {
 public:
  BoxGrid() = default;
  explicit BoxGrid(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
    if (boxes_.empty()) return;
    Box all = boxes_[0];
    for (const Box& b : boxes_) all = Box::around({all.low, all.high, b.low, b.high});
    low_ = {all.low.x, all.low.y, all.low.z};
    const std::array<double, 3> high = {all.high.x, all.high.y, all.high.z};
    for (std::size_t a = 0; a < 3; ++a) per_length_[a] = high[a] > low_[a] ? side / (high[a] - low_[a]) : 0.0;
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
      each_place(boxes_[i], [&](const Place& at) { places_[number(at)].push_back(i); });
    }
  }

  /// Calls visit(index) once for each box that overlaps b.
  template <class Visit>
  void each_overlapping(const Box& b, Visit&& visit) const {
    if (boxes_.empty()) return;
    // Two ranges of places that overlap do so from one lowest place on: there, and only there, the box is visited.
    each_place(b, [&](const Place& at) {
      for (const std::uint32_t i : places_[number(at)]) {
        if (lowest_common(boxes_[i], b) == at && boxes_[i].overlaps(b)) visit(i);
      }
    });
  }

 private:
  static constexpr int side = 12;
  using Place = std::array<int, 3>;

  static std::size_t number(const Place& at) { return static_cast<std::size_t>(at[0] + side * (at[1] + side * at[2])); }

  [[nodiscard]] Place place_of(const Vec3& x) const { return {place(x.x, 0), place(x.y, 1), place(x.z, 2)}; }

  [[nodiscard]] Place lowest_common(const Box& a, const Box& b) const {
    const Place p = place_of(a.low);
    const Place q = place_of(b.low);
    return {std::max(p[0], q[0]), std::max(p[1], q[1]), std::max(p[2], q[2])};
  }

  // Never falls as x grows: boxes that overlap share a place.
  [[nodiscard]] int place(double x, std::size_t axis) const {
    const double scaled = (x - low_[axis]) * per_length_[axis];
    return static_cast<int>(std::clamp(scaled, 0.0, side - 1.0));
  }

  template <class Visit>
  void each_place(const Box& b, Visit&& visit) const {
    const Place from = place_of(b.low);
    const Place to = place_of(b.high);
    for (int k = from[2]; k <= to[2]; ++k) {
      for (int j = from[1]; j <= to[1]; ++j) {
        for (int i = from[0]; i <= to[0]; ++i) visit(Place{i, j, k});
      }
    }
  }

  std::vector<Box> boxes_;
  std::array<double, 3> low_ = {};
  std::array<double, 3> per_length_ = {};
  std::array<std::vector<std::uint32_t>, std::size_t{side} * side * side> places_;
};

}  // namespace dartcast::oracle
