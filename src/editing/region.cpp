// Regions of cells: their surface, and pyramids that fill it.
#include "editing/region.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "complex/simplex.hpp"

namespace dartcast::detail {

bool is_positive(ComplexEdit& edit, Cell c) {
  const CellView v = edit.map().view(c);
  const auto& simplices = v.shape().simplices();
  return std::all_of(simplices.begin(), simplices.end(), [&](const ImplicitSimplex& s) {
    Corners corners;
    for (unsigned i = 0; i < 4; ++i) corners[i] = edit.position(v.vertex(s.vertex[i]));
    return volume_sign(edit.map().dimension() == 2 ? raised(corners) : corners) == Sign::positive;
  });
}

Star star_of(const CombinatorialMap& map, Cell first, Vertex v, std::size_t limit) {
  Star star{v, {first}, true, false};
  const bool free = map.is_free(first);
  for (std::size_t i = 0; i < star.cells.size(); ++i) {
    const CellView view = map.view(star.cells[i]);
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      const auto corners = view.shape().corners(f);
      if (std::none_of(corners.begin(), corners.end(), [&](std::uint16_t k) { return view.vertex(k) == v; })) continue;
      const Cell other = view.neighbour(f);
      if (!other.valid() || map.is_free(other) != free) {
        star.closed = false;
      } else if (std::find(star.cells.begin(), star.cells.end(), other) == star.cells.end()) {
        if (star.cells.size() == limit) {
          star.too_large = true;
          return star;
        }
        star.cells.push_back(other);
      }
    }
  }
  std::sort(star.cells.begin(), star.cells.end());
  return star;
}

std::vector<Cell> grown(const CombinatorialMap& map, std::span<const Cell> cells) {
  std::vector<Cell> all(cells.begin(), cells.end());
  for (const Cell c : cells) {
    for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
      const Cell other = map.view(c).neighbour(f);
      if (other.valid() && map.is_free(other) == map.is_free(c)) all.push_back(other);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

namespace {

// Orders edges one behind another, from the first one on. If they are not a cycle, the others stay at the end.
void chain(std::vector<DraftFace>& edges) {
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Vertex end = edges[i - 1].corners[1].vertex;
    const auto next = std::find_if(edges.begin() + static_cast<std::ptrdiff_t>(i), edges.end(),
                                   [&](const DraftFace& e) { return e.corners[0].vertex == end; });
    if (next == edges.end()) return;
    std::swap(edges[i], *next);
  }
}

}  // namespace

std::vector<DraftFace> surface_of(const CombinatorialMap& map, std::span<const Cell> cells) {
  std::vector<DraftFace> surface;
  for (const Cell c : cells) {
    for (DraftFace& face : draft_of(map, c).faces) {
      if (!std::binary_search(cells.begin(), cells.end(), face.across.face.cell)) surface.push_back(std::move(face));
    }
  }
  if (map.dimension() == 2) chain(surface);
  return surface;
}

bool bounds_solid(const std::vector<DraftFace>& faces) {
  CellDraft draft;
  draft.faces = faces;
  return form_of(draft, faces.front().corners.size() == 2 ? 2 : 3).defect.empty();
}

std::vector<Vertex> corners_of(std::span<const DraftFace> faces) {
  std::vector<Vertex> corners;
  for (const DraftFace& face : faces) {
    for (const DraftCorner& c : face.corners) corners.push_back(c.vertex);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

std::vector<ConeTriangle> fans_of(std::span<const DraftFace> faces, const Position& position) {
  std::vector<ConeTriangle> triangles;
  for (const DraftFace& face : faces) {
    std::vector<std::uint32_t> corners;
    for (const DraftCorner& c : face.corners) corners.push_back(c.vertex.value);
    if (corners.size() == 2) {
      triangles.push_back(upright(position(Vertex(corners[0])), position(Vertex(corners[1]))));
      continue;
    }
    std::optional<Vec3> point;
    if (face.point.valid()) point = position(face.point);
    add_fan(triangles, corners, point, [&](std::uint32_t v) { return position(Vertex(v)); });
  }
  return triangles;
}

namespace {

std::vector<CellDraft> triangles_on(const CombinatorialMap& map, std::span<const DraftFace> edges, Vertex apex) {
  std::vector<CellDraft> triangles;
  const auto n = static_cast<std::uint32_t>(edges.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    CellDraft& triangle = triangles.emplace_back();
    triangle.free = map.is_free(edges[i].from.cell);
    triangle.source = map.source(edges[i].from.cell);
    triangle.faces.push_back(edges[i]);
    triangle.faces[0].corners[0].straight = false;
    const Vertex u = edges[i].corners[0].vertex;
    const Vertex w = edges[i].corners[1].vertex;
    triangle.faces.push_back({{{w}, {apex}}, {{}, (i + 1) % n, 2}, {}, {}, {}});
    triangle.faces.push_back({{{apex}, {u}}, {{}, (i + n - 1) % n, 1}, {}, {}, {}});
  }
  return triangles;
}

}  // namespace

std::vector<CellDraft> pyramids_on(const CombinatorialMap& map, std::span<const DraftFace> faces, Vertex apex) {
  if (map.dimension() == 2) return triangles_on(map, faces, apex);
  std::vector<CellDraft> pyramids;
  std::map<std::pair<Vertex, Vertex>, DraftLink> side;  // by the edge as the base has it
  for (const DraftFace& base : faces) {
    CellDraft& pyramid = pyramids.emplace_back();
    pyramid.free = map.is_free(base.from.cell);
    pyramid.source = map.source(base.from.cell);
    pyramid.faces.push_back(base);
    for (DraftCorner& c : pyramid.faces[0].corners) c.coplanar = false;
    const std::size_t k = base.corners.size();
    for (std::size_t i = 0; i < k; ++i) {
      const DraftCorner& u = base.corners[i];
      const DraftCorner& w = base.corners[(i + 1) % k];
      side[{u.vertex, w.vertex}] = {
          {}, static_cast<std::uint32_t>(pyramids.size() - 1), static_cast<std::uint16_t>(i + 1)};
      // At a straight corner of the base, the path in which the two sides meet is straight, too.
      DraftFace triangle;
      triangle.corners = {{w.vertex, false, false}, {u.vertex, false, u.straight}, {apex, false, w.straight}};
      pyramid.faces.push_back(std::move(triangle));
    }
  }
  for (CellDraft& pyramid : pyramids) {
    for (std::size_t i = 1; i < pyramid.faces.size(); ++i) {
      const auto& corners = pyramid.faces[i].corners;
      pyramid.faces[i].across = side.at({corners[0].vertex, corners[1].vertex});
    }
  }
  return pyramids;
}

}  // namespace dartcast::detail
