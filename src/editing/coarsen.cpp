// Merges the parts of a subdivided cell again: the inverse of subdivide().
#include <algorithm>
#include <optional>

#include "dartcast/map_edits.hpp"
#include "dartcast/remeshing.hpp"
#include "topology/rework.hpp"

namespace dartcast {

using detail::around_edge;
using detail::refuse;
using detail::Rework;

namespace {

bool has_corner(const DraftFace& face, Vertex v) {
  return std::any_of(face.corners.begin(), face.corners.end(), [&](const DraftCorner& c) { return c.vertex == v; });
}

std::size_t faces_at(const std::vector<DraftFace>& faces, Vertex v) {
  return static_cast<std::size_t>(
      std::count_if(faces.begin(), faces.end(), [&](const DraftFace& f) { return has_corner(f, v); }));
}

// Whether exactly two faces have the vertex, and remain faces without it.
bool may_drop(const std::vector<DraftFace>& faces, Vertex v) {
  return faces_at(faces, v) == 2 && std::all_of(faces.begin(), faces.end(), [&](const DraftFace& f) {
           return f.corners.size() > 3 || !has_corner(f, v);
         });
}

void drop(std::vector<DraftFace>& faces, Vertex v) {
  for (DraftFace& face : faces) {
    auto& corners = face.corners;
    const auto at = std::find_if(corners.begin(), corners.end(), [&](const DraftCorner& c) { return c.vertex == v; });
    if (at == corners.end()) continue;
    DraftCorner& before = at == corners.begin() ? corners.back() : *(at - 1);
    before.coplanar = before.coplanar || at->coplanar;
    corners.erase(at);
    face.point = {};
  }
}

// The corners of the one face that all faces around a vertex form together; empty if they form none. The face is
// straight where two of them met.
std::optional<std::vector<DraftCorner>> joined_around(const std::vector<DraftFace>& faces, Vertex middle) {
  std::vector<std::vector<DraftCorner>> around;
  for (const DraftFace& f : faces) {
    if (!has_corner(f, middle)) continue;
    std::vector<DraftCorner> corners = f.corners;
    std::rotate(corners.begin(),
                std::find_if(corners.begin(), corners.end(), [&](const auto& c) { return c.vertex == middle; }),
                corners.end());
    around.push_back(std::move(corners));
  }
  std::vector<DraftCorner> ring;
  std::size_t at = 0;
  for (std::size_t n = 0; n < around.size(); ++n) {
    ring.insert(ring.end(), around[at].begin() + 1, around[at].end() - 1);
    ring[ring.size() - (around[at].size() - 2)].straight = true;
    const Vertex last = around[at].back().vertex;
    at = static_cast<std::size_t>(
        std::find_if(around.begin(), around.end(), [&](const auto& corners) { return corners[1].vertex == last; }) -
        around.begin());
    if (at == around.size() || (at == 0) != (n + 1 == around.size())) return {};
  }
  std::vector<Vertex> vertices;
  for (const DraftCorner& c : ring) vertices.push_back(c.vertex);
  std::sort(vertices.begin(), vertices.end());
  const bool distinct = std::adjacent_find(vertices.begin(), vertices.end()) == vertices.end();
  if (ring.size() < 3 || !distinct) return {};
  return ring;
}

// Replaces one of the faces around the vertex by the ring, and removes the others.
void join(std::vector<DraftFace>& faces, Vertex middle, CellFace kept, std::vector<DraftCorner> ring) {
  const auto first = std::find_if(faces.begin(), faces.end(), [&](const DraftFace& f) { return f.from == kept; });
  first->corners = std::move(ring);
  first->point = {};
  std::erase_if(faces, [&](const DraftFace& f) { return has_corner(f, middle); });
}

class Coarsener {
 public:
  Coarsener(ComplexEdit& edit, const Subdivision& s)
      : subdivision_(s), map_(edit.map()), rework_(edit.topology()), whole_(rework_.add({})) {}

  std::vector<Cell> coarsen() {
    find_parts();
    put_together();
    for (const Vertex v : subdivision_.face_middles) merge_faces_around(v);
    for (const Vertex v : subdivision_.edge_middles) merge_edges_at(v);
    return rework_.put();
  }

 private:
  [[nodiscard]] bool has_vertex(Cell c, Vertex v) const {
    const auto corners = map_.view(c).vertices().first(map_.shape(c).corner_count());
    return std::find(corners.begin(), corners.end(), v.value) != corners.end();
  }

  [[nodiscard]] bool has_vertex(CellFace f, Vertex v) const {
    const CellView view = map_.view(f.cell);
    const auto corners = view.shape().corners(f.face);
    return std::any_of(corners.begin(), corners.end(), [&](std::uint16_t k) { return view.vertex(k) == v; });
  }

  [[nodiscard]] bool is_part(Cell c) const { return std::find(parts_.begin(), parts_.end(), c) != parts_.end(); }

