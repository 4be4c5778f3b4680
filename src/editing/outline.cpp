// Finds the form that a cell had before subdivision: corners, edges, sides, spokes.
#include "editing/outline.hpp"

#include <algorithm>

#include "topology/rework.hpp"

namespace dartcast::detail {

Outline::Outline(const CombinatorialMap& map, Cell c, std::span<const Vec3> positions)
    : shape_(map.shape(c)), positions_(positions), dart_at_(shape_.corner_count()) {
  for (std::uint16_t d = 0; d < shape_.dart_count(); ++d) dart_at_[shape_.origin(d)] = d;
  join_coplanar(map, c);
  while (!trace(map, c)) continue;
}

// Gives each face the lowest number to which it is joined.
void Outline::join_coplanar(const CombinatorialMap& map, Cell c) {
  class_.assign(shape_.face_count(), none);
  for (std::uint16_t first = 0; first < shape_.face_count(); ++first) {
    if (class_[first] != none) continue;
    class_[first] = first;
    std::vector<std::uint16_t> reached = {first};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const std::uint16_t begin = shape_.first_dart(reached[i]);
      for (std::uint16_t d = begin; d < begin + shape_.degree(reached[i]); ++d) {
        const std::uint16_t beyond = shape_.phi2(d);
        const std::uint16_t g = shape_.face_of(beyond);
        if (class_[g] != none || !(map.flat({c, d}).coplanar || map.flat({c, beyond}).coplanar)) continue;
        class_[g] = first;
        reached.push_back(g);
      }
    }
  }
}

// Lists the sides. False if some were not sides. Their faces then stand alone, which may change corners of other sides.
bool Outline::trace(const CombinatorialMap& map, Cell c) {
  rims_at_.assign(shape_.corner_count(), 0);
  for (std::uint16_t d = 0; d < shape_.dart_count(); ++d) {
    if (on_rim(d)) ++rims_at_[shape_.origin(d)];
  }
  edge_of_.assign(shape_.dart_count(), none);
  cut_.assign(shape_.dart_count(), false);
  number_.assign(shape_.face_count(), none);
  sides_.clear();
  std::vector<std::vector<std::uint16_t>> faces(shape_.face_count());
  for (std::uint16_t f = 0; f < shape_.face_count(); ++f) faces[class_[f]].push_back(f);
  bool fell_apart = false;
  bool refused = false;
  for (std::uint16_t k = 0; k < faces.size(); ++k) {
    if (faces[k].empty()) continue;
    std::optional<Side> side = side_with(faces[k]);
    if (side) {
      number_[k] = static_cast<std::uint16_t>(sides_.size());
      sides_.push_back(std::move(*side));
    } else {
      for (const std::uint16_t f : faces[k]) class_[f] = f;
      (faces[k].size() > 1 ? fell_apart : refused) = true;
    }
  }
  if (refused && !fell_apart) refuse(map, c, "has a face without three corners: merge faces or edges first");
  return !fell_apart;
}

std::optional<Outline::Side> Outline::side_with(std::vector<std::uint16_t> faces) {
  Side side;
  side.faces = std::move(faces);
  if (!trace_rim(side)) return {};
  if (side.faces.size() > 1 && !(find_spokes(side) && give_out(side))) return {};
  return side;
}

// Whether the rim is one closed path that visits no vertex twice and has three corners.
bool Outline::trace_rim(Side& side) {
  std::size_t count = 0;
  std::uint16_t start = none;
  for (const std::uint16_t f : side.faces) {
    const std::uint16_t begin = shape_.first_dart(f);
    for (std::uint16_t d = begin; d < begin + shape_.degree(f); ++d) {
      if (!on_rim(d)) continue;
      ++count;
      if (start == none && is_corner(shape_.origin(d))) start = d;
    }
  }
  if (start == none) return false;
  std::vector<bool> seen(shape_.corner_count());
  std::uint16_t d = start;
  do {
    const std::uint16_t v = shape_.origin(d);
    if (seen[v]) return false;
    seen[v] = true;
    --count;
    if (is_corner(v)) {
      side.corners.push_back(v);
      side.edges.emplace_back();
    }
    side.edges.back().push_back(d);
    edge_of_[d] = static_cast<std::uint16_t>(side.edges.size() - 1);
    for (d = shape_.phi1(d); !on_rim(d);) d = shape_.phi1(shape_.phi2(d));
  } while (d != start);
  for (std::size_t i = 0; i < side.edges.size(); ++i) {
    std::vector<std::uint16_t> inside;
    for (const std::uint16_t e : side.edges[i]) inside.push_back(shape_.origin(e));
    inside.erase(inside.begin());
    const Vec3 ends = positions_[side.corners[i]] + positions_[side.corners[(i + 1) % side.corners.size()]];
    side.edge_middles.push_back(nearest(inside, ends * 0.5));
  }
  return count == 0 && side.corners.size() >= 3;
}

