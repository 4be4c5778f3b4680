// The least area by dynamic programming over the pairs of corners. Triangles that turn out to cross something are excluded,
// and the search repeated.
#include "meshing/fill_hole.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "mesh/box_tree.hpp"
#include "surface/unfold.hpp"

namespace dartcast {
namespace {

/// Larger holes are left: the search takes seconds.
constexpr std::size_t most_corners = 300;
/// Searches with more and more triangles excluded.
constexpr unsigned most_searches = 100;
constexpr double impossible = std::numeric_limits<double>::infinity();

class HoleFiller {
 public:
  HoleFiller(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
             std::span<const TriangleCorners> surface)
      : points_(points), corners_(corners), least_(size() * size()), between_(size() * size()) {
    keep_near(surface);
  }

  std::vector<TriangleCorners> fill() {
    for (unsigned search = 0; search < most_searches; ++search) {
      find_least();
      if (least_[size() - 1] == impossible) return {};
      std::vector<Places> found;
      collect(0, size() - 1, found);
      if (!exclude_crossing(found)) {
        std::vector<TriangleCorners> triangles;
        for (const Places& t : found) triangles.push_back(corners_of(t));
        return triangles;
      }
    }
    return {};
  }

 private:
  using Places = std::array<std::size_t, 3>;  // in the border, ascending

  [[nodiscard]] std::size_t size() const { return corners_.size(); }
  [[nodiscard]] TriangleCorners corners_of(const Places& t) const {
    return {corners_[t[0]], corners_[t[1]], corners_[t[2]]};
  }
  [[nodiscard]] double area(const Places& t) const {
    const Vec3& a = points_[corners_[t[0]]];
    return 0.5 * norm(cross(points_[corners_[t[1]]] - a, points_[corners_[t[2]]] - a));
  }

  [[nodiscard]] Box box_of(std::span<const std::uint32_t> corners) const {
    Box box = {points_[corners[0]], points_[corners[0]]};
    for (const std::uint32_t p : corners) box = join(box, {points_[p], points_[p]});
    return box;
  }

  // The part of the surface whose boxes meet that of the border, and all edges between corners of it.
  void keep_near(std::span<const TriangleCorners> surface) {
    const std::set<std::uint32_t> of_border(corners_.begin(), corners_.end());
    const Box border = box_of(corners_);
    for (const TriangleCorners& t : surface) {
      if (!overlap(border, box_of(t))) continue;
      near_.push_back(t);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
        if (of_border.contains(edge.first) && of_border.contains(edge.second)) edges_.insert(edge);
      }
    }
  }

  // An edge inside the hole would have a third face if the surface has it already.
  [[nodiscard]] bool is_edge_possible(std::size_t i, std::size_t k) const {
    const bool on_border = k == i + 1 || (i == 0 && k == size() - 1);
    return on_border || !edges_.contains(std::minmax(corners_[i], corners_[k]));
  }

  void find_least() {
    for (std::size_t i = 0; i + 1 < size(); ++i) least_[i * size() + i + 1] = 0.0;
    for (std::size_t length = 2; length < size(); ++length) {
      for (std::size_t i = 0; i + length < size(); ++i) find_least_between(i, i + length);
    }
  }

  void find_least_between(std::size_t i, std::size_t k) {
    double& least = least_[i * size() + k];
    least = impossible;
    if (!is_edge_possible(i, k)) return;
    for (std::size_t j = i + 1; j < k; ++j) {
      const double parts = least_[i * size() + j] + least_[j * size() + k];
      if (!(parts < least)) continue;
      const double sum = parts + area({i, j, k});
      if (!(sum < least) || excluded_.contains({i, j, k}) || !has_area({i, j, k})) continue;
      least = sum;
      between_[i * size() + k] = j;
    }
  }

  [[nodiscard]] bool has_area(const Places& t) const {
    const TriangleCorners c = corners_of(t);
    return detail::has_area(points_[c[0]], points_[c[1]], points_[c[2]]);
  }

  void collect(std::size_t i, std::size_t k, std::vector<Places>& found) const {
    if (k < i + 2) return;
    const std::size_t j = between_[i * size() + k];
    found.push_back({i, j, k});
    collect(i, j, found);
    collect(j, k, found);
  }

  // If two new triangles cross, the larger one goes.
  bool exclude_crossing(const std::vector<Places>& found) {
    const std::size_t before = excluded_.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
      const TriangleCorners t = corners_of(found[i]);
      if (std::any_of(near_.begin(), near_.end(), [&](const auto& o) { return cross_or_touch(points_, t, o); }))
        excluded_.insert(found[i]);
      for (std::size_t k = 0; k < i; ++k) {
        if (cross_or_touch(points_, t, corners_of(found[k])))
          excluded_.insert(area(found[i]) > area(found[k]) ? found[i] : found[k]);
      }
    }
    return excluded_.size() > before;
  }

  std::span<const Vec3> points_;
  std::span<const std::uint32_t> corners_;
  std::vector<TriangleCorners> near_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;
  std::vector<double> least_;         // area between two places of the border
  std::vector<std::size_t> between_;  // the third place of the triangle at that edge
  std::set<Places> excluded_;
};

}  // namespace

std::vector<TriangleCorners> fill_hole(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                       std::span<const TriangleCorners> surface) {
  if (corners.size() < 3 || corners.size() > most_corners) return {};
  return HoleFiller(points, corners, surface).fill();
}

}  // namespace dartcast
