// Each segment keeps the walls near the last way that was looked up. A way that stays within the margin of it meets no
// other: the proof of NearWalls holds for all places as near as its margin.
#include "catheter/chain_surroundings.hpp"

#include <algorithm>
#include <iterator>

#include "dynamics/flat_cells.hpp"

namespace dartcast {

void ChainSurroundings::clear() {
  for (Known& k : known_) k.is_set = false;
  positive_.clear();
}

bool ChainSurroundings::covers(std::size_t segment, const SolidMotion& motion) const {
  const Known& known = known_[segment];
  const double limit = margin_ * (1.0 - 0x1p-20);
  return known.is_set && motion.from[segment] == known.from[0] && motion.from[segment + 1] == known.from[1] &&
         norm(motion.to[segment] - known.to[0]) <= limit && norm(motion.to[segment + 1] - known.to[1]) <= limit;
}

void ChainSurroundings::look_up(const CellComplex& complex, Cell cell, std::size_t segment, const SolidMotion& motion) {
  Known& known = known_[segment];
  MovingElement element;
  element.count = 2;
  for (std::size_t k = 0; k < 2; ++k) {
    element.from[k] = known.from[k] = motion.from[segment + k];
    element.to[k] = known.to[k] = motion.to[segment + k];
  }
  known.walls.set(near_.search(complex, cell, element, {complex.positions(), complex.positions()}, margin_));
  known.is_set = true;
  reached_.insert(reached_.end(), near_.cells_reached().begin(), near_.cells_reached().end());
}

// Whether all cells reached are. Segments share most of them.
bool ChainSurroundings::all_positive(const CellComplex& complex) {
  std::sort(reached_.begin(), reached_.end());
  reached_.erase(std::unique(reached_.begin(), reached_.end()), reached_.end());
  merged_.clear();
  std::set_difference(reached_.begin(), reached_.end(), positive_.begin(), positive_.end(),
                      std::back_inserter(merged_));
  reached_.swap(merged_);
  if (first_flat_time(complex, reached_, {complex.positions(), complex.positions()})) return false;
  merged_.clear();
  std::merge(reached_.begin(), reached_.end(), positive_.begin(), positive_.end(), std::back_inserter(merged_));
  positive_.swap(merged_);
  return true;
}

bool ChainSurroundings::find(const CellComplex& complex, const Particles& particles, std::size_t segments,
                             const SolidMotion& motion, std::vector<ElementTouch>& touches) {
  if (known_.size() < segments) known_.resize(segments);
  reached_.clear();
  const auto rests = [&](std::size_t i) {
    return motion.from[i] == motion.to[i] && motion.from[i + 1] == motion.to[i + 1];
  };
  for (std::size_t i = 0; i < segments; ++i) {
    if (!rests(i) && !covers(i, motion)) look_up(complex, particles[i].cell, i, motion);
  }
  if (!all_positive(complex)) {
    clear();
    return false;
  }
  for (std::size_t i = 0; i < segments; ++i) {
    if (!rests(i)) finder_.find_among(known_[i].walls, chain_segment(static_cast<std::uint32_t>(i)), motion, touches);
  }
  return true;
}

}  // namespace dartcast
