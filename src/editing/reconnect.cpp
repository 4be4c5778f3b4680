// Sews two ends of a vessel, or fills the gap between them with cells.
#include <algorithm>
#include <limits>
#include <set>

#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "editing/cutter.hpp"
#include "editing/face_set.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::FaceSet;
using detail::Matching;

namespace {

// The distance of corners from their counterparts, in metres and as the largest share of a shortest edge.
struct Gap {
  double distance = 0.0;
  double share = 0.0;
};

Gap gap_of(ComplexEdit& edit, const FaceSet& a, const FaceSet& b, const Matching& matching) {
  std::map<Vertex, double> shortest;
  for (const Dart d : a.darts()) {
    const double length = norm(edit.position(a.to(d)) - edit.position(a.from(d)));
    for (const Vertex v : {a.from(d), a.to(d)}) {
      const auto [at, fresh] = shortest.emplace(v, length);
      at->second = std::min(at->second, length);
    }
  }
  Gap gap;
  for (const auto& [x, y] : matching) {
    const double distance = norm(edit.position(a.from(x)) - edit.position(b.to(y)));
    gap.distance = std::max(gap.distance, distance);
    if (distance > 0.0) gap.share = std::max(gap.share, distance / shortest.at(a.from(x)));
  }
  return gap;
}

// Sews all faces at once. One after another, some would be refused for a state that the next one repairs.
std::vector<Cell> sew_all(ComplexEdit& edit, const FaceSet& a, const Matching& matching) {
  const CombinatorialMap& map = edit.map();
  detail::Rework rework(edit.topology());
  const auto link = [&](CellFace f, CellFace g) {
    DraftFace& face = rework.draft(f.cell).faces[f.face];
    face.across.face = g;
    face.point = {};
  };
  std::set<Dart> renamed;
  for (const auto& [x, y] : matching) {
    link(map.face(x), map.face(y));
    link(map.face(y), map.face(x));
    const Dart corner = map.phi1(y);
    const Vertex merged_into = a.from(x);
    const Vertex gone = map.origin(corner);
    if (gone == merged_into || renamed.contains(corner)) continue;
    for (const Dart d : vertex_orbit(map, corner)) {
      renamed.insert(d);
      DraftFace& face = rework.draft(d.cell).faces[map.face(d).face];
      face.corners[detail::corner_of(map.shape(d.cell), d.number)].vertex = merged_into;
      face.point = {};
    }
    edit.topology().note_merged(gone, merged_into);
  }
  return rework.put();
}

// A cell that fills a gap along some open faces.
class Filling {
 public:
  Filling(const CombinatorialMap& map, bool free, std::uint32_t source) : map_(map) {
    draft.free = free;
    draft.source = source;
  }

  /// Adds a face against an open one, with its corners in opposite order. `coplanar`: whether, at a dart of the open
  /// face, the filling's face beyond that edge may lie in the same plane.
  template <class Coplanar>
  void add_against(CellFace f, Coplanar&& coplanar) {
    const Shape& s = map_.shape(f.cell);
    DraftFace face;
    for (std::uint16_t k = s.degree(f.face); k-- > 0;) {
      const Dart d{f.cell, static_cast<std::uint16_t>(s.first_dart(f.face) + k)};
      const Dart before = map_.phi_1(d);
      face.corners.push_back({map_.origin(d), map_.flat(d).straight, coplanar(before)});
    }
    face.across.face = f;
    face.point = map_.point(f);
    draft.faces.push_back(std::move(face));
  }

  void add_side(const std::vector<Vertex>& corners, Patch patch) {
    DraftFace face;
    for (const Vertex v : corners) face.corners.push_back({v, false, false});
    face.patch = patch;
    draft.faces.push_back(std::move(face));
  }

  CellDraft draft;

