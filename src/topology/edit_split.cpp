// Edits that add a vertex, an edge or a face.
#include <algorithm>
#include <utility>

#include "dartcast/map_edits.hpp"
#include "topology/draft_cuts.hpp"
#include "topology/edit_plane.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::around_edge;
using detail::corner_of;
using detail::cut_face;
using detail::expect_dart;
using detail::refuse;
using detail::Rework;

namespace {

// Adds a vertex behind the corner at which the dart starts.
void put_on_edge(CellDraft& draft, const Shape& s, std::uint16_t dart, Vertex v) {
  DraftFace& face = draft.faces[s.face_of(dart)];
  const std::size_t at = corner_of(s, dart);
  face.corners.insert(face.corners.begin() + static_cast<std::ptrdiff_t>(at + 1), {v, true, face.corners[at].coplanar});
  face.point = {};
}

}  // namespace

SplitEdge split_edge(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  expect_dart(map, d);
  if (map.dimension() == 2) return detail::split_edge_in_plane(t, d);
  const Transaction::Savepoint before = t.savepoint();
  SplitEdge split;
  split.vertex = t.add_vertex(map.origin(d), map.origin(map.phi1(d)));
  try {
    Rework rework(t);
    for (const Dart x : around_edge(map, d)) {
      CellDraft& draft = rework.draft(x.cell);
      put_on_edge(draft, map.shape(x.cell), x.number, split.vertex);
      put_on_edge(draft, map.shape(x.cell), map.phi2(x).number, split.vertex);
    }
    split.cells = rework.put();
  } catch (...) {
    t.roll_back(before);
    throw;
  }
  return split;
}

std::vector<Cell> split_face(Transaction& t, Dart a, Dart b) {
  const CombinatorialMap& map = t.map();
  expect_dart(map, a);
  expect_dart(map, b);
  if (map.dimension() == 2) return detail::split_polygon(t, a, b);
  const CellFace f = map.face(a);
  if (map.face(b) != f) refuse(map, a.cell, "has the two corners in different faces: name two of one face");
  if (a == b || map.phi1(a) == b || map.phi1(b) == a)
    refuse(map, a.cell, "has the two corners side by side: name two that no edge of the face joins");
  const Vertex u = map.origin(a);
  const Vertex v = map.origin(b);
  Rework rework(t);
  CellDraft& here = rework.draft(a.cell);
  cut_face(here, f.face, u, v);
  if (const CellFace other = map.opposite(f); other.valid()) {
    const std::uint32_t beyond = rework.take(other.cell);
    cut_face(rework.draft(beyond), other.face, v, u);
    const auto last = [](const CellDraft& draft) { return static_cast<std::uint16_t>(draft.faces.size() - 1); };
    rework.draft(a.cell).faces.back().across = {{}, beyond, last(rework.draft(beyond))};
    rework.draft(beyond).faces.back().across = {{}, rework.take(a.cell), last(rework.draft(a.cell))};
  }
  return rework.put();
}

namespace {

// The faces on the left of a closed path. A search finds them from the faces of the path's darts without crossing it.
std::vector<bool> left_of(const Shape& s, std::span<const std::uint16_t> path) {
  std::vector<bool> crossed(s.dart_count());
  for (const std::uint16_t d : path) crossed[d] = crossed[s.phi2(d)] = true;
  std::vector<bool> left(s.face_count());
  std::vector<std::uint16_t> reached = {s.face_of(path[0])};
  left[reached[0]] = true;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::uint16_t first = s.first_dart(reached[i]);
    for (std::uint16_t d = first; d < first + s.degree(s.face_of(first)); ++d) {
      const std::uint16_t f = s.face_of(s.phi2(d));
      if (crossed[d] || left[f]) continue;
      left[f] = true;
      reached.push_back(f);
    }
  }
  return left;
}

// The face along which a cell is split, as the part on the left sees it. The faces around the path decide where it may
// be straight.
class CutFace {
 public:
  CutFace(const CombinatorialMap& map, Cell c) : map_(map), s_(map.shape(c)), cell_(c) {}

