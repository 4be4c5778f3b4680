// Splits drafts of cells by a plane, in three phases:
//  1. a vertex on each edge that the plane crosses, in all cells around the edge;
//  2. an edge in each face that it crosses, on both its sides;
//  3. a face in each cell that it crosses in a simple loop.
#include "editing/plane_cut.hpp"

#include <algorithm>

namespace dartcast::detail {

// A dart of a face above along an edge whose other face is below: where it starts, and its places in the two faces.
struct PlaneCut::RimDart {
  Vertex from, to;
  std::uint16_t face, corner, face_beyond, corner_beyond;
};

std::vector<std::uint32_t> PlaneCut::split(std::span<const std::uint32_t> drafts) {
  put_vertices(drafts);
  for (const std::uint32_t number : drafts) split_faces(number);
  std::vector<std::uint32_t> parts;
  parts.reserve(drafts.size());
  for (const std::uint32_t number : drafts) parts.push_back(split_cell(number));
  return parts;
}

// The cells around an edge are reached through its faces.
void PlaneCut::put_vertices(std::span<const std::uint32_t> drafts) {
  std::vector<std::uint32_t> reached(drafts.begin(), drafts.end());
  std::vector<bool> is_reached(work_.size());
  for (const std::uint32_t number : drafts) is_reached[number] = true;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::uint32_t number = reached[i];
    for (std::uint16_t f = 0; f < work_.draft(number).faces.size(); ++f) {
      if (!put_vertices_on(work_.draft(number).faces[f], i < drafts.size())) continue;
      const FaceOfDraft other = work_.opposite({number, f});
      if (!other.valid()) continue;
      is_reached.resize(work_.size());
      if (!is_reached[other.draft]) reached.push_back(other.draft);
      is_reached[other.draft] = true;
    }
  }
}

// The face may be straight at a new vertex. `make`: whether its cell is split. Others take only vertices that there are.
bool PlaneCut::put_vertices_on(DraftFace& face, bool make) {
  bool changed = false;
  for (std::size_t k = 0; k < face.corners.size(); ++k) {
    const DraftCorner corner = face.corners[k];
    const Vertex next = face.corners[k + 1 < face.corners.size() ? k + 1 : 0].vertex;
    if ((side(corner.vertex) | side(next)) != both_bits) continue;
    const Vertex v = vertex_between(corner.vertex, next, make);
    if (!v.valid()) continue;
    face.corners.insert(face.corners.begin() + static_cast<std::ptrdiff_t>(++k), {v, true, corner.coplanar});
    changed = true;
  }
  if (changed) face.point = {};
  return changed;
}

Vertex PlaneCut::vertex_between(Vertex u, Vertex w, bool make) {
  if (side(u) == above_bit) std::swap(u, w);
  const std::uint64_t ends = (std::uint64_t{u.value} << 32U) | w.value;
  const std::uint32_t known = middle_.find(ends);
  if (known != KeyTable::none || !make) return Vertex(known);
  const Vertex v = edit_.topology().add_vertex(u, w);
  edit_.place(v, sides_.crossing(u, w, plane_));
  sides_.put_on(v, plane_);
  middle_[ends] = v.value;
  return v;
}

namespace {

bool has_edge(const CellDraft& draft, Vertex u, Vertex v) {
  return std::any_of(draft.faces.begin(), draft.faces.end(), [&](const DraftFace& face) {
    Vertex before = face.corners.back().vertex;
    return std::any_of(face.corners.begin(), face.corners.end(),
                       [&](const DraftCorner& c) { return std::exchange(before, c.vertex) == u && c.vertex == v; });
  });
}

}  // namespace

// If an edge of a cell joins the two corners already, the face stays whole. So does the cell then.
void PlaneCut::split_faces(std::uint32_t number) {
  const std::size_t count = work_.draft(number).faces.size();
  for (std::uint16_t f = 0; f < count; ++f) {
    const auto chord = chord_of(work_.draft(number).faces[f]);
    if (!chord) continue;
    const auto [u, v] = *chord;
    const FaceOfDraft other = work_.opposite({number, f});
    if (has_edge(work_.draft(number), u, v) || (other.valid() && has_edge(work_.draft(other.draft), u, v))) continue;
    work_.split_face({number, f}, u, v);
  }
}

// The corners at which to split a face whose rim changes sides twice: next to those above. Nothing for other faces.
std::optional<std::pair<Vertex, Vertex>> PlaneCut::chord_of(const DraftFace& face) const {
  const std::vector<DraftCorner>& corners = face.corners;
  const auto start = std::find_if(corners.begin(), corners.end(), [&](const auto& c) { return side(c.vertex) != 0; });
  if (start == corners.end()) return {};
  const auto first = static_cast<std::size_t>(start - corners.begin());
  const auto at = [&](std::size_t k) { return corners[k % corners.size()].vertex; };
  std::size_t last = first;  // the last corner that was not on the plane
  std::size_t changes = 0;
  std::pair<Vertex, Vertex> ends;
  for (std::size_t k = first + 1; k <= first + corners.size(); ++k) {
    const Side here = side(at(k));
    if (here == 0) continue;
    if (here != side(at(last))) {
      ++changes;
      (here == below_bit ? ends.first : ends.second) = here == below_bit ? at(last + 1) : at(k - 1);
    }
    last = k;
  }
  if (changes != 2) return {};
  return ends;
}

