// Edits that remove a face, an edge, a vertex or a cell.
#include <algorithm>

#include "dartcast/map_edits.hpp"
#include "topology/edit_plane.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::around_edge;
using detail::corner_of;
using detail::expect_dart;
using detail::expect_face;
using detail::refuse;
using detail::Rework;

namespace {

// The faces of a cell without one. The faces beyond its edges may now lie in one plane with others.
std::vector<DraftFace> all_but(const CombinatorialMap& map, CellFace f) {
  const Shape& s = map.shape(f.cell);
  CellDraft draft = draft_of(map, f.cell);
  for (std::uint16_t d = s.first_dart(f.face); d < s.first_dart(f.face) + s.degree(f.face); ++d) {
    const std::uint16_t beyond = s.phi2(d);
    draft.faces[s.face_of(beyond)].corners[corner_of(s, beyond)].coplanar = true;
  }
  draft.faces.erase(draft.faces.begin() + f.face);
  return std::move(draft.faces);
}

// Whether a cell has another face to the same neighbour.
bool share_more(const CombinatorialMap& map, CellFace f) {
  const CellView v = map.view(f.cell);
  for (std::uint16_t g = 0; g < v.shape().face_count(); ++g) {
    if (g != f.face && v.neighbour(g) == v.neighbour(f.face)) return true;
  }
  return false;
}

}  // namespace

Cell merge_cells(Transaction& t, CellFace f) {
  const CombinatorialMap& map = t.map();
  expect_face(map, f);
  const CellFace other = map.opposite(f);
  if (!other.valid()) refuse(map, f.cell, "has nothing beyond the face to merge with: it is on the boundary");
  if (map.is_free(f.cell) != map.is_free(other.cell))
    refuse(map, f.cell, "and the one beyond the face are not both free or both blocked: mark them alike first");
  if (share_more(map, f))
    refuse(map, f.cell, "shares more than one face with the cell beyond: merge these faces first");
  if (map.dimension() == 2) return detail::merge_polygons(t, {f.cell, f.face});
  CellDraft whole;
  whole.free = map.is_free(f.cell);
  whole.source = map.source(f.cell);
  whole.faces = all_but(map, f);
  for (DraftFace& face : all_but(map, other)) whole.faces.push_back(std::move(face));
  const Cell cells[] = {f.cell, other.cell};
  return t.replace(cells, {&whole, 1})[0];
}

namespace {

// Merges the two faces at the edge of a dart. The second face is removed.
void join_faces(CellDraft& draft, const Shape& s, std::uint16_t dart) {
  const std::uint16_t beyond = s.phi2(dart);
  const std::uint16_t f = s.face_of(dart);
  const std::uint16_t g = s.face_of(beyond);
  // From the dart's end around the first face to its origin, then around the second.
  std::vector<DraftCorner> first = draft.faces[f].corners;
  std::vector<DraftCorner> second = draft.faces[g].corners;
  std::rotate(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(corner_of(s, s.phi1(dart))), first.end());
  std::rotate(second.begin(), second.begin() + static_cast<std::ptrdiff_t>(corner_of(s, s.phi1(beyond))), second.end());
  first.front().straight = true;
  first.back() = second.front();
  first.back().straight = true;
  first.insert(first.end(), second.begin() + 1, second.end() - 1);
  draft.faces[f].corners = std::move(first);
  draft.faces[f].point = {};
  if (draft.faces[f].patch == Patch{}) draft.faces[f].patch = draft.faces[g].patch;
  draft.faces.erase(draft.faces.begin() + g);
}

}  // namespace

std::vector<Cell> merge_faces(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  expect_dart(map, d);
  if (map.dimension() == 2) return {merge_cells(t, map.face(d))};
  const Dart beyond = map.phi3(d);
  const Dart second = map.phi3(map.phi2(d));
  if (beyond.valid() != second.valid() || (beyond.valid() && map.phi2(beyond) != second))
    refuse(map, d.cell, "has an edge around which there are more than two faces: merge cells there first");
  Rework rework(t);
  join_faces(rework.draft(d.cell), map.shape(d.cell), d.number);
  if (beyond.valid()) join_faces(rework.draft(beyond.cell), map.shape(beyond.cell), beyond.number);
  return rework.put();
}

namespace {

// Removes the corner at which a dart starts from its face.
void drop_corner(CellDraft& draft, const Shape& s, std::uint16_t dart) {
  auto& corners = draft.faces[s.face_of(dart)].corners;
  const std::size_t at = corner_of(s, dart);
  DraftCorner& before = corners[(at + corners.size() - 1) % corners.size()];
  before.coplanar = before.coplanar || corners[at].coplanar;
  corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(at));
  draft.faces[s.face_of(dart)].point = {};
}

}  // namespace

std::vector<Cell> merge_edges(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  expect_dart(map, d);
  if (map.dimension() == 2) return detail::merge_edges_in_plane(t, d);
  Rework rework(t);
  for (const Dart x : around_edge(map, d)) {
    const Dart y = map.alpha1(x);
    const Shape& s = map.shape(x.cell);
    if (y == x || map.alpha1(y) != x)
      refuse(map, x.cell, "has more than two edges at the vertex: merge faces there first");
    if (s.degree(s.face_of(x.number)) == 3 || s.degree(s.face_of(y.number)) == 3)
      refuse(map, x.cell, "has a triangle at the vertex, which would be no face: merge it with another first");
    drop_corner(rework.draft(x.cell), s, x.number);
    drop_corner(rework.draft(x.cell), s, y.number);
  }
  return rework.put();
}

void remove(Transaction& t, Cell c) {
  const Cell cells[] = {c};
  t.replace(cells, {});
}

Dart find_dart(const CombinatorialMap& map, Cell c, Vertex from, Vertex to) {
  if (!map.contains(c)) return {};
  const Shape& s = map.shape(c);
  for (std::uint16_t d = 0; d < s.dart_count(); ++d) {
    if (map.origin({c, d}) == from && map.origin({c, s.phi1(d)}) == to) return {c, d};
  }
  return {};
}

}  // namespace dartcast
