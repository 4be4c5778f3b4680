// The pairs of an element and the walls near it. In order: the walls that it may touch (NearWalls), its corners against
// them, its sides against their edges, its face against their vertices, each pair once; then the cells on which this list
// of walls rests.
#include "solids/element_touches.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "complex/positive_cells.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/validity.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

namespace {

using detail::MovingPair;
using detail::PairKind;

MovingElement moving(const SolidElement& e, const SolidMotion& motion) {
  MovingElement m;
  m.count = e.count;
  for (unsigned i = 0; i < e.count; ++i) {
    m.from[i] = motion.from[e.vertex[i]];
    m.to[i] = motion.to[e.vertex[i]];
  }
  return m;
}

// Whether a cell has a simplex that is not positive.
bool is_flat(const CellComplex& complex, Cell c, std::span<const Vec3> positions) {
  const CellView cell = complex.map().view(c);
  const std::uint32_t* v = cell.vertices().data();
  return detail::not_proved_positive(cell.shape(), {v, v, v, v}, positions.data()) != 0 &&
         check_cell(complex.map(), positions, c).has_value();
}

// The box of a point's way.
Box around(std::span<const Vec3> from, std::span<const Vec3> to, std::size_t i) {
  const Vec3 a = flushed(from[i]);
  const Vec3 b = flushed(to[i]);
  return join({a, a}, {b, b});
}

}  // namespace

std::optional<double> first_flat_time(const CellComplex& complex, std::span<const Cell> cells,
                                      const VertexMotion& walls) {
  std::optional<double> first;
  for (const Cell c : cells) {
    if (walls.at_rest()) {
      if (is_flat(complex, c, walls.after)) return 0.0;
      continue;
    }
    const auto flat = first_inversion(complex.map(), walls.before, walls.after, c, first.value_or(1.0));
    if (flat) first = flat->how.safe_time;
  }
  return first;
}

std::optional<double> TouchFinder::find(const CellComplex& complex, Cell cell, const SolidElement& element,
                                        const SolidMotion& motion, const VertexMotion& walls,
                                        std::vector<ElementTouch>& touches) {
  find_touches(complex, cell, element, motion, walls, touches);
  return first_flat_time(complex, cells_reached(), walls);
}

void TouchFinder::find_touches(const CellComplex& complex, Cell cell, const SolidElement& element,
                               const SolidMotion& motion, const VertexMotion& walls,
                               std::vector<ElementTouch>& touches) {
  walls_ = near_.search(complex, cell, moving(element, motion), walls);
  ask_all(element, motion, touches);
}

void TouchFinder::find_among(std::span<const NearWall> walls, const SolidElement& element, const SolidMotion& motion,
                             std::vector<ElementTouch>& touches) {
  Box way = {motion.from[element.vertex[0]], motion.from[element.vertex[0]]};
  for (unsigned i = 0; i < element.count; ++i) way = join(way, around(motion.from, motion.to, element.vertex[i]));
  chosen_.clear();
  std::copy_if(walls.begin(), walls.end(), std::back_inserter(chosen_), [&](const NearWall& w) {
    Box swept = around(w.corners.from, w.corners.to, 0);
    for (std::size_t k = 1; k < 3; ++k) swept = join(swept, around(w.corners.from, w.corners.to, k));
    return overlap(swept, way);
  });
  walls_ = chosen_;
  ask_all(element, motion, touches);
}

void TouchFinder::ask_all(const SolidElement& e, const SolidMotion& motion, std::vector<ElementTouch>& touches) {
  if (walls_.empty()) return;
  ask_corners(e, motion, touches);
  ask_sides(e, motion, touches);
  if (e.count == 3) ask_face(e, motion, touches);
}

// Whether the pair touches.
bool TouchFinder::ask(PairKind kind, const MovingPair& pair, const ElementTouch& touch,
                      std::vector<ElementTouch>& touches) {
  ++pairs_;
  const auto time = detail::first_touch(pair, kind);
  if (time) touches.emplace_back(touch).time = *time;
  return time.has_value();
}