// If two are equally near, the first in the numbering of the cell is taken, whatever the direction of the edge.
std::uint16_t Outline::nearest(std::span<const std::uint16_t> vertices, const Vec3& x) const {
  const auto key = [&](std::uint16_t v) { return std::pair{norm(positions_[v] - x), v}; };
  const auto best = std::min_element(vertices.begin(), vertices.end(), [&](auto v, auto w) { return key(v) < key(w); });
  return best == vertices.end() ? none : *best;
}

// The vertex from which each vertex is first reached, starting at a vertex inside a side, through others inside it.
std::vector<std::uint16_t> Outline::reach(std::uint16_t from) const {
  std::vector<std::uint16_t> before(shape_.corner_count(), none);
  before[from] = from;
  std::vector<std::uint16_t> reached = {from};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::uint16_t start = dart_at_[reached[i]];
    std::uint16_t d = start;
    do {
      const std::uint16_t to = shape_.origin(shape_.phi1(d));
      if (before[to] == none) {
        before[to] = reached[i];
        if (rims_at_[to] == 0) reached.push_back(to);
      }
      d = shape_.phi1(shape_.phi2(d));
    } while (d != start);
  }
  return before;
}

std::uint16_t Outline::dart_between(std::uint16_t from, std::uint16_t to) const {
  std::uint16_t d = dart_at_[from];
  while (shape_.origin(shape_.phi1(d)) != to) d = shape_.phi1(shape_.phi2(d));
  return d;
}

bool Outline::find_spokes(Side& side) {
  Vec3 sum;
  for (const std::uint16_t v : side.corners) sum += positions_[v];
  std::vector<std::uint16_t> inside;
  for (const std::uint16_t f : side.faces) {
    for (const std::uint16_t v : shape_.corners(f)) {
      if (rims_at_[v] == 0) inside.push_back(v);
    }
  }
  const std::uint16_t middle = nearest(inside, sum * (1.0 / static_cast<double>(side.corners.size())));
  if (middle == none) return false;
  const std::vector<std::uint16_t> before = reach(middle);
  std::vector<bool> used(shape_.corner_count());
  for (const std::uint16_t end : side.edge_middles) {
    if (end == none || before[end] == none) return false;
    std::vector<std::uint16_t> spoke = {end};
    for (std::uint16_t v = end; v != middle; v = before[v]) {
      const std::uint16_t d = dart_between(before[v], v);
      cut_[d] = cut_[shape_.phi2(d)] = true;
      spoke.push_back(before[v]);
      if (used[v]) return false;
      used[v] = true;
    }
    std::reverse(spoke.begin(), spoke.end());
    side.spokes.push_back(std::move(spoke));
  }
  return true;
}

// Assigns each face to the corner from which it is reached without crossing a spoke.
bool Outline::give_out(Side& side) {
  std::vector<std::uint16_t> corner(shape_.face_count(), none);
  for (std::size_t i = 0; i < side.corners.size(); ++i) {
    std::vector<std::uint16_t> reached = {shape_.face_of(side.edges[i].front())};
    if (corner[reached[0]] != none) return false;
    corner[reached[0]] = side.corners[i];
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const std::uint16_t begin = shape_.first_dart(reached[k]);
      for (std::uint16_t d = begin; d < begin + shape_.degree(reached[k]); ++d) {
        const std::uint16_t g = shape_.face_of(shape_.phi2(d));
        if (cut_[d] || on_rim(d) || corner[g] != none) continue;
        corner[g] = side.corners[i];
        reached.push_back(g);
      }
    }
  }
  for (const std::uint16_t f : side.faces) side.corner_of.push_back(corner[f]);
  return std::find(side.corner_of.begin(), side.corner_of.end(), none) == side.corner_of.end();
}

std::vector<std::uint16_t> Outline::corners() const {
  std::vector<std::uint16_t> corners;
  for (std::uint16_t v = 0; v < shape_.corner_count(); ++v) {
    if (is_corner(v)) corners.push_back(v);
  }
  return corners;
}

}  // namespace dartcast::detail
