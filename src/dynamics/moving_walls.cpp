// Lists the walls, and makes their boxes.
#include "dynamics/moving_walls.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"

namespace dartcast {

namespace {

// Comparisons leave out coordinates that are no numbers.
Box box_of(std::span<const std::uint32_t> points, const Vec3* before, const Vec3* after) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Box box = {{far, far, far}, {-far, -far, -far}};
  for (const std::uint32_t v : points) {
    box = join(box, {before[v], before[v]});
    box = join(box, {after[v], after[v]});
  }
  return box;
}

}  // namespace

void MovingWalls::list(const CellComplex& complex, const Version& version) {
  if (version_ == version) return;
  version_ = version;
  first_.assign(1, {});
  triangles_.clear();
  points_.clear();
  tree_.reset();
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < cell.shape().triangle_count(f); ++t) {
        const auto local = cell.shape().triangle(f, t);
        WallCorners& corners = triangles_.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
          corners[i] = cell.vertex(local[i]).value;
          const auto own = points_.begin() + first_.back().point;
          if (std::find(own, points_.end(), corners[i]) == points_.end()) points_.push_back(corners[i]);
        }
      }
      first_.push_back({static_cast<std::uint32_t>(triangles_.size()), static_cast<std::uint32_t>(points_.size())});
    }
  }
}

void MovingWalls::update(const CellComplex& complex, Threads threads) {
  constexpr std::size_t grain = 1024;
  std::vector<Box> boxes = tree_ ? tree_->take_boxes() : std::vector<Box>(size());
  const Vec3* before = complex.previous_positions().data();
  const Vec3* after = complex.positions().data();
  parallel_for(boxes.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      boxes[i] =
          box_of(std::span(points_).subspan(first_[i].point, first_[i + 1].point - first_[i].point), before, after);
  });
  if (tree_)
    tree_->refit(std::move(boxes));
  else
    tree_.emplace(std::move(boxes));
}

void MovingWalls::find_near(const Vec3& from, const Vec3& to, std::uint32_t way, std::vector<WayAndWall>& pairs) const {
  Box box = join({from, from}, {to, to});
  const Vec3 largest = extent_of(box.low, box.high);
  const double margin = 0x1p-50 * std::max({largest.x, largest.y, largest.z});  // more than rounding
  box.low = box.low - Vec3{margin, margin, margin};
  box.high = box.high + Vec3{margin, margin, margin};
  tree_->query(box, [&](std::uint32_t i) {
    for (std::uint32_t t = first_[i].triangle; t < first_[i + 1].triangle; ++t) pairs.push_back({way, triangles_[t]});
    return true;
  });
}

namespace detail {

std::size_t keep_undecided(std::span<WayAndWall> pairs, const ParticleState* states, const Vec3* targets,
                           const Vec3* before, const Vec3* after, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::undecided_pairs(pairs, states, targets, before, after);
#endif
  return portable::undecided_pairs(pairs, states, targets, before, after);
}

}  // namespace detail

}  // namespace dartcast