  DraftFace seen_from_left(std::span<const std::uint16_t> path) const {
    DraftFace face;
    for (std::size_t i = path.size(); i-- > 0;) {
      const std::uint16_t in = path[(i + path.size() - 1) % path.size()];
      const bool straight = one_plane(in, path[i]);
      face.corners.push_back({map_.origin({cell_, path[i]}), straight, false});
    }
    return face;
  }

 private:
  // Whether the faces on the left between two darts of the path may lie in one plane (or, if it is one face, be
  // straight there). If the path is straight there, they do, because the cell is convex, and so do those on the right.
  [[nodiscard]] bool one_plane(std::uint16_t in, std::uint16_t out) const {
    std::uint16_t d = s_.phi1(in);
    if (d == out) return map_.flat({cell_, d}).straight;
    for (; d != out; d = s_.phi1(s_.phi2(d))) {
      if (!map_.flat({cell_, d}).coplanar) return false;
    }
    return true;
  }

  const CombinatorialMap& map_;
  const Shape& s_;
  Cell cell_;
};

std::vector<std::uint16_t> checked_path(const CombinatorialMap& map, std::span<const Dart> path) {
  if (path.size() < 3) throw InvalidArgument("a path to cut along has at least three darts");
  std::vector<std::uint16_t> numbers;
  std::vector<Vertex> vertices;
  for (std::size_t i = 0; i < path.size(); ++i) {
    expect_dart(map, path[i]);
    if (path[i].cell != path[0].cell) throw InvalidArgument("the path to cut along leaves the cell: name darts of one");
    if (map.origin(path[i]) != map.origin(map.phi2(path[(i + path.size() - 1) % path.size()])))
      refuse(map, path[i].cell, "has a gap in the path to cut along: each dart starts where the one before ends");
    numbers.push_back(path[i].number);
    vertices.push_back(map.origin(path[i]));
  }
  std::sort(vertices.begin(), vertices.end());
  if (std::adjacent_find(vertices.begin(), vertices.end()) != vertices.end())
    refuse(map, path[0].cell, "is to be cut along a path with a vertex that comes twice: cut along one loop at a time");
  return numbers;
}

// Faces on the two sides of the path are now in two cells.
void part_at(CellDraft& whole, const Shape& s, std::span<const std::uint16_t> path) {
  for (const std::uint16_t d : path) {
    for (const std::uint16_t side : {d, s.phi2(d)})
      whole.faces[s.face_of(side)].corners[corner_of(s, side)].coplanar = false;
  }
}

}  // namespace

std::array<Cell, 2> split_cell(Transaction& t, std::span<const Dart> path) {
  const CombinatorialMap& map = t.map();
  if (map.dimension() == 2) throw InvalidArgument("a polygon is split between two of its corners: call split_face()");
  const std::vector<std::uint16_t> numbers = checked_path(map, path);
  const Cell c = path[0].cell;
  const std::vector<bool> left = left_of(map.shape(c), numbers);
  CellDraft whole = draft_of(map, c);
  part_at(whole, map.shape(c), numbers);
  std::array<CellDraft, 2> part;
  for (const unsigned side : {0U, 1U}) {
    part[side].free = whole.free;
    part[side].source = whole.source;
    for (std::size_t f = 0; f < whole.faces.size(); ++f) {
      if (left[f] == (side == 0)) part[side].faces.push_back(std::move(whole.faces[f]));
    }
    if (part[side].faces.size() < 3) refuse(map, c, "is to be cut around fewer than three faces: choose another path");
  }
  const DraftFace cut = CutFace(map, c).seen_from_left(numbers);
  for (const unsigned side : {0U, 1U}) {
    part[side].faces.push_back(cut);
    part[side].faces.back().across = {{}, 1 - side, static_cast<std::uint16_t>(part[1 - side].faces.size() - side)};
  }
  std::reverse(part[1].faces.back().corners.begin(), part[1].faces.back().corners.end());
  const Cell cells[] = {c};
  const std::vector<Cell> parts = t.replace(cells, part);
  return {parts[0], parts[1]};
}

}  // namespace dartcast
