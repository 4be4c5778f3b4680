// Edits that sew faces and open them, and walls between two cells.
#include <algorithm>
#include <map>
#include <unordered_set>
#include <utility>

#include "dartcast/map_edits.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::expect_dart;
using detail::expect_face;
using detail::refuse;
using detail::Rework;

namespace {

bool has_corner(const CellView& view, std::uint16_t face, Vertex v) {
  const auto corners = view.shape().corners(face);
  return std::any_of(corners.begin(), corners.end(), [&](std::uint16_t k) { return view.vertex(k) == v; });
}

// The cells around a vertex of a cell that are connected to it over faces with that vertex, except one face.
std::vector<Cell> around_vertex(const CombinatorialMap& map, Cell start, Vertex v, CellFace but = {}) {
  const CellFace from_beyond = but.valid() ? map.opposite(but) : CellFace{};
  std::vector<Cell> cells = {start};
  std::unordered_set<std::uint32_t> seen = {start.value};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView view = map.view(cells[i]);
    for (std::uint16_t face = 0; face < view.shape().face_count(); ++face) {
      const CellFace f{cells[i], face};
      const Cell other = view.neighbour(face);
      if (f == but || f == from_beyond || !other.valid() || !has_corner(view, face, v)) continue;
      if (seen.insert(other.value).second) cells.push_back(other);
    }
  }
  return cells;
}

// Gives vertices of a cell other numbers, all at once: the map says which vertex each corner was. A face with such a
// vertex needs a new Steiner point, because weights name corners.
void rename(const CombinatorialMap& map, Cell c, CellDraft& draft, Vertex from, Vertex to) {
  const CellView v = map.view(c);
  for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
    const auto corners = v.shape().corners(f);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (v.vertex(corners[k]) != from) continue;
      draft.faces[f].corners[k].vertex = to;
      draft.faces[f].point = {};
    }
  }
}

// The corners of the dart's face, from its origin on.
std::vector<Vertex> corners_from(const CombinatorialMap& map, Dart d) {
  const CellView view = map.view(d.cell);
  const auto corners = view.shape().corners(view.shape().face_of(d.number));
  const std::size_t first = detail::corner_of(view.shape(), d.number);
  std::vector<Vertex> vertices;
  for (std::size_t k = 0; k < corners.size(); ++k)
    vertices.push_back(view.vertex(corners[(first + k) % corners.size()]));
  return vertices;
}

std::vector<Vertex> sorted_corners(const CombinatorialMap& map, CellFace f) {
  std::vector<Vertex> corners = corners_from(map, {f.cell, map.shape(f.cell).first_dart(f.face)});
  std::sort(corners.begin(), corners.end());
  return corners;
}

// The sides of walls between two cells, among these open faces: those with the same corners, in the order of the first.
// `single`: called with each face that is alone.
template <class Single>
std::vector<CellFace> paired(const CombinatorialMap& map, std::span<const CellFace> faces, const Single& single) {
  std::map<std::vector<Vertex>, CellFace> beyond;  // the last face with these corners
  for (const CellFace f : faces) beyond[sorted_corners(map, f)] = f;
  std::vector<CellFace> pairs;
  for (const CellFace f : faces) {
    const auto found = beyond.find(sorted_corners(map, f));
    if (found == beyond.end()) continue;  // the second side
    if (found->second == f)
      single(f);
    else
      pairs.insert(pairs.end(), {f, found->second});
    beyond.erase(found);
  }
  return pairs;
}

}  // namespace

