// The search for walls near a sphere or an element, cell by cell through the faces that it reaches.
#include "dynamics/near_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "complex/simplex.hpp"
#include "dartcast/predicates.hpp"
#include "dynamics/reached_faces.hpp"

namespace dartcast {

namespace {

// Boxes are widened by more than their rounding.
constexpr double box_margin = 0x1p-50;

Vec3 normal_of_wall(const std::array<Vec3, 3>& v, bool plane) {  // to the free side
  const Vec3 e = v[1] - v[0];
  const Vec3 n = plane ? Vec3{-e.y, e.x, 0.0} : cross(v[2] - v[0], e);
  const double length = norm(n);
  return length > 0.0 ? n * (1.0 / length) : Vec3{};
}

// Vertices of the wall's nearest feature, sorted; the missing ones of an edge or a vertex are invalid.
std::array<Vertex, 3> key_of(const NearWall& w, const NearestOnTriangle& nearest) {
  std::array<Vertex, 3> key;
  for (unsigned i = 0; i < 3; ++i) {
    if (((nearest.corners >> i) & 1U) != 0) key[i] = w.vertex[i];
  }
  std::sort(key.begin(), key.end());
  return key;
}

// Whether a wall that has all these vertices has another corner towards which the way leads nearer to the centre, by
// more than rounding. The way starts at `point`, a place of these vertices. If it leads nearer by less, the same place
// of another wall is beside it, no farther away than `same_place`.
bool goes_nearer(const NearWall& w, const std::array<Vertex, 3>& key, const Vec3& point, const Vec3& centre,
                 double same_place) {
  const auto is_in = [](Vertex v, const std::array<Vertex, 3>& list) {
    return std::find(list.begin(), list.end(), v) != list.end();
  };
  if (!std::all_of(key.begin(), key.end(), [&](Vertex v) { return !v.valid() || is_in(v, w.vertex); })) return false;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3 way = w.corners.to[i] - point;
    if (!is_in(w.vertex[i], key) && dot(way, centre - point) > norm(way) * same_place) return true;
  }
  return false;
}

// The points of the cell that span a face.
template <class Visit>
void for_each_point(const Shape& shape, std::uint16_t face, Visit&& visit) {
  const std::uint16_t first = shape.first_dart(face);
  if (shape.dimension() == 2 || shape.triangle_count(face) == shape.degree(face)) {  // or has a Steiner point
    for (std::uint16_t t = 0; t < shape.triangle_count(face); ++t) {
      for (const std::uint16_t p : shape.triangle(face, t)) visit(p);
    }
    return;
  }
  for (std::uint16_t d = 0; d < shape.degree(face); ++d) visit(shape.origin(static_cast<std::uint16_t>(first + d)));
}

}  // namespace

double touching_slack(const Vec3& centre, double radius) {
  return touching_bound * (radius + std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}));
}

// The space that a sphere or an element sweeps: a box, and where that is much too large, also a tube around a segment.
//
// For a point's way both are in a frame that moves about as the vertices there, so that they are small if all move
// together. The frame moves straight, so ways in it are straight, too. Any shift is right.
struct NearWalls::Reach {
  struct Bounds {
    Vec3 low;
    Vec3 high;

    void include(const Vec3& p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void widen(double by) {
      low = low - Vec3{by, by, by};
      high = high + Vec3{by, by, by};
    }
    [[nodiscard]] bool meets(const Bounds& b) const {
      return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y && low.z <= b.high.z &&
             b.low.z <= high.z;
    }
  };

  Bounds box;
  Vec3 shift;            // of the frame
  bool is_long = false;  // whether the tube counts
  // Cells are looked at without the tube up to this number: most ways of points reach few.
  std::size_t without_tube = 0;
  Vec3 begin;           // of the tube's segment
  Vec3 way;             // to the segment's end
  double radius = 0.0;  // of the tube

