// The pairs of an element and the walls near it. In order: the walls that it may touch (NearWalls), its corners against
// them, its sides against their edges, its face against their vertices, each pair once; then the cells on which this list
// of walls rests.
#include "solids/element_touches.hpp"

#include <algorithm>

#include "dynamics/flat_cells.hpp"
#include "solids/near_pair.hpp"

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

void TouchFinder::find_touches(const CellComplex& complex, Cell cell, const SolidElement& element,
                               const SolidMotion& motion, const VertexMotion& walls,
                               std::vector<ElementTouch>& touches) {
  parts_.set(near_.search(complex, cell, moving(element, motion), walls, motion.margin));
  find_among(parts_, element, motion, touches);
}

void TouchFinder::find_among(WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                             std::vector<ElementTouch>& touches) {
  if (walls.walls().empty()) return;
  ask_corners(walls, e, motion, touches);
  ask_sides(walls, e, motion, touches);
  if (e.count == 3) ask_face(walls, e, motion, touches);
}

std::optional<double> TouchFinder::find(const CellComplex& complex, const ElementGroup& group,
                                        const SolidMotion& motion, const VertexMotion& walls,
                                        std::vector<ElementTouch>& touches) {
  const Search search = {complex, group, motion, walls, touches};
  const std::size_t touches_before = touches.size();
  const std::size_t size = group.elements.size();
  reached_.clear();
  boxes_.clear();
  for (const SolidElement& e : group.elements) boxes_.push_back(way_of(e, motion));
  if (motion.margin > 0.0) widen_boxes(motion.margin);
  for (std::size_t first = 0; first < size; first += elements_in_group)
    find_part(search, first, std::min<std::size_t>(first + elements_in_group, size));
  if (!first_flat_of_reached(complex, walls)) return {};
  touches.resize(touches_before);  // perhaps no element reaches the cell that is flat
  reached_.clear();
  find_each(search, 0, size);
  return first_flat_of_reached(complex, walls);
}

void TouchFinder::widen_boxes(double margin) {
  for (Box& b : boxes_) b = widened(b, margin);
}

std::optional<double> TouchFinder::first_flat_of_reached(const CellComplex& complex, const VertexMotion& walls) {
  std::sort(reached_.begin(), reached_.end());
  reached_.erase(std::unique(reached_.begin(), reached_.end()), reached_.end());
  return first_flat_time(complex, reached_, walls);
}

// By one search, if that is quicker than one for each; else both halves.
void TouchFinder::find_part(const Search& search, std::size_t begin, std::size_t end) {
  constexpr std::size_t too_small = 4;
  if (end - begin <= too_small) return find_each(search, begin, end);
  const auto boxes = std::span<const Box>(boxes_).subspan(begin, end - begin);
  if (share_a_search(boxes, extent_of(search.complex, search.group.cells[begin], search.walls.after)))
    return find_together(search, begin, end);
  const std::size_t middle = begin + (end - begin) / 2;
  find_part(search, begin, middle);
  find_part(search, middle, end);
}

void TouchFinder::find_together(const Search& search, std::size_t begin, std::size_t end) {
  const auto cells = search.group.cells.subspan(begin, end - begin);
  const auto boxes = std::span<const Box>(boxes_).subspan(begin, end - begin);
  parts_.set(near_.search(search.complex, cells, around(boxes), search.walls));
  reached_.insert(reached_.end(), near_.cells_reached().begin(), near_.cells_reached().end());
  if (parts_.walls().empty()) return;
  const Box walls = around(parts_.ways());
  for (std::size_t i = begin; i < end; ++i) {
    if (overlap(boxes_[i], walls)) ask_all(search, i);
  }
}

void TouchFinder::find_each(const Search& search, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    parts_.set(near_.search(search.complex, search.group.cells[i], moving(search.group.elements[i], search.motion),
                            search.walls, search.motion.margin));
    ask_all(search, i);
    reached_.insert(reached_.end(), cells_reached().begin(), cells_reached().end());
  }
}

void TouchFinder::ask_all(const Search& search, std::size_t element) {
  const std::size_t touches_before = search.touches.size();
  find_among(parts_, search.group.elements[element], search.motion, search.touches);
  for (std::size_t i = touches_before; i < search.touches.size(); ++i)
    search.touches[i].element = static_cast<std::uint32_t>(element);
}

