// Subdivides a cell into one part for each corner.
#include <algorithm>

#include "dartcast/remeshing.hpp"
#include "editing/outline.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::around_edge;
using detail::expect_cell;
using detail::Outline;
using detail::Rework;

namespace {

// Adds a vertex between two adjacent corners, in either order.
void put_between(DraftFace& face, Vertex u, Vertex w, Vertex v) {
  const std::size_t k = face.corners.size();
  for (std::size_t i = 0; i < k; ++i) {
    const Vertex a = face.corners[i].vertex;
    const Vertex b = face.corners[(i + 1) % k].vertex;
    if (!(a == u && b == w) && !(a == w && b == u)) continue;
    face.corners.insert(face.corners.begin() + static_cast<std::ptrdiff_t>(i + 1), {v, true, face.corners[i].coplanar});
    face.point = {};
    return;
  }
}

// Splits a face along edges from a new middle to some of its corners. The first part follows the first of these.
std::vector<DraftFace> cut_around(const DraftFace& face, std::span<const Vertex> ends, Vertex middle, bool coplanar) {
  std::vector<DraftCorner> all = face.corners;
  const auto first =
      std::find_if(all.begin(), all.end(), [&](const DraftCorner& c) { return c.vertex == ends.front(); });
  std::rotate(all.begin(), first, all.end());
  all.push_back(all.front());
  std::vector<DraftFace> parts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_end = std::find(ends.begin(), ends.end(), all[i].vertex) != ends.end();
    if (is_end) all[i].straight = false;
    if (is_end && !parts.empty()) {
      parts.back().corners.push_back({all[i].vertex, false, coplanar});
      parts.back().corners.push_back({middle, false, coplanar});
    }
    if (i + 1 == all.size()) break;
    if (is_end) parts.emplace_back().patch = face.patch;
    parts.back().corners.push_back(all[i]);
  }
  return parts;
}

class Subdivider {
 public:
  Subdivider(ComplexEdit& edit, Cell c)
      : edit_(edit),
        map_(edit.map()),
        cell_(c),
        shape_(map_.shape(c)),
        positions_(positions()),
        outline_(map_, c, positions_),
        corners_(outline_.corners()),
        rework_(edit.topology()),
        whole_(draft_of(map_, c)),
        parts_(corners_.size()) {}

  Subdivided subdivide() {
    const std::size_t count = corners_.size();
    for (CellDraft& part : parts_) {
      part.free = whole_.free;
      part.source = whole_.source;
      rework_.add({});
    }
    rework_.only_remove(cell_);
    make_vertices();
    for (std::size_t i = 0; i < outline_.sides().size(); ++i) cut_side(i);
    add_inner_faces();
    for (std::uint32_t i = 0; i < count; ++i) rework_.draft(i) = std::move(parts_[i]);
    Subdivided result;
    result.subdivision = record();
    result.cells = rework_.put();
    result.subdivision.part = map_.handle(result.cells[0]);
    return result;
  }

 private:
  using Side = Outline::Side;

  [[nodiscard]] Vertex vertex(std::uint16_t local) const { return map_.view(cell_).vertex(local); }

  std::vector<Vec3> positions() {
    std::vector<Vec3> positions;
    for (std::uint16_t v = 0; v < shape_.corner_count(); ++v) positions.push_back(edit_.position(vertex(v)));
    return positions;
  }

  [[nodiscard]] std::uint32_t part_at(std::uint16_t corner) const {
    return static_cast<std::uint32_t>(std::lower_bound(corners_.begin(), corners_.end(), corner) - corners_.begin());
  }

  Vertex add_middle(std::span<const std::uint16_t> corners) {
    std::vector<Vertex> of;
    for (const std::uint16_t v : corners) of.push_back(vertex(v));
    const Vertex middle = edit_.topology().add_vertex(of[0], of[1]);
    edit_.place(middle, of, std::vector<double>(of.size(), 1.0 / static_cast<double>(of.size())));
    return middle;
  }