void TouchFinder::ask_corners(const SolidElement& e, const SolidMotion& motion, std::vector<ElementTouch>& touches) {
  for (unsigned i = 0; i < e.count; ++i) {
    if (((e.own_corners >> i) & 1U) == 0) continue;
    const std::uint32_t v = e.vertex[i];
    for (const NearWall& w : walls_) {
      MovingPair pair = {{motion.from[v]}, {motion.to[v]}};
      for (unsigned k = 0; k < 3; ++k) {
        pair.from[k + 1] = flushed(w.corners.from[k]);
        pair.to[k + 1] = flushed(w.corners.to[k]);
      }
      ask(PairKind::vertex_face, pair, {0.0, SolidContactKind::vertex_face, 1, 3, {v}, {0, 1, 2}, w}, touches);
    }
  }
}

// Lists the edges (size 2) or vertices (1) of the walls. A part that several walls share counts as the first one's.
void TouchFinder::list_parts(unsigned size) {
  parts_.clear();
  for (std::uint32_t w = 0; w < walls_.size(); ++w) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t one = walls_[w].vertex[k].value;
      const std::uint32_t other = walls_[w].vertex[(k + size - 1) % 3].value;
      parts_.push_back({std::min(one, other), std::max(one, other), w, k, w});
    }
  }
  const auto key = [](const WallPart& p) { return std::tie(p.low, p.high, p.wall, p.corner); };
  std::sort(parts_.begin(), parts_.end(), [&](const WallPart& a, const WallPart& b) { return key(a) < key(b); });
  const auto same = [](const WallPart& a, const WallPart& b) { return a.low == b.low && a.high == b.high; };
  for (std::size_t i = 0; i + 1 < parts_.size(); ++i) {
    if (same(parts_[i], parts_[i + 1])) parts_[i].beside = parts_[i + 1].wall;
  }
  parts_.erase(std::unique(parts_.begin(), parts_.end(), same), parts_.end());
}

void TouchFinder::ask_sides(const SolidElement& e, const SolidMotion& motion, std::vector<ElementTouch>& touches) {
  if (e.own_sides == 0) return;
  list_parts(2);
  for (unsigned i = 0; i < side_count(e); ++i) {
    if (((e.own_sides >> i) & 1U) == 0) continue;
    const std::uint32_t a = e.vertex[i];
    const std::uint32_t b = e.vertex[(i + 1) % e.count];
    for (const WallPart& p : parts_) {
      const NearWall& w = walls_[p.wall];
      const auto k = p.corner;
      const auto l = static_cast<std::uint8_t>((k + 1) % 3);
      const MovingPair pair = {{motion.from[a], motion.from[b], flushed(w.corners.from[k]), flushed(w.corners.from[l])},
                               {motion.to[a], motion.to[b], flushed(w.corners.to[k]), flushed(w.corners.to[l])}};
      if (!ask(PairKind::edge_edge, pair, {0.0, SolidContactKind::edge_edge, 2, 2, {a, b}, {k, l}, w}, touches))
        continue;
      if (p.beside != p.wall) touches.back().beside = walls_[p.beside].corners;
    }
  }
}

void TouchFinder::ask_face(const SolidElement& e, const SolidMotion& motion, std::vector<ElementTouch>& touches) {
  list_parts(1);
  for (const WallPart& p : parts_) {
    const NearWall& w = walls_[p.wall];
    MovingPair pair = {{flushed(w.corners.from[p.corner])}, {flushed(w.corners.to[p.corner])}};
    for (unsigned i = 0; i < 3; ++i) {
      pair.from[i + 1] = motion.from[e.vertex[i]];
      pair.to[i + 1] = motion.to[e.vertex[i]];
    }
    ask(PairKind::vertex_face, pair, {0.0, SolidContactKind::face_vertex, 3, 1, e.vertex, {p.corner}, w}, touches);
  }
}

}  // namespace dartcast
