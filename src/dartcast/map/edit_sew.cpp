// Edits that sew faces and open them.
#include <algorithm>
#include <unordered_set>
#include <utility>

#include "dartcast/map/edit.hpp"
#include "dartcast/map/rework.hpp"

namespace dartcast {

using detail::expect_dart;
using detail::expect_face;
using detail::refuse;
using detail::Rework;

namespace {

// The cells around a vertex of a cell, reached over faces with that vertex but for one face.
std::vector<Cell> around_vertex(const Map& map, Cell start, Vertex v, CellFace but = {}) {
  const CellFace from_beyond = but.valid() ? map.opposite(but) : CellFace{};
  std::vector<Cell> cells = {start};
  std::unordered_set<std::uint32_t> seen = {start.value};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView view = map.view(cells[i]);
    const Shape& s = view.shape();
    for (std::uint16_t d = 0; d < s.dart_count(); ++d) {
      if (view.vertex(s.origin(d)) != v) continue;
      const CellFace f{cells[i], s.face_of(d)};
      const Cell other = view.neighbour(f.face);
      if (f == but || f == from_beyond || !other.valid()) continue;
      if (seen.insert(other.value).second) cells.push_back(other);
    }
  }
  return cells;
}

// Gives a vertex of a cell another number, all renamings at once: the map says which vertex a corner was. A face that
// has it needs another point: weights name corners.
void rename(const Map& map, Cell c, CellDraft& draft, Vertex from, Vertex to) {
  const CellView v = map.view(c);
  for (std::uint16_t d = 0; d < v.shape().dart_count(); ++d) {
    if (v.vertex(v.shape().origin(d)) != from) continue;
    DraftFace& face = draft.faces[v.shape().face_of(d)];
    face.corners[detail::corner_of(v.shape(), d)].vertex = to;
    face.point = {};
  }
}

std::vector<Dart> darts_of(const Map& map, CellFace f) {
  const Shape& s = map.shape(f.cell);
  std::vector<Dart> darts;
  for (std::uint16_t d = s.first_dart(f.face); d < s.first_dart(f.face) + s.degree(f.face); ++d)
    darts.push_back({f.cell, d});
  return darts;
}

}  // namespace

std::vector<Cell> sew(Transaction& t, Dart a, Dart b) {
  const Map& map = t.map();
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
  const Transaction::Mark before = t.mark();
  Rework rework(t);
  rework.draft(f.cell).faces[f.face].across.face = g;
  rework.draft(g.cell).faces[g.face].across.face = f;
  rework.draft(f.cell).faces[f.face].point = {};
  rework.draft(g.cell).faces[g.face].point = {};
  Dart x = a;
  Dart y = map.phi1(b);
  do {
    const Vertex u = map.origin(x);
    const Vertex v = map.origin(y);
    const Vertex gone = std::max(u, v);
    if (u != v) {
      for (const Cell c : around_vertex(map, u > v ? x.cell : y.cell, gone))
        rename(map, c, rework.draft(c), gone, std::min(u, v));
      t.note_identified(gone, std::min(u, v));
    }
    x = map.phi1(x);
    y = map.phi_1(y);
  } while (x != a);
  try {
    return rework.put();
  } catch (...) {
    t.roll_back(before);
    throw;
  }
}

std::vector<Cell> unsew(Transaction& t, CellFace f) {
  const Map& map = t.map();
  expect_face(map, f);
  const CellFace g = map.opposite(f);
  if (!g.valid()) refuse(map, f.cell, "has nothing beyond the face to unsew: it is on the boundary");
  const Transaction::Mark before = t.mark();
  try {
    Rework rework(t);
    rework.draft(f.cell).faces[f.face].across = {};
    rework.draft(g.cell).faces[g.face].across = {};
    for (const Dart d : darts_of(map, f)) {
      const Vertex v = map.origin(d);
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

}  // namespace dartcast
