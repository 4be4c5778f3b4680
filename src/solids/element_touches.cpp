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
Box way_of(const Vec3& from, const Vec3& to) { return join({from, from}, {to, to}); }

Box way_of(const SolidElement& e, const SolidMotion& motion) {
  Box box = way_of(motion.from[e.vertex[0]], motion.to[e.vertex[0]]);
  for (unsigned i = 1; i < e.count; ++i) box = join(box, way_of(motion.from[e.vertex[i]], motion.to[e.vertex[i]]));
  return box;
}

Box way_of(const NearWall& w) {
  Box box = way_of(flushed(w.corners.from[0]), flushed(w.corners.to[0]));
  for (std::size_t k = 1; k < 3; ++k) box = join(box, way_of(flushed(w.corners.from[k]), flushed(w.corners.to[k])));
  return box;
}

Vec3 extent_of(const CellComplex& complex, Cell c, std::span<const Vec3> positions) {
  const auto vertices = complex.map().view(c).vertices();
  Box box = {positions[vertices[0]], positions[vertices[0]]};
  for (const std::uint32_t v : vertices) box = join(box, {positions[v], positions[v]});
  return box.high - box.low;
}

Box around(std::span<const Box> boxes) {
  Box all = boxes.front();
  for (const Box& b : boxes) all = join(all, b);
  return all;
}

// Whether a search of the box around all is likely to reach fewer cells than one for each. `cell`: the extent of a cell. A
// matter of speed alone.
bool share_a_search(std::span<const Box> boxes, const Vec3& cell) {
  const Vec3 rate = {1.0 / cell.x, 1.0 / cell.y, 1.0 / cell.z};
  const auto cells_in = [&](const Box& b) {
    const Vec3 size = b.high - b.low;
    return (1.0 + size.x * rate.x) * (1.0 + size.y * rate.y) * (1.0 + size.z * rate.z);
  };
  double each = 0.0;
  for (const Box& b : boxes) each += cells_in(b);
  return cells_in(around(boxes)) < 0.5 * each;
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
  const Box way = way_of(element, motion);
  chosen_.clear();
  std::copy_if(walls.begin(), walls.end(), std::back_inserter(chosen_),
               [&](const NearWall& w) { return overlap(way_of(w), way); });
  walls_ = chosen_;
  ask_all(element, motion, touches);
}

std::optional<double> TouchFinder::find(const CellComplex& complex, std::span<const Cell> cells,
                                        std::span<const SolidElement> elements, const SolidMotion& motion,
                                        const VertexMotion& walls, std::vector<ElementTouch>& touches) {
  const std::size_t touches_before = touches.size();
  reached_.clear();
  for (std::size_t first = 0; first < elements.size(); first += elements_in_group) {
    const std::size_t count = std::min<std::size_t>(elements_in_group, elements.size() - first);
    find_part(complex, cells.subspan(first, count), elements.subspan(first, count), motion, walls, touches);
  }
  if (!first_flat_of_reached(complex, walls)) return {};
  touches.resize(touches_before);  // perhaps no element reaches the cell that is flat
  reached_.clear();
  find_each(complex, cells, elements, motion, walls, touches);
  return first_flat_of_reached(complex, walls);
}

std::optional<double> TouchFinder::first_flat_of_reached(const CellComplex& complex, const VertexMotion& walls) {
  std::sort(reached_.begin(), reached_.end());
  reached_.erase(std::unique(reached_.begin(), reached_.end()), reached_.end());
  return first_flat_time(complex, reached_, walls);
}

// By one search, if that is quicker than one for each; else both halves.
void TouchFinder::find_part(const CellComplex& complex, std::span<const Cell> cells,
                            std::span<const SolidElement> elements, const SolidMotion& motion,
                            const VertexMotion& walls, std::vector<ElementTouch>& touches) {
  constexpr std::size_t too_small = 4;
  if (elements.size() <= too_small) return find_each(complex, cells, elements, motion, walls, touches);
  boxes_.clear();
  for (const SolidElement& e : elements) boxes_.push_back(way_of(e, motion));
  if (share_a_search(boxes_, extent_of(complex, cells.front(), walls.after)))
    return find_together(complex, cells, elements, motion, walls, touches);
  const std::size_t half = elements.size() / 2;
  find_part(complex, cells.first(half), elements.first(half), motion, walls, touches);
  find_part(complex, cells.subspan(half), elements.subspan(half), motion, walls, touches);
}

// `boxes_` has those of the elements.
void TouchFinder::find_together(const CellComplex& complex, std::span<const Cell> cells,
                                std::span<const SolidElement> elements, const SolidMotion& motion,
                                const VertexMotion& walls, std::vector<ElementTouch>& touches) {
  const auto near = near_.search(complex, cells, around(boxes_), walls);
  reached_.insert(reached_.end(), near_.cells_reached().begin(), near_.cells_reached().end());
  wall_boxes_.clear();
  for (const NearWall& w : near) wall_boxes_.push_back(way_of(w));
  for (std::size_t i = 0; i < elements.size() && !near.empty(); ++i) {
    chosen_.clear();
    for (std::size_t w = 0; w < near.size(); ++w) {
      if (overlap(wall_boxes_[w], boxes_[i])) chosen_.push_back(near[w]);
    }
    walls_ = chosen_;
    ask_all(elements[i], motion, touches);
  }
}

void TouchFinder::find_each(const CellComplex& complex, std::span<const Cell> cells,
                            std::span<const SolidElement> elements, const SolidMotion& motion,
                            const VertexMotion& walls, std::vector<ElementTouch>& touches) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    find_touches(complex, cells[i], elements[i], motion, walls, touches);
    reached_.insert(reached_.end(), cells_reached().begin(), cells_reached().end());
  }
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