  void make_vertices() {
    const auto& sides = outline_.sides();
    edge_middle_.resize(sides.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
      for (std::size_t j = 0; j < sides[i].edges.size(); ++j) edge_middle_[i].push_back(edge_middle(i, j));
      side_middle_.push_back(sides[i].spokes.empty() ? add_middle(sides[i].corners) : vertex(sides[i].spokes[0][0]));
    }
    middle_ = add_middle(corners_);
  }

  Vertex edge_middle(std::size_t i, std::size_t j) {
    const Side& side = outline_.sides()[i];
    if (side.edge_middles[j] != Outline::none) return vertex(side.edge_middles[j]);
    const std::uint16_t beyond = shape_.phi2(side.edges[j].front());
    if (outline_.side_of(beyond) < i) return edge_middle_[outline_.side_of(beyond)][outline_.edge_of(beyond)];
    return split_edge({cell_, side.edges[j].front()});
  }

  Vertex split_edge(Dart d) {
    const Vertex u = map_.origin(d);
    const Vertex w = map_.origin(map_.phi1(d));
    const Vertex v = edit_.topology().add_vertex(u, w);
    for (const Dart x : around_edge(map_, d)) {
      CellDraft& draft = x.cell == cell_ ? whole_ : rework_.draft(x.cell);
      put_between(draft.faces[map_.face(x).face], u, w, v);
      put_between(draft.faces[map_.face(map_.phi2(x)).face], u, w, v);
    }
    return v;
  }

  void cut_side(std::size_t i) {
    const Side& side = outline_.sides()[i];
    if (side.spokes.empty()) {
      cut_face(i);
      return;
    }
    for (std::size_t k = 0; k < side.faces.size(); ++k) {
      DraftFace face = whole_.faces[side.faces[k]];
      const std::uint16_t first = shape_.first_dart(side.faces[k]);
      for (std::uint16_t c = 0; c < face.corners.size(); ++c) {
        const auto d = static_cast<std::uint16_t>(first + c);
        if (outline_.is_cut(d)) face.corners[c].coplanar = false;
      }
      parts_[part_at(side.corner_of[k])].faces.push_back(std::move(face));
    }
  }