  explicit Reach(const MovingSphere& s) : box{s.from, s.from}, begin(s.from), way(s.to - s.from) {
    box.include(s.to);
    radius = s.radius + rounding() + box_margin * s.radius;
    box.widen(radius);
    is_long = norm(way) > 2.0 * radius;
  }
  // A point.
  Reach(const Vec3& from, const Vec3& to, const Vec3& frame)
      : box{from, from}, shift(frame), without_tube(8), begin(from), way(to - frame - from) {
    box.include(to - frame);
    radius = rounding();
    box.widen(radius);
    is_long = true;
  }
  // A point's tube is around its way. An edge's is around the edge at the time 1/2. No point of the edge is ever
  // farther from its place then than half the largest displacement of the ends. A triangle has none.
  Reach(const MovingElement& e, double margin) : box{e.from[0], e.from[0]} {
    double farthest = 0.0;
    for (unsigned i = 0; i < e.count; ++i) {
      box.include(e.from[i]);
      box.include(e.to[i]);
      farthest = std::max(farthest, norm(e.to[i] - e.from[i]));
    }
    const double r = margin + rounding() + box_margin * margin;
    radius = e.count == 1 ? r : r + 0.5 * farthest * (1.0 + 0x1p-20);
    begin = e.count == 1 ? e.from[0] : (e.from[0] + e.to[0]) * 0.5;
    if (e.count < 3) way = (e.count == 1 ? e.to[0] : (e.from[1] + e.to[1]) * 0.5) - begin;
    box.widen(r);
    is_long = norm(way) > 2.0 * radius;
  }
  explicit Reach(const Box& b) : box{b.low, b.high} { box.widen(rounding()); }
  [[nodiscard]] double rounding() const {
    const Vec3 largest = extent_of(box.low, box.high);
    return box_margin * std::max({largest.x, largest.y, largest.z});
  }
  static Bounds nothing() {
    constexpr double far = std::numeric_limits<double>::infinity();
    return {{far, far, far}, {-far, -far, -far}};
  }
  [[nodiscard]] bool meets(const Bounds& b, std::size_t cells) const {
    if (!box.meets(b)) return false;
    if (!is_long || cells < without_tube) return true;
    const Vec3 middle = (b.low + b.high) * 0.5;
    const double share = std::clamp(dot(middle - begin, way) / dot(way, way), 0.0, 1.0);
    const double apart = norm(middle - (begin + way * share));
    return !(apart > (radius + 0.5 * norm(b.high - b.low)) * (1.0 + 0x1p-20));
  }
};

// The corners before and after the last move; both as they are now where `before` is `after`.
NearWall NearWalls::wall_at(const CellView& cell, CellFace face, std::uint16_t triangle, std::span<const Vec3> before,
                            std::span<const Vec3> after) {
  NearWall wall;
  wall.face = face;
  wall.triangle = triangle;
  wall.local = cell.shape().triangle(face.face, triangle);
  for (unsigned i = 0; i < 3; ++i) {
    wall.vertex[i] = cell.vertex(wall.local[i]);
    wall.corners.from[i] = before[wall.vertex[i].value];
    wall.corners.to[i] = after[wall.vertex[i].value];
  }
  return wall;
}

// Else the wall belongs to a cell that is invalid, or was before the move.
bool NearWalls::is_in_range(const NearWall& wall) {
  const auto all_are = [](const std::array<Vec3, 3>& corners) {
    return std::all_of(corners.begin(), corners.end(), in_exact_range);
  };
  return all_are(wall.corners.from) && all_are(wall.corners.to);
}

void NearWalls::grow() {
  table_.assign(std::max<std::size_t>(64, table_.size() * 2), 0);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    slots_[i] = slot(cells_[i]);
    table_[slots_[i]] = static_cast<std::uint32_t>(i + 1);
  }
}

// The slot of a cell in the table, or the free one that it would take.
std::size_t NearWalls::slot(Cell c) const {
  std::size_t at = (c.value * 0x9e3779b97f4a7c15U) >> 32U;
  for (;; ++at) {
    at &= table_.size() - 1;
    if (table_[at] == 0 || cells_[table_[at] - 1] == c) return at;
  }
}