  // All cells around the middle: one for each corner.
  void find_parts() {
    const Cell first = subdivision_.part.cell;
    if (!map_.contains(subdivision_.part) || !has_vertex(first, subdivision_.middle))
      throw InvalidArgument(
          "coarsen: the part that the subdivision names is not there: call update_after_edit() on it after each edit");
    parts_ = {first};
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (std::uint16_t f = 0; f < map_.shape(parts_[i]).face_count(); ++f) {
        const Cell other = map_.view(parts_[i]).neighbour(f);
        if (!has_vertex(CellFace{parts_[i], f}, subdivision_.middle)) continue;
        if (!other.valid()) refuse(map_, first, "is a part of a cell of which others were removed");
        if (!is_part(other)) parts_.push_back(other);
      }
    }
    const bool complete = std::all_of(subdivision_.corners.begin(), subdivision_.corners.end(), [&](Vertex v) {
      return std::count_if(parts_.begin(), parts_.end(), [&](Cell c) { return has_vertex(c, v); }) == 1;
    });
    if (!complete) refuse(map_, first, "is a part of a cell of which others were cut or merged: coarsen these first");
    for (const Cell c : parts_) {
      if (map_.is_free(c) != map_.is_free(first))
        refuse(map_, first, "is a part of a cell of which not all are free or all blocked: mark them alike first");
    }
  }

  // Faces of two parts that meet on the outside may lie in one plane.
  void put_together() {
    CellDraft whole;
    for (const Cell c : parts_) {
      CellDraft part = draft_of(map_, c);
      const Shape& s = map_.shape(c);
      whole.free = part.free;
      whole.source = part.source;
      rework_.only_remove(c);
      for (std::uint16_t f = 0; f < part.faces.size(); ++f) {
        if (has_corner(part.faces[f], subdivision_.middle)) continue;
        for (std::uint16_t k = 0; k < part.faces[f].corners.size(); ++k) {
          const std::uint16_t beyond = s.face_of(s.phi2(static_cast<std::uint16_t>(s.first_dart(f) + k)));
          if (has_corner(part.faces[beyond], subdivision_.middle)) part.faces[f].corners[k].coplanar = true;
        }
        whole.faces.push_back(part.faces[f]);
      }
    }
    rework_.draft(whole_) = std::move(whole);
  }

  // Merges the faces around a vertex in the middle of a side. It does so if there is at most one cell beyond them, and
  // no other cell needs them.
  void merge_faces_around(Vertex v) {
    std::vector<const DraftFace*> around;
    for (const DraftFace& f : rework_.draft(whole_).faces) {
      if (has_corner(f, v)) around.push_back(&f);
    }
    if (around.empty()) return;
    const DraftFace first = *around[0];
    for (const DraftFace* f : around) {
      if (f->across.face.cell != first.across.face.cell || f->patch != first.patch) return;
    }
    auto ring = joined_around(rework_.draft(whole_).faces, v);
    if (!ring) return;
    if (const Cell other = first.across.face.cell; other.valid()) {
      if (is_part(other)) return;
      const std::vector<DraftFace> there =
          rework_.taken(other) ? rework_.draft(other).faces : draft_of(map_, other).faces;
      auto mirrored = joined_around(there, v);
      if (!mirrored || mirrored->size() != ring->size()) return;
      join(rework_.draft(other).faces, v, first.across.face, std::move(*mirrored));
    }
    join(rework_.draft(whole_).faces, v, first.from, std::move(*ring));
  }

  // Merges the two edges at a vertex, if no cell has more edges there.
  void merge_edges_at(Vertex v) {
    if (!may_drop(rework_.draft(whole_).faces, v)) return;
    std::vector<Cell> others;
    for (const Dart d : around_edge(map_, outer_dart_at(v))) {
      if (is_part(d.cell)) continue;
      if (!may_drop(rework_.taken(d.cell) ? rework_.draft(d.cell).faces : draft_of(map_, d.cell).faces, v)) return;
      others.push_back(d.cell);
    }
    for (const Cell c : others) drop(rework_.draft(c).faces, v);
    drop(rework_.draft(whole_).faces, v);
  }

  // The parts along one of the two remaining edges at the vertex.
  [[nodiscard]] Dart outer_dart_at(Vertex v) {
    for (const DraftFace& f : rework_.draft(whole_).faces) {
      const auto at = std::find_if(f.corners.begin(), f.corners.end(), [&](const auto& c) { return c.vertex == v; });
      if (at == f.corners.end()) continue;
      const Vertex next = at + 1 == f.corners.end() ? f.corners.front().vertex : (at + 1)->vertex;
      for (const Cell c : parts_) {
        if (const Dart d = find_dart(map_, c, v, next); d.valid()) return d;
      }
    }
    return {};
  }

  const Subdivision& subdivision_;
  const CombinatorialMap& map_;
  Rework rework_;
  std::uint32_t whole_;  // number of the draft
  std::vector<Cell> parts_;
};

}  // namespace

std::vector<Cell> coarsen(ComplexEdit& edit, const Subdivision& subdivision) {
  return Coarsener(edit, subdivision).coarsen();
}

}  // namespace dartcast