std::uint32_t PlaneCut::split_cell(std::uint32_t number) {
  CellDraft& draft = work_.draft(number);
  if (!choose_faces_above(draft)) return DraftLink::no_draft;
  const std::vector<RimDart> rim = rim_of(draft);
  if (rim.empty()) return DraftLink::no_draft;
  DraftFace cut = face_along(draft, rim);
  for (const RimDart& d : rim) draft.faces[d.face].corners[d.corner].coplanar = false;
  for (const RimDart& d : rim) draft.faces[d.face_beyond].corners[d.corner_beyond].coplanar = false;
  return work_.split_cell(number, is_above_, std::move(cut));
}

// Chooses the faces of the part above: those with a corner above. A face in the plane belongs to it if it looks down,
// because then the cell is above it. Returns false if a face has corners on both sides, or a part has too few faces.
bool PlaneCut::choose_faces_above(const CellDraft& draft) {
  is_above_.clear();
  std::size_t count = 0;
  for (const DraftFace& face : draft.faces) {
    Side all = 0;
    for (const DraftCorner& c : face.corners) all |= side(c.vertex);
    if (all == both_bits) return false;
    is_above_.push_back(all == above_bit || (all == 0 && looks_down(face)) ? 1 : 0);
    count += is_above_.back();
  }
  return count >= 3 && draft.faces.size() - count >= 3;
}

bool PlaneCut::looks_down(const DraftFace& face) const {
  const auto x = [&](std::size_t k) { return edit_.position(face.corners[k].vertex); };
  Vec3 area;
  for (std::size_t k = 1; k + 1 < face.corners.size(); ++k) area += cross(x(k) - x(0), x(k + 1) - x(0));
  return dot(area, sides_.plane(plane_).normal) < 0.0;
}

namespace {

// The same darts one behind another; empty if they are not a simple loop.
template <class Dart>
std::vector<Dart> as_loop(const std::vector<Dart>& darts) {
  std::vector<Dart> loop;
  loop.reserve(darts.size());
  auto next = darts.begin();
  while (next != darts.end() && loop.size() < darts.size()) {
    loop.push_back(*next);
    next = std::find_if(darts.begin(), darts.end(), [&](const Dart& d) { return d.from == loop.back().to; });
    if (next == darts.begin()) break;
  }
  const bool closed = loop.size() == darts.size() && next == darts.begin();
  return closed ? loop : std::vector<Dart>{};
}

}  // namespace

// The rim of the faces above. Empty if it is not a simple loop.
std::vector<PlaneCut::RimDart> PlaneCut::rim_of(const CellDraft& draft) const {
  std::vector<RimDart> on_plane;  // of faces below
  std::vector<RimDart> rim;
  const auto for_each_dart = [&](bool above, auto&& visit) {
    for (std::uint16_t f = 0; f < draft.faces.size(); ++f) {
      if ((is_above_[f] != 0) != above) continue;
      const std::vector<DraftCorner>& corners = draft.faces[f].corners;
      Vertex from = corners.back().vertex;
      auto place = static_cast<std::uint16_t>(corners.size() - 1);
      for (std::uint16_t k = 0; k < corners.size(); place = k++) {
        const Vertex to = corners[k].vertex;
        if (side(from) == 0 && side(to) == 0) visit(RimDart{from, to, f, place, 0, 0});
        from = to;
      }
    }
  };
  for_each_dart(false, [&](const RimDart& d) { on_plane.push_back(d); });
  for_each_dart(true, [&](RimDart d) {
    const auto beyond = std::find_if(on_plane.begin(), on_plane.end(),
                                     [&](const RimDart& other) { return other.from == d.to && other.to == d.from; });
    if (beyond == on_plane.end()) return;
    d.face_beyond = beyond->face;
    d.corner_beyond = beyond->corner;
    rim.push_back(d);
  });
  return as_loop(rim);
}

// The face between the parts, as the part below sees it. At a corner it may be straight where the only face above is, or
// where all faces above may lie in one plane. If it is, those are, because the cell is convex, and so are those below.
DraftFace PlaneCut::face_along(const CellDraft& draft, std::span<const RimDart> rim) const {
  struct FacesAbove {
    std::size_t count = 0;
    bool straight = false;
    bool coplanar = true;
  };
  std::vector<FacesAbove> at(rim.size());
  for (std::uint16_t f = 0; f < draft.faces.size(); ++f) {
    if (is_above_[f] == 0) continue;
    for (std::uint16_t k = 0; k < draft.faces[f].corners.size(); ++k) {
      const DraftCorner& corner = draft.faces[f].corners[k];
      if (side(corner.vertex) != 0) continue;
      const auto out = std::find_if(rim.begin(), rim.end(), [&](const auto& d) { return d.from == corner.vertex; });
      if (out == rim.end()) continue;
      FacesAbove& faces = at[static_cast<std::size_t>(out - rim.begin())];
      ++faces.count;
      faces.straight = corner.straight;
      if (out->face != f) faces.coplanar = faces.coplanar && corner.coplanar;
    }
  }
  DraftFace cut;
  for (std::size_t i = 0; i < rim.size(); ++i)
    cut.corners.push_back({rim[i].from, at[i].count == 1 ? at[i].straight : at[i].coplanar, false});
  return cut;
}

}  // namespace dartcast::detail