void NearWalls::add(Cell c) {
  if (2 * (cells_.size() + 1) > table_.size()) grow();
  const std::size_t at = slot(c);
  if (table_[at] != 0) return;
  cells_.push_back(c);
  slots_.push_back(at);
  table_[at] = static_cast<std::uint32_t>(cells_.size());
}

void NearWalls::add_walls(const CellComplex& complex, const Reach& reach, CellFace face, const VertexMotion& motion) {
  const CellView cell = complex.map().view(face.cell);
  for (std::uint16_t t = 0; t < cell.shape().triangle_count(face.face); ++t) {
    const NearWall wall = wall_at(cell, face, t, motion.before, motion.after);
    Reach::Bounds bounds{wall.corners.from[0], wall.corners.from[0]};
    for (unsigned i = 0; i < 3; ++i) {
      bounds.include(wall.corners.from[i]);
      bounds.include(wall.corners.to[i] - reach.shift);
    }
    if (is_in_range(wall) && reach.meets(bounds, cells_.size())) walls_.push_back(wall);
  }
}

// Every way from one cell to the other passes their face, so the search passes only faces that the reach meets. The
// box of a face misses the reach's if all points of the face lie beyond one side of it.
void NearWalls::visit(const CellComplex& complex, const Reach& reach, Cell c, const VertexMotion& motion) {
  const CellView cell = complex.map().view(c);
  const Shape& shape = cell.shape();
  if (motion.places != nullptr) motion.places->reach(cell.vertices());
  const Vec3* after = motion.after.data();
  const Vec3* before = motion.before.data();
  const bool few = shape.point_count() <= 64 && shape.face_count() <= 64;
  const std::uint64_t reached = few ? detail::reached_faces(shape, cell.vertices().data(), before, after,
                                                            {reach.box.low, reach.box.high, reach.shift})
                                    : ~std::uint64_t{0};
  const bool by_tube = reach.is_long && cells_.size() >= reach.without_tube;
  for (std::uint16_t f = 0; f < shape.face_count(); ++f) {
    if (few && ((reached >> f) & 1U) == 0) continue;
    if (!few || by_tube) {
      Reach::Bounds bounds = Reach::nothing();
      for_each_point(shape, f, [&](std::uint16_t p) {
        bounds.include(after[cell.vertex(p).value] - reach.shift);
        bounds.include(before[cell.vertex(p).value]);
      });
      if (!reach.meets(bounds, cells_.size())) continue;
    }
    if (cell.is_wall(f))
      add_walls(complex, reach, {c, f}, motion);
    else
      add(cell.neighbour(f));
  }
}

std::span<const NearWall> NearWalls::run(const CellComplex& complex, std::span<const Cell> starts, const Reach& reach,
                                         const VertexMotion& motion) {
  for (const std::size_t at : slots_) table_[at] = 0;
  slots_.clear();
  cells_.clear();
  walls_.clear();
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (i == 0 || starts[i] != starts[i - 1]) add(starts[i]);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (i + 1 < cells_.size()) prefetch_cell(complex, cells_[i + 1], motion);
    visit(complex, reach, cells_[i], motion);
  }
  return walls_;
}

std::span<const NearWall> NearWalls::search(const CellComplex& complex, Cell cell, const MovingSphere& sphere,
                                            bool moving) {
  const auto after = complex.positions();
  return run(complex, {&cell, 1}, Reach(sphere), {moving ? complex.previous_positions() : after, after});
}

std::span<const NearWall> NearWalls::search(const CellComplex& complex, Cell cell, const MovingElement& element,
                                            const VertexMotion& motion, double margin) {
  return run(complex, {&cell, 1}, Reach(element, margin), motion);
}

std::span<const NearWall> NearWalls::search_way(const CellComplex& complex, Cell cell, const Vec3& from, const Vec3& to,
                                                const VertexMotion& motion) {
  const auto vertices = complex.map().view(cell).vertices();
  if (motion.places != nullptr) motion.places->reach(vertices);
  Vec3 shift;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min<std::size_t>(4, vertices.size()); ++i) {  // the least: one may be far away
    const Vec3 moved = motion.after[vertices[i]] - motion.before[vertices[i]];
    const double size = std::max({std::abs(moved.x), std::abs(moved.y), std::abs(moved.z)});
    if (!(size < least)) continue;
    least = size;
    shift = moved;
  }
  return run(complex, {&cell, 1}, Reach(from, to, shift), motion);
}

