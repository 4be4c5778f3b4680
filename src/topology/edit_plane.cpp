// The edits of dartcast/map_edits.hpp if cells are polygons.
#include "topology/edit_plane.hpp"

#include <algorithm>

#include "topology/rework.hpp"

namespace dartcast::detail {

namespace {

using PolygonEdges = std::vector<DraftFace>;

PolygonEdges::iterator at(PolygonEdges& edges, std::size_t number) {
  return edges.begin() + static_cast<std::ptrdiff_t>(number);
}

// Splits an edge at v. The second part follows the first, which continues the edge.
void cut_edge(CellDraft& draft, std::uint16_t edge, Vertex v) {
  DraftFace rest = draft.faces[edge];
  rest.from = {};
  rest.corners[0] = {v, true};
  draft.faces[edge].corners[1] = {v};
  draft.faces.insert(at(draft.faces, edge + std::size_t{1}), std::move(rest));
}

// Sews edges of two drafts to each other.
void link(Rework& rework, Cell c, std::size_t edge, Cell other, std::size_t other_edge) {
  const std::uint32_t here = rework.take(c);
  const std::uint32_t there = rework.take(other);
  rework.draft(here).faces[edge].across = {{}, there, static_cast<std::uint16_t>(other_edge)};
  rework.draft(there).faces[other_edge].across = {{}, here, static_cast<std::uint16_t>(edge)};
}

}  // namespace

SplitEdge split_edge_in_plane(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  const Dart beyond = map.phi2(d);
  const Transaction::Savepoint before = t.savepoint();
  SplitEdge split;
  split.vertex = t.add_vertex(map.origin(d), map.origin(map.phi1(d)));
  try {
    Rework rework(t);
    cut_edge(rework.draft(d.cell), d.number, split.vertex);
    if (beyond.valid()) {
      cut_edge(rework.draft(beyond.cell), beyond.number, split.vertex);
      link(rework, d.cell, d.number, beyond.cell, beyond.number + 1U);
      link(rework, d.cell, d.number + 1U, beyond.cell, beyond.number);
    }
    split.cells = rework.put();
  } catch (...) {
    t.roll_back(before);
    throw;
  }
  return split;
}

std::vector<Cell> split_polygon(Transaction& t, Dart a, Dart b) {
  const CombinatorialMap& map = t.map();
  if (a.cell != b.cell) refuse(map, a.cell, "has not both of the corners: name two of one polygon");
  if (a == b || map.phi1(a) == b || map.phi1(b) == a)
    refuse(map, a.cell, "has the two corners side by side: name two that no edge joins");
  CellDraft whole = draft_of(map, a.cell);
  std::rotate(whole.faces.begin(), at(whole.faces, a.number), whole.faces.end());
  const std::size_t n = whole.faces.size();
  const std::size_t middle = (b.number + n - a.number) % n;
  CellDraft part[2];
  for (const std::uint32_t side : {0U, 1U}) {
    part[side].free = whole.free;
    part[side].source = whole.source;
    part[side].faces.assign(at(whole.faces, side == 0 ? 0 : middle), at(whole.faces, side == 0 ? middle : n));
    part[side].faces[0].corners[0].straight = false;
    part[side].faces.push_back({{{map.origin(side == 0 ? b : a)}, {map.origin(side == 0 ? a : b)}}, {}, {}, {}, {}});
  }
  for (const std::uint32_t side : {0U, 1U})
    part[side].faces.back().across = {{}, 1 - side, static_cast<std::uint16_t>(part[1 - side].faces.size() - 1)};
  const Cell cells[] = {a.cell};
  return t.replace(cells, part);
}

Cell merge_polygons(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  const Dart beyond = map.phi2(d);
  CellDraft whole = draft_of(map, d.cell);
  CellDraft other = draft_of(map, beyond.cell);
  std::rotate(whole.faces.begin(), at(whole.faces, d.number), whole.faces.end());
  std::rotate(other.faces.begin(), at(other.faces, beyond.number), other.faces.end());
  // At the former ends of the edge the polygon may be straight now.
  whole.faces[1].corners[0].straight = other.faces[1].corners[0].straight = true;
  whole.faces.erase(whole.faces.begin());
  whole.faces.insert(whole.faces.end(), other.faces.begin() + 1, other.faces.end());
  const Cell cells[] = {d.cell, beyond.cell};
  return t.replace(cells, {&whole, 1})[0];
}

namespace {

// Merges an edge with the next one.
void join_edges(CellDraft& draft, std::uint16_t first, std::uint16_t second) {
  DraftFace& edge = draft.faces[first];
  edge.corners[1] = draft.faces[second].corners[1];
  if (edge.patch == Patch{}) edge.patch = draft.faces[second].patch;
  draft.faces.erase(at(draft.faces, second));
}

}  // namespace

std::vector<Cell> merge_edges_in_plane(Transaction& t, Dart d) {
  const CombinatorialMap& map = t.map();
  const Dart before = map.phi_1(d);
  const Dart beyond = map.phi2(d);
  const Dart beyond_before = map.phi2(before);
  const bool two = beyond.valid() ? beyond_before.valid() && map.phi1(beyond) == beyond_before : !beyond_before.valid();
  if (!two) refuse(map, d.cell, "has more than two edges at the vertex: merge faces there first");
  Rework rework(t);
  const auto join = [&](Dart first, Dart second) {
    if (map.shape(first.cell).face_count() == 3)
      refuse(map, first.cell, "is a triangle, and with an edge less no polygon: merge it with another first");
    join_edges(rework.draft(first.cell), first.number, second.number);
    return static_cast<std::size_t>(first.number - (second.number < first.number ? 1 : 0));
  };
  const std::size_t edge = join(before, d);
  if (beyond.valid()) {
    const std::size_t other = join(beyond, beyond_before);
    link(rework, d.cell, edge, beyond.cell, other);
  }
  return rework.put();
}

}  // namespace dartcast::detail
