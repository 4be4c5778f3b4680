// Lists the walls, and makes their boxes.
#include "dynamics/moving_walls.hpp"

#include <limits>
#include <utility>

#include "base/parallel.hpp"

namespace dartcast {

void MovingWalls::list(const CellComplex& complex) {
  faces_.clear();
  tree_.reset();
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (cell.is_wall(f)) faces_.push_back({c, f});
    }
  }
}

// Comparisons leave out coordinates that are no numbers.
Box MovingWalls::box_of(const CellComplex& complex, CellFace face) {
  constexpr double far = std::numeric_limits<double>::infinity();
  const CellView cell = complex.map().view(face.cell);
  const Vec3* before = complex.previous_positions().data();
  const Vec3* after = complex.positions().data();
  Box box = {{far, far, far}, {-far, -far, -far}};
  const Shape& shape = cell.shape();
  for (std::uint16_t t = 0; t < shape.triangle_count(face.face); ++t) {
    for (const std::uint16_t p : shape.triangle(face.face, t)) {
      const std::uint32_t v = cell.vertex(p).value;
      box = join(box, {before[v], before[v]});
      box = join(box, {after[v], after[v]});
    }
  }
  return box;
}

void MovingWalls::update(const CellComplex& complex, const Version& version, Threads threads) {
  constexpr std::size_t grain = 1024;
  if (version_ != version) list(complex);
  version_ = version;
  std::vector<Box> boxes = tree_ ? tree_->take_boxes() : std::vector<Box>(faces_.size());
  parallel_for(faces_.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) boxes[i] = box_of(complex, faces_[i]);
  });
  if (tree_)
    tree_->refit(std::move(boxes));
  else
    tree_.emplace(std::move(boxes));
}

}  // namespace dartcast