std::vector<Cell> sew(Transaction& t, Dart a, Dart b) {
  const CombinatorialMap& map = t.map();
  expect_dart(map, a);
  expect_dart(map, b);
  const CellFace f = map.face(a);
  const CellFace g = map.face(b);
  for (const CellFace& face : {f, g}) {
    if (map.opposite(face).valid()) refuse(map, face.cell, "has its face sewn already: unsew it first");
  }
  if (a.cell == b.cell) refuse(map, a.cell, "is to be sewn to itself: split it first");
  if (map.shape(f.cell).degree(f.face) != map.shape(g.cell).degree(g.face))
    refuse(map, a.cell, "has a face with another number of corners than the one to sew it to: split an edge first");
  const Transaction::Savepoint before = t.savepoint();
  Rework rework(t);
  rework.draft(f.cell).faces[f.face].across.face = g;
  rework.draft(g.cell).faces[g.face].across.face = f;
  rework.draft(f.cell).faces[f.face].point = {};
  rework.draft(g.cell).faces[g.face].point = {};
  const std::vector<Vertex> here = corners_from(map, a);
  const std::vector<Vertex> there = corners_from(map, b);
  for (std::size_t i = 0; i < here.size(); ++i) {
    const Vertex u = here[i];
    const Vertex v = there[(here.size() + 1 - i) % here.size()];
    if (u == v) continue;
    const Vertex gone = std::max(u, v);
    for (const Cell c : around_vertex(map, u > v ? a.cell : b.cell, gone))
      rename(map, c, rework.draft(c), gone, std::min(u, v));
    t.note_merged(gone, std::min(u, v));
  }
  try {
    return rework.put();
  } catch (...) {
    t.roll_back(before);
    throw;
  }
}

std::vector<Cell> unsew(Transaction& t, CellFace f) {
  const CombinatorialMap& map = t.map();
  expect_face(map, f);
  const CellFace g = map.opposite(f);
  if (!g.valid()) refuse(map, f.cell, "has nothing beyond the face to unsew: it is on the boundary");
  const Transaction::Savepoint before = t.savepoint();
  try {
    Rework rework(t);
    rework.draft(f.cell).faces[f.face].across = {};
    rework.draft(g.cell).faces[g.face].across = {};
    for (const Vertex v : corners_from(map, {f.cell, map.shape(f.cell).first_dart(f.face)})) {
      const std::vector<Cell> beyond = around_vertex(map, g.cell, v, f);
      if (std::find(beyond.begin(), beyond.end(), f.cell) != beyond.end()) continue;
      const Vertex parted = t.add_vertex(v, v);
      for (const Cell c : beyond) rename(map, c, rework.draft(c), v, parted);
    }
    return rework.put();
  } catch (...) {
    t.roll_back(before);
    throw;
  }
}

std::vector<Cell> set_walls(Transaction& t, std::span<const CellFace> faces, Patch patch) {
  const CombinatorialMap& map = t.map();
  Rework rework(t);
  for (const CellFace f : faces) {
    expect_face(map, f);
    const CellFace g = map.opposite(f);
    if (!g.valid()) refuse(map, f.cell, "has nothing beyond the face: it is a wall already");
    for (const CellFace side : {f, g}) {
      DraftFace& face = rework.draft(side.cell).faces[side.face];
      face.across = {};
      face.patch = patch;
    }
  }
  return rework.put();
}

std::vector<Cell> remove_walls(Transaction& t, std::span<const CellFace> faces) {
  const CombinatorialMap& map = t.map();
  for (const CellFace f : faces) {
    expect_face(map, f);
    if (map.opposite(f).valid()) refuse(map, f.cell, "has another cell beyond the face: it is no wall to remove");
  }
  const auto fail = [&](CellFace f) {
    refuse(map, f.cell, "has a wall to remove, but no face with the same corners is named: name both its sides");
  };
  const std::vector<CellFace> pairs = paired(map, faces, fail);
  Rework rework(t);
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    const CellFace f = pairs[i];
    const CellFace g = pairs[i + 1];
    const bool same_point = map.point(f) == map.point(g);
    for (const auto& [side, other] : {std::pair{f, g}, std::pair{g, f}}) {
      DraftFace& face = rework.draft(side.cell).faces[side.face];
      face.across.face = other;
      if (!same_point) face.point = {};
    }
  }
  return rework.put();
}

std::vector<CellFace> inner_walls(const CombinatorialMap& map) {
  std::vector<CellFace> open;
  for (const Cell c : map.cells()) {
    const std::size_t count = map.shape(c).face_count();
    for (std::uint16_t f = 0; f < count; ++f) {
      if (!map.opposite({c, f}).valid()) open.push_back({c, f});
    }
  }
  return paired(map, open, [](CellFace) {});
}

}  // namespace dartcast