std::span<const NearWall> NearWalls::search(const CellComplex& complex, std::span<const Cell> starts, const Box& box,
                                            const VertexMotion& motion) {
  return run(complex, starts, Reach(box), motion);
}

std::span<const NearestOnTriangle> NearWalls::nearest(const Vec3& centre) {
  nearest_.clear();
  for (const NearWall& w : walls_) nearest_.push_back(nearest_on_triangle(w.corners.from, centre));
  return nearest_;
}

void NearWalls::describe(const CellComplex& complex, const NearWall& wall, const NearestOnTriangle& nearest, bool moved,
                         WallFeature& feature) {
  feature.point = nearest.point;
  feature.normal =
      nearest.distance > 0.0 ? nearest.normal : normal_of_wall(wall.corners.to, complex.map().dimension() == 2);
  feature.distance = nearest.distance;
  feature.face = wall.face;
  feature.triangle = wall.triangle;
  feature.patch = complex.map().patch(wall.face);
  feature.displacement = {};
  std::array<std::uint16_t, 3> points{};
  std::size_t count = 0;
  for (unsigned i = 0; i < 3; ++i) {
    if (((nearest.corners >> i) & 1U) == 0) continue;
    points[count++] = wall.local[i];
    const std::size_t v = wall.vertex[i].value;
    const Vec3& before = complex.previous_positions()[v];
    const Vec3& now = complex.positions()[v];
    // As wall_displacement() in tracking/contact_geometry.hpp.
    if (moved && in_exact_range(before) && in_exact_range(now) && std::isfinite(nearest.weights[i]))
      feature.displacement += (now - before) * nearest.weights[i];
  }
  const Shape::Feature place =
      complex.map().shape(wall.face.cell).feature(std::span<const std::uint16_t>(points).first(count));
  feature.kind = place.kind;
  feature.dart = {wall.face.cell, place.dart};
}

WallFeature NearWalls::place_on(const CellComplex& complex, CellFace face, std::uint16_t triangle, const Vec3& centre,
                                bool moved) {
  const auto positions = complex.positions();
  const NearWall wall = wall_at(complex.map().view(face.cell), face, triangle, positions, positions);
  WallFeature feature;
  describe(complex, wall, nearest_on_triangle(wall.corners.to, centre), moved, feature);
  return feature;
}

std::span<const WallFeature> NearWalls::within(const CellComplex& complex, Cell cell, const Vec3& centre, double reach,
                                               bool moved) {
  search(complex, cell, {centre, centre, reach}, false);
  nearest(centre);
  features_.clear();
  keys_.clear();
  const double same_place = touching_slack(centre, reach);
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    if (!(nearest_[i].distance <= reach)) continue;
    const auto key = key_of(walls_[i], nearest_[i]);
    if (std::find(keys_.begin(), keys_.end(), key) != keys_.end()) continue;
    bool nearest_around = true;
    for (std::size_t k = 0; k < walls_.size() && nearest_around; ++k) {
      nearest_around =
          key_of(walls_[k], nearest_[k]) == key || !goes_nearer(walls_[k], key, nearest_[i].point, centre, same_place);
    }
    if (!nearest_around) continue;
    const bool known = std::any_of(features_.begin(), features_.end(), [&](const WallFeature& f) {
      return norm(f.point - nearest_[i].point) <= same_place;
    });
    if (known) continue;
    keys_.push_back(key);
    describe(complex, walls_[i], nearest_[i], moved, features_.emplace_back());
    const auto farther =
        std::upper_bound(features_.begin(), features_.end() - 1, features_.back(),
                         [](const WallFeature& a, const WallFeature& b) { return a.distance < b.distance; });
    std::rotate(farther, features_.end() - 1, features_.end());
  }
  return features_;
}

}  // namespace dartcast