 private:
  const CombinatorialMap& map_;
};

// Makes a cell between each pair of faces. Its sides meet those of the next.
std::vector<Cell> fill_pairs(ComplexEdit& edit, const FaceSet& a, const FaceSet& b, const Matching& matching,
                             Patch side) {
  const CombinatorialMap& map = edit.map();
  std::vector<CellDraft> drafts;
  std::map<Dart, DraftLink> side_of;  // by the dart of a
  for (const CellFace& f : a.faces()) {
    const Shape& s = map.shape(f.cell);
    const Dart first{f.cell, s.first_dart(f.face)};
    const CellFace g = map.face(matching.at(first));
    Filling filling(map, map.is_free(f.cell) && map.is_free(g.cell), map.source(f.cell));
    filling.add_against(f, [](Dart) { return false; });
    filling.add_against(g, [](Dart) { return false; });
    Dart d = first;
    for (std::uint16_t k = 0; k < s.degree(f.face); ++k, d = map.phi1(d)) {
      const Dart e = matching.at(d);
      side_of[d] = {{}, static_cast<std::uint32_t>(drafts.size()), static_cast<std::uint16_t>(2 + k)};
      filling.add_side({a.from(d), a.to(d), b.from(e), b.to(e)}, a.across(d).valid() ? Patch{} : side);
    }
    drafts.push_back(std::move(filling.draft));
  }
  for (const auto& [d, here] : side_of) {
    if (const Dart beyond = a.across(d); beyond.valid())
      drafts[here.draft].faces[here.draft_face].across = side_of.at(beyond);
  }
  return edit.topology().replace({}, drafts);
}

// Makes triangles between two rims. Both have their end on the left. Step by step, the shorter of two diagonals is
// taken.
void add_strip(ComplexEdit& edit, const FaceSet& a, const FaceSet& b, Patch patch, Filling& filling) {
  std::vector<Vertex> rim_a;
  std::vector<Vertex> rim_b;
  for (const Dart d : a.rim()) rim_a.push_back(a.from(d));
  for (const Dart d : b.rim()) rim_b.push_back(b.from(d));
  std::reverse(rim_b.begin(), rim_b.end());
  const auto distance = [&](Vertex u, Vertex v) { return norm(edit.position(u) - edit.position(v)); };
  const auto nearest = std::min_element(
      rim_b.begin(), rim_b.end(), [&](Vertex u, Vertex v) { return distance(rim_a[0], u) < distance(rim_a[0], v); });
  std::rotate(rim_b.begin(), nearest, rim_b.end());
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < rim_a.size() || j < rim_b.size()) {
    const Vertex u = rim_a[i % rim_a.size()];
    const Vertex v = rim_b[j % rim_b.size()];
    const Vertex next_u = rim_a[(i + 1) % rim_a.size()];
    const Vertex next_v = rim_b[(j + 1) % rim_b.size()];
    const bool along_a = j == rim_b.size() || (i < rim_a.size() && distance(next_u, v) <= distance(u, next_v));
    filling.add_side({u, along_a ? next_u : next_v, v}, patch);
    ++(along_a ? i : j);
  }
}

std::vector<Cell> bridge(ComplexEdit& edit, const FaceSet& a, const FaceSet& b, Patch side) {
  const CombinatorialMap& map = edit.map();
  const Cell first = a.faces()[0].cell;
  Filling filling(map, map.is_free(first), map.source(first));
  for (const FaceSet* end : {&a, &b}) {
    for (const CellFace& f : end->faces()) {
      if (map.is_free(f.cell) != map.is_free(first))
        detail::refuse(map, f.cell,
                       "is at an end with both free and blocked cells that does not match the other: reconnect lumen "
                       "and tissue apart");
      filling.add_against(f, [&](Dart d) { return end->across(d).valid(); });
    }
  }
  add_strip(edit, a, b, side, filling);
  const CellDraft drafts[] = {std::move(filling.draft)};
  return edit.topology().replace({}, drafts);
}

void check(const CombinatorialMap& map, std::span<const CellFace> a, std::span<const CellFace> b,
           const ReconnectOptions& options) {
  if (!(options.tolerance >= 0.0))
    throw InvalidArgument("the tolerance of reconnecting is a share that is not negative");
  if (options.side.value >= map.patch_names().size()) throw InvalidArgument("there is no such patch for the sides");
  const std::set<CellFace> in_a(a.begin(), a.end());
  if (std::any_of(b.begin(), b.end(), [&](const CellFace& f) { return in_a.contains(f); }))
    throw InvalidArgument("the two ends to reconnect have a face in common");
}

}  // namespace

Reconnected reconnect(ComplexEdit& edit, std::span<const CellFace> a, std::span<const CellFace> b,
                      const ReconnectOptions& options) {
  detail::expect_space(edit.map(), "vessels to reconnect");
  check(edit.map(), a, b, options);
  return detail::all_or_nothing(edit, [&] {
    const FaceSet end_a(edit.map(), a);
    const FaceSet end_b(edit.map(), b);
    const auto matching = detail::match(edit, end_a, end_b);
    if (!matching) return Reconnected{Reconnection::bridged, bridge(edit, end_a, end_b, options.side), 0.0};
    const Gap gap = gap_of(edit, end_a, end_b, *matching);
    if (gap.share <= options.tolerance)
      return Reconnected{Reconnection::sewn, sew_all(edit, end_a, *matching), gap.distance};
    return Reconnected{Reconnection::paired, fill_pairs(edit, end_a, end_b, *matching, options.side), 0.0};
  });
}

}  // namespace dartcast
