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
#include "dartcast/predicates.hpp"
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
    take_all(transaction_.added());
    for (const Cell c : taken_) add_cell_point(rework_.draft(c));
    return {std::move(weights_), put()};
  }

  std::vector<Cell> without_cone(std::span<const Cell> cells, bool keep_faces) {
    if (std::all_of(cells.begin(), cells.end(), [&](Cell c) { return mean_sees_all(c); })) return {};
    take_all(cells);
    std::vector<Cell> refused;
    for (const Cell c : taken_) {
      const Cone cone = cone_of(rework_.draft(c));
      Vec3 apex;
      for (std::size_t i = 0; i < cone.corners.size(); ++i) apex += positions_[cone.corners[i]] * cone.weights[i];
      if (!detail::all_positive(apex, cone.triangles) || (keep_faces && bent_.contains(c))) refused.push_back(c);
    }
    std::sort(refused.begin(), refused.end());
    return refused;
  }

 private:
  struct Cone {
    CornerNumbers corners;
    std::vector<double> weights;  // of the apex
    std::vector<detail::ConeTriangle> triangles;
  };

  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }

  void take_all(std::span<const Cell> cells) {
    for (const Cell c : cells) {
      if (needs_point(c)) take(c);
    }
    for (std::size_t i = 0; i < taken_.size(); ++i) choose_face_points(taken_[i]);
    for (const CellFace f : faces_) add_face_point(f);
  }

  // Whether the cell can be coned from the mean of its corners. If all can, no other face will need a point.
  [[nodiscard]] bool mean_sees_all(Cell c) const {
    const CellView v = map().view(c);
    const Shape& s = v.shape();
    if (s.dimension() == 2) return false;
    const auto corners = v.vertices().first(s.corner_count());
    const Vec3 mean = detail::mean(positions_, corners);
    for (std::uint16_t f = 0; f < s.face_count(); ++f) {
      if (!sees_all(mean, c, v, f)) return false;
    }
    return true;
  }

  // A face that may be straight will have a point.
  [[nodiscard]] bool sees_all(const Vec3& x, Cell c, const CellView& v, std::uint16_t f) const {
    const Shape& s = v.shape();
    const auto local = s.corners(f);
    const auto at = [&](std::size_t i) { return positions_[v.vertex(local[i]).value]; };
    bool straight = false;
    for (std::uint16_t d = s.first_dart(f); d < s.first_dart(f) + s.degree(f); ++d)
      straight = straight || map().flat({c, d}).straight;
    Vec3 apex = at(0);
    Vec3 last = at(1);
    const Vertex known = map().point(CellFace{c, f});
    if (known.valid() || straight) {
      last = at(local.size() - 1);
      apex = {};
      for (std::size_t i = 0; i < local.size(); ++i) apex += at(i) * face_weight(local.size(), i);
      if (known.valid()) apex = positions_[known.value];
    }
    for (std::size_t i = known.valid() || straight ? 0 : 2; i < local.size(); ++i) {
      const Vec3 next = at(i);
      if (orient3d(x, apex, last, next) != Sign::positive) return false;
      last = next;
    }
    return true;
  }

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
      if (!may_be_straight(face)) {
        if (!asks_for_point(face, mean)) continue;
        bent_.insert(c);
      }
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
    const Cone cone = cone_of(draft);
    draft.point = add_vertex(cone.corners, cone.weights);
  }

  [[nodiscard]] Cone cone_of(const CellDraft& draft) const {
    Cone cone;
    for (const DraftFace& face : draft.faces) {
      const CornerNumbers corners = corners_of(face);
      if (corners.size() == 2) {
        cone.triangles.push_back(detail::upright(positions_[corners[0]], positions_[corners[1]]));
        continue;
      }
      std::optional<Vec3> point;
      if (face.point.valid()) point = position(face.point);
      detail::add_fan(cone.triangles, corners, point, [&](std::uint32_t v) { return positions_[v]; });
    }
    cone.corners = corners_of(draft);
    cone.weights = detail::cone_weights(positions_, cone.corners, cone.triangles);
    return cone;
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
  std::set<Cell> bent_;                   // cells with a face that needs a point, but is not straight
  std::map<std::uint32_t, Vec3> points_;  // of faces, made here
  SteinerWeights weights_;
};

}  // namespace

PlacedSteinerPoints place_steiner_points(Transaction& t, std::span<const Vec3> positions) {
  return SteinerPlacer(t, positions).give();
}

std::vector<Cell> cells_without_cone(Transaction& t, std::span<const Vec3> positions, std::span<const Cell> cells,
                                     bool keep_faces) {
  return SteinerPlacer(t, positions).without_cone(cells, keep_faces);
}

}  // namespace dartcast