  // A whole face is split on both sides. The neighbour has its corners in opposite order.
  void cut_face(std::size_t i) {
    const Side& side = outline_.sides()[i];
    const CellFace face{cell_, side.faces[0]};
    std::vector<Vertex> ends = edge_middle_[i];
    std::rotate(ends.begin(), ends.end() - 1, ends.end());
    std::vector<DraftFace> pieces = cut_around(whole_.faces[face.face], ends, side_middle_[i], false);
    if (const CellFace other = map_.opposite(face); other.valid()) {
      const std::uint32_t beyond = rework_.take(other.cell);
      std::vector<DraftFace>& faces = rework_.draft(beyond).faces;
      std::vector<DraftFace> mirrored = cut_around(faces[other.face], ends, side_middle_[i], true);
      std::reverse(mirrored.begin(), mirrored.end());
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        const std::uint32_t part = part_at(side.corners[k]);
        const std::size_t place = k == 0 ? other.face : faces.size();
        pieces[k].across = {{}, beyond, static_cast<std::uint16_t>(place)};
        mirrored[k].across = {{}, part, static_cast<std::uint16_t>(parts_[part].faces.size())};
        if (k == 0) {
          faces[place] = std::move(mirrored[k]);
        } else {
          faces.push_back(std::move(mirrored[k]));
        }
      }
    }
    for (std::size_t k = 0; k < pieces.size(); ++k)
      parts_[part_at(side.corners[k])].faces.push_back(std::move(pieces[k]));
  }

  // The faces between the parts at the two ends of each edge.
  void add_inner_faces() {
    const auto& sides = outline_.sides();
    std::vector<std::vector<DraftLink>> place(sides.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
      for (std::size_t j = 0; j < sides[i].edges.size(); ++j) {
        const std::uint32_t part = part_at(sides[i].corners[j]);
        place[i].push_back({{}, part, static_cast<std::uint16_t>(parts_[part].faces.size())});
        parts_[part].faces.push_back(inner_face(i, j));
      }
    }
    for (std::size_t i = 0; i < sides.size(); ++i) {
      for (std::size_t j = 0; j < sides[i].edges.size(); ++j) {
        const std::uint16_t beyond = shape_.phi2(sides[i].edges[j].front());
        const DraftLink& here = place[i][j];
        parts_[here.draft].faces[here.draft_face].across = place[outline_.side_of(beyond)][outline_.edge_of(beyond)];
      }
    }
  }

  // As the part at the edge's start sees it: from the middle of the side out to the edge, and back through the side
  // beyond.
  [[nodiscard]] DraftFace inner_face(std::size_t i, std::size_t j) const {
    const auto& edge = outline_.sides()[i].edges[j];
    const std::uint16_t beyond = shape_.phi2(edge.front());
    DraftFace face;
    face.corners = spoke(i, j);
    std::vector<DraftCorner> back = spoke(outline_.side_of(beyond), outline_.edge_of(beyond));
    const bool one_plane = std::any_of(edge.begin(), edge.end(), [&](std::uint16_t d) {
      return map_.flat({cell_, d}).coplanar || map_.flat({cell_, shape_.phi2(d)}).coplanar;
    });
    face.corners.push_back({edge_middle_[i][j], one_plane, false});
    face.corners.insert(face.corners.end(), back.rbegin(), back.rend());
    face.corners.push_back({middle_});
    return face;
  }

  // From the middle of a side to that of an edge, without the latter.
  [[nodiscard]] std::vector<DraftCorner> spoke(std::size_t i, std::size_t j) const {
    std::vector<DraftCorner> corners = {{side_middle_[i]}};
    const auto& spokes = outline_.sides()[i].spokes;
    if (spokes.empty()) return corners;
    for (std::size_t k = 1; k + 1 < spokes[j].size(); ++k) corners.push_back({vertex(spokes[j][k]), true, false});
    return corners;
  }

  [[nodiscard]] Subdivision record() const {
    Subdivision s;
    s.middle = middle_;
    for (const std::uint16_t v : corners_) s.corners.push_back(vertex(v));
    s.face_middles = side_middle_;
    for (const auto& middles : edge_middle_)
      s.edge_middles.insert(s.edge_middles.end(), middles.begin(), middles.end());
    std::sort(s.edge_middles.begin(), s.edge_middles.end());
    s.edge_middles.erase(std::unique(s.edge_middles.begin(), s.edge_middles.end()), s.edge_middles.end());
    return s;
  }

  ComplexEdit& edit_;
  const CombinatorialMap& map_;
  Cell cell_;
  const Shape& shape_;
  std::vector<Vec3> positions_;
  Outline outline_;
  std::vector<std::uint16_t> corners_;  // a part for each
  Rework rework_;                       // the parts, then the cells around
  CellDraft whole_;                     // with the middles of its edges
  std::vector<CellDraft> parts_;
  std::vector<std::vector<Vertex>> edge_middle_;  // by side and edge
  std::vector<Vertex> side_middle_;
  Vertex middle_;
};

}  // namespace

Subdivided subdivide(ComplexEdit& edit, Cell c) {
  detail::expect_space(edit.map(), "subdivisions");
  expect_cell(edit.map(), c);
  const Transaction::Savepoint before = edit.savepoint();
  try {
    return Subdivider(edit, c).subdivide();
  } catch (...) {
    edit.roll_back(before);
    throw;
  }
}

void update_after_edit(const CombinatorialMap& map, std::span<const Cell> added, Subdivision& subdivision) {
  if (map.contains(subdivision.part)) return;
  for (const Cell c : added) {
    if (!map.contains(c)) continue;
    const auto vertices = map.view(c).vertices().first(map.shape(c).corner_count());
    if (std::find(vertices.begin(), vertices.end(), subdivision.middle.value) == vertices.end()) continue;
    subdivision.part = map.handle(c);
    return;
  }
}

}  // namespace dartcast