// Whether the pair touches.
bool TouchFinder::ask(PairKind kind, const MovingPair& pair, const SolidMotion& motion, const ElementTouch& touch,
                      std::vector<ElementTouch>& touches) {
  ++pairs_;
  if (motion.margin > 0.0) return ask_near(kind, pair, motion, touch, touches);
  const auto time = detail::first_touch(pair, kind);
  if (time) touches.emplace_back(touch).time = *time;
  return time.has_value();
}

// Whether the pair comes as near as the margin.
bool TouchFinder::ask_near(PairKind kind, const MovingPair& pair, const SolidMotion& motion, const ElementTouch& touch,
                           std::vector<ElementTouch>& touches) {
  const double distance = motion.at_rest() ? distance_at_start(pair, kind) : 0.0;
  const auto time = motion.at_rest() ? std::optional(0.0) : first_within(pair, kind, motion.margin);
  if (!time || distance > motion.margin) return false;
  touches.push_back(touch);
  touches.back().time = *time;
  touches.back().distance = distance;
  return true;
}

void TouchFinder::ask_corners(const WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                              std::vector<ElementTouch>& touches) {
  for (unsigned i = 0; i < e.count; ++i) {
    if (((e.own_corners >> i) & 1U) == 0) continue;
    const std::uint32_t v = e.vertex[i];
    Box way = way_of(motion.from[v], motion.to[v]);
    if (motion.margin > 0.0) way = widened(way, motion.margin);
    for (std::size_t n = 0; n < walls.walls().size(); ++n) {
      if (!overlap(way, walls.ways()[n])) continue;
      const NearWall& w = walls.walls()[n];
      const auto& [from, to] = w.corners;
      const MovingPair pair = {{motion.from[v], from[0], from[1], from[2]}, {motion.to[v], to[0], to[1], to[2]}};
      ask(PairKind::vertex_face, pair, motion, {0.0, SolidContactKind::vertex_face, 1, 3, {v}, {0, 1, 2}, w}, touches);
    }
  }
}

void TouchFinder::ask_sides(WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                            std::vector<ElementTouch>& touches) {
  for (unsigned i = 0; i < side_count(e); ++i) {
    if (((e.own_sides >> i) & 1U) == 0) continue;
    const std::uint32_t a = e.vertex[i];
    const std::uint32_t b = e.vertex[(i + 1) % e.count];
    Box way = join(way_of(motion.from[a], motion.to[a]), way_of(motion.from[b], motion.to[b]));
    if (motion.margin > 0.0) way = widened(way, motion.margin);
    for (const WallParts::Part& p : walls.edges()) {
      if (!overlap(way, p.way)) continue;
      const NearWall& w = walls.walls()[p.wall];
      const auto& [from, to] = w.corners;
      const auto k = p.corner;
      const auto l = static_cast<std::uint8_t>((k + 1) % 3);
      const MovingPair pair = {{motion.from[a], motion.from[b], from[k], from[l]},
                               {motion.to[a], motion.to[b], to[k], to[l]}};
      if (!ask(PairKind::edge_edge, pair, motion, {0.0, SolidContactKind::edge_edge, 2, 2, {a, b}, {k, l}, w}, touches))
        continue;
      if (p.beside != p.wall) touches.back().beside = walls.walls()[p.beside].corners;
    }
  }
}

void TouchFinder::ask_face(WallParts& walls, const SolidElement& e, const SolidMotion& motion,
                           std::vector<ElementTouch>& touches) {
  Box way = way_of(e, motion);
  if (motion.margin > 0.0) way = widened(way, motion.margin);
  for (const WallParts::Part& p : walls.vertices()) {
    if (!overlap(way, p.way)) continue;
    const NearWall& w = walls.walls()[p.wall];
    MovingPair pair = {{w.corners.from[p.corner]}, {w.corners.to[p.corner]}};
    for (unsigned i = 0; i < 3; ++i) {
      pair.from[i + 1] = motion.from[e.vertex[i]];
      pair.to[i + 1] = motion.to[e.vertex[i]];
    }
    ask(PairKind::vertex_face, pair, motion, {0.0, SolidContactKind::face_vertex, 3, 1, e.vertex, {p.corner}, w},
        touches);
  }
}

}  // namespace dartcast
