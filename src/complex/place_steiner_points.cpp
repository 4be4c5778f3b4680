// Gives Steiner points to the cells that an edit made.
#include "complex/place_steiner_points.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "complex/cone_point.hpp"
#include "dartcast/validity.hpp"
#include "topology/rework.hpp"

namespace dartcast {

namespace {

using CornerNumbers = std::vector<std::uint32_t>;

CornerNumbers corners_of(const DraftFace& face) {
  CornerNumbers corners;
  corners.reserve(face.corners.size());
  for (const DraftCorner& c : face.corners) corners.push_back(c.vertex.value);
  return corners;
}

CornerNumbers corners_of(const CellDraft& draft) {
  CornerNumbers corners;
  corners.reserve(6 * draft.faces.size());
  for (const DraftFace& face : draft.faces) {
    for (const DraftCorner& c : face.corners) corners.push_back(c.vertex.value);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

// Weights that are about equal powers of two with sum 1. In a plane of constant coordinates of few digits they put the
// point exactly there.
double face_weight(std::size_t corners, std::size_t corner) {
  const std::size_t whole = std::bit_ceil(corners);
  return (corner < whole - corners ? 2.0 : 1.0) / static_cast<double>(whole);
}

std::vector<double> face_weights(std::size_t corners) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < corners; ++i) weights.push_back(face_weight(corners, i));
  return weights;
}

bool may_be_straight(const DraftFace& face) {
  return std::any_of(face.corners.begin(), face.corners.end(), [](const DraftCorner& c) { return c.straight; });
}

class SteinerPlacer {
 public:
  SteinerPlacer(Transaction& t, std::span<const Vec3> positions) : transaction_(t), positions_(positions), rework_(t) {}

  PlacedSteinerPoints give() {
    for (const Cell c : transaction_.added()) {
      if (needs_point(c)) take(c);
    }
    for (std::size_t i = 0; i < taken_.size(); ++i) choose_face_points(taken_[i]);
    for (const CellFace f : faces_) add_face_point(f);
    for (const Cell c : taken_) add_cell_point(rework_.draft(c));
    return {std::move(weights_), put()};
  }

 private:
  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }

  std::vector<std::pair<Cell, Cell>> put() {
    std::vector<std::pair<Cell, Cell>> replaced;
    if (taken_.empty()) return replaced;
    const std::vector<Cell> now = rework_.put();
    for (std::size_t i = 0; i < taken_.size(); ++i) replaced.emplace_back(taken_[i], now[i]);
    std::sort(replaced.begin(), replaced.end());
    return replaced;
  }

  [[nodiscard]] bool needs_point(Cell c) const {
    const auto& faces = map().shape(c).key().faces;
    return map().has_flat(c) || std::any_of(faces.begin(), faces.end(), [](const auto& f) { return f.has_point; }) ||
           check_cell(map(), positions_, c);
  }

  void take(Cell c) {
    if (!cells_.insert(c).second) return;
    taken_.push_back(c);
    rework_.take(c);
  }

  // A face is named once, by the lower of its cells.
  void choose_face_points(Cell c) {
    if (map().dimension() == 2) return;
    const std::uint32_t number = rework_.take(c);
    const Vec3 mean = detail::mean(positions_, corners_of(rework_.draft(number)));
    for (std::uint16_t f = 0; f < rework_.draft(number).faces.size(); ++f) {
      const DraftFace& face = rework_.draft(number).faces[f];
      if (face.point.valid() || face.corners.size() == 3) continue;
      if (!may_be_straight(face) && !asks_for_point(face, mean)) continue;
      const CellFace here{c, f};
      const CellFace there = map().opposite(here);
      faces_.insert(there.valid() ? std::min(here, there) : here);
      if (there.valid()) take(there.cell);
    }
  }

  [[nodiscard]] bool asks_for_point(const DraftFace& face, const Vec3& mean) const {
    const CornerNumbers corners = corners_of(face);
    return !detail::all_positive(mean, detail::fan(positions_, corners)) &&
           detail::all_positive(mean, detail::fan(positions_, corners, face_point(corners)));
  }

  void add_face_point(CellFace f) {
    const CornerNumbers corners = corners_of(rework_.draft(f.cell).faces[f.face]);
    const Vertex point = add_vertex(corners, face_weights(corners.size()));
    points_[point.value] = face_point(corners);
    rework_.draft(f.cell).faces[f.face].point = point;
    if (const CellFace other = map().opposite(f); other.valid())
      rework_.draft(other.cell).faces[other.face].point = point;
  }

  void add_cell_point(CellDraft& draft) {
    std::vector<detail::ConeTriangle> triangles;
    for (const DraftFace& face : draft.faces) {
      const CornerNumbers corners = corners_of(face);
      if (corners.size() == 2) {
        triangles.push_back(detail::upright(positions_[corners[0]], positions_[corners[1]]));
        continue;
      }
      std::optional<Vec3> point;
      if (face.point.valid()) point = position(face.point);
      detail::add_fan(triangles, corners, point, [&](std::uint32_t v) { return positions_[v]; });
    }
    const CornerNumbers corners = corners_of(draft);
    draft.point = add_vertex(corners, detail::cone_weights(positions_, corners, triangles));
  }

  [[nodiscard]] Vec3 face_point(const CornerNumbers& corners) const {
    Vec3 sum;
    for (std::size_t i = 0; i < corners.size(); ++i) sum += positions_[corners[i]] * face_weight(corners.size(), i);
    return sum;
  }

  [[nodiscard]] Vec3 position(Vertex v) const {
    const auto made = points_.find(v.value);
    return made == points_.end() ? positions_[v.value] : made->second;
  }

  Vertex add_vertex(const CornerNumbers& corners, const std::vector<double>& weights) {
    const Vertex corner(corners.front());
    const Vertex v = transaction_.add_vertex(corner, corner);
    weights_.add(v, corners, weights);
    return v;
  }

  Transaction& transaction_;
  std::span<const Vec3> positions_;
  detail::Rework rework_;
  std::set<Cell> cells_;
  std::vector<Cell> taken_;  // the same, in the order found
  std::set<CellFace> faces_;
  std::map<std::uint32_t, Vec3> points_;  // of faces, made here
  SteinerWeights weights_;
};

}  // namespace

PlacedSteinerPoints place_steiner_points(Transaction& t, std::span<const Vec3> positions) {
  return SteinerPlacer(t, positions).give();
}

}  // namespace dartcast
