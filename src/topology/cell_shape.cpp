// Makes a shape from its key: darts, fans, simplices and what lies across their facets.
#include "dartcast/cell_shape.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "dartcast/error.hpp"
#include "topology/exit_table.hpp"
#include "topology/key_table.hpp"

namespace dartcast {

namespace {

bool is_polygon(const ShapeKey& key) { return !key.faces.empty() && key.faces.front().corners.size() == 2; }

// Throws if the edges are not one cycle of distinct corners in their order.
void check_polygon(const ShapeKey& key) {
  std::vector<bool> seen(key.corner_count);
  for (std::size_t f = 0; f < key.faces.size(); ++f) {
    const auto& edge = key.faces[f].corners;
    const auto& next = key.faces[(f + 1) % key.faces.size()].corners;
    if (edge.size() != 2 || next.size() != 2 || edge[1] != next[0])
      throw InvalidMesh("the edges of the cell do not close");
    if (key.faces[f].has_point) throw InvalidArgument("an edge of a polygon has a Steiner point: it has none");
    if (edge[0] >= key.corner_count || seen[edge[0]]) throw InvalidMesh("the cell has a corner twice");
    seen[edge[0]] = true;
  }
  if (key.faces.size() < 3) throw InvalidMesh("the cell has fewer than three corners");
}

// Throws if a face is not a cycle of distinct corners, a number names no corner, or there are too many darts.
void check_key(const ShapeKey& key) {
  if (is_polygon(key)) check_polygon(key);
  std::size_t darts = 0;
  std::vector<std::size_t> last(key.corner_count, 0);  // face that had the corner last, from 1
  for (std::size_t f = 0; f < key.faces.size(); ++f) {
    bool distinct = key.faces[f].corners.size() >= 3 || is_polygon(key);
    for (const std::uint16_t corner : key.faces[f].corners) {
      distinct = distinct && corner < key.corner_count && last[corner] != f + 1;
      if (distinct) last[corner] = f + 1;
    }
    if (!distinct) throw InvalidMesh("a face of the cell has fewer than three distinct corners");
    darts += is_polygon(key) ? 1 : key.faces[f].corners.size();
  }
  if (darts > Shape::max_darts) throw InvalidMesh("the cell has more than 16383 darts: split it");
  if (key.apex >= key.corner_count) throw InvalidArgument("the apex of the cell is none of its corners");
  if (std::find(last.begin(), last.end(), 0) != last.end())
    throw InvalidArgument("a corner of the cell is in none of its faces: each below corner_count must be");
}

// One number for three numbers in any order.
std::uint64_t facet_key(std::array<std::uint16_t, 3> t) {
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  if (t[1] > t[2]) std::swap(t[1], t[2]);
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return (std::uint64_t{t[0]} << 32U) | (std::uint64_t{t[1]} << 16U) | t[2];
}

// The first of several threads keeps its table. Those of the others are equal.
template <class T>
const T& keep_first(std::atomic<const T*>& kept, std::unique_ptr<const T> made) {
  const T* first = nullptr;
  if (!kept.compare_exchange_strong(first, made.get(), std::memory_order_acq_rel)) return *first;
  return *made.release();
}

}  // namespace

Shape::Shape(ShapeKey key) : key_(std::move(key)) {
  check_key(key_);
  dimension_ = is_polygon(key_) ? 2 : 3;
  face_count_ = static_cast<std::uint16_t>(key_.faces.size());
  point_count_ = key_.corner_count;
  for (const auto& face : key_.faces)
    point_count_ = static_cast<std::uint16_t>(point_count_ + (face.has_point ? 1 : 0));
  if (key_.has_point) ++point_count_;
  number_darts();
  number_points_of_faces();
  if (dimension_ == 2) {
    make_triangles();
    return;
  }
  sew_darts();
  make_simplices();
  connect_simplices();
}

void Shape::number_darts() {
  std::size_t darts = 0;
  for (const auto& face : key_.faces) darts += face.corners.size();
  origin_.reserve(darts);
  face_of_.reserve(darts);
  first_dart_.reserve(key_.faces.size() + 1);
  first_dart_.push_back(0);
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    const auto& corners = key_.faces[f].corners;
    const std::size_t darts_of_face = dimension_ == 2 ? 1 : corners.size();
    origin_.insert(origin_.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(darts_of_face));
    face_of_.insert(face_of_.end(), darts_of_face, f);
    first_dart_.push_back(static_cast<std::uint16_t>(origin_.size()));
  }
  first_dart_at_.assign(key_.corner_count + 2U, 0);
  for (const std::uint16_t corner : origin_) ++first_dart_at_[corner + 2U];
  std::partial_sum(first_dart_at_.begin(), first_dart_at_.end(), first_dart_at_.begin());
  darts_at_.resize(origin_.size());
  for (std::uint16_t d = 0; d < origin_.size(); ++d) darts_at_[first_dart_at_[origin_[d] + 1U]++] = d;
}

void Shape::number_points_of_faces() {
  if (point_count_ > 64) return;
  std::uint16_t point = key_.corner_count;
  for (const ShapeKey::Face& face : key_.faces) {
    std::uint64_t mask = 0;
    for (const std::uint16_t corner : face.corners) mask |= std::uint64_t{1} << corner;
    if (face.has_point) mask |= std::uint64_t{1} << point++;
    points_of_face_.push_back(mask);
  }
}

void Shape::sew_darts() {
  const auto ends = [](std::uint16_t a, std::uint16_t b) { return (std::uint64_t{a} << 16U) | b; };
  detail::KeyTable by_ends(dart_count());
  for (std::uint16_t d = 0; d < dart_count(); ++d) {
    std::uint32_t& dart = by_ends[ends(origin_[d], origin_[phi1(d)])];
    if (dart != detail::KeyTable::none) throw InvalidMesh("two faces of the cell run the same way along an edge");
    dart = d;
  }
  phi2_.resize(dart_count());
  for (std::uint16_t d = 0; d < dart_count(); ++d) {
    const std::uint32_t other = by_ends.find(ends(origin_[phi1(d)], origin_[d]));
    if (other == detail::KeyTable::none)
      throw InvalidMesh("the faces of the cell do not close: an edge has only one face");
    phi2_[d] = static_cast<std::uint16_t>(other);
  }
}

std::uint16_t Shape::face_of_point(std::uint16_t point) const {
  std::uint16_t next = key_.corner_count;
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    if (key_.faces[f].has_point && next++ == point) return f;
  }
  return face_count();
}

std::array<std::uint16_t, 3> Shape::triangle(std::uint16_t face, std::uint16_t t) const {
  const auto& corners = key_.faces[face].corners;
  if (dimension_ == 2) return {corners[0], corners[1], corners[1]};
  if (!key_.faces[face].has_point) return {corners[0], corners[t + 1U], corners[t + 2U]};
  std::uint16_t point = key_.corner_count;
  for (std::uint16_t f = 0; f < face; ++f)
    point = static_cast<std::uint16_t>(point + (key_.faces[f].has_point ? 1 : 0));
  return {point, corners[t], corners[(t + 1U) % corners.size()]};
}

void Shape::make_simplices() {
  const std::uint16_t apex = key_.has_point ? static_cast<std::uint16_t>(point_count_ - 1) : key_.apex;
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    for (std::uint16_t t = 0; t < triangle_count(f); ++t) {
      const auto [a, b, c] = triangle(f, t);
      if (a != apex && b != apex && c != apex) simplices_.push_back({{apex, a, b, c}, {}});
    }
  }
}

// The fan of a polygon: one triangle after another around the apex.
void Shape::make_triangles() {
  const std::uint16_t apex = key_.has_point ? static_cast<std::uint16_t>(point_count_ - 1) : key_.apex;
  const std::uint16_t n = face_count();
  entries_.resize(n);
  std::uint16_t first = 0;  // the edge that follows the apex
  if (!key_.has_point) {
    while (origin_[first] != apex) ++first;
  }
  const auto edge = [&](unsigned k) { return static_cast<std::uint16_t>((first + k) % n); };
  const unsigned skipped = key_.has_point ? 0 : 1;  // edges beside the apex, at each end
  const unsigned count = n - 2 * skipped;
  for (unsigned i = 0; i < count; ++i) {
    const std::uint16_t f = edge(i + skipped);
    const auto& ends = key_.faces[f].corners;
    const auto number = static_cast<std::uint16_t>(i);
    const auto neighbour = [&](unsigned j, std::uint16_t place) {
      return Across{static_cast<std::uint16_t>(j % count), place};
    };
    const auto outer = [](std::uint16_t face) {
      return Across{static_cast<std::uint16_t>(Across::outer_bit | face), 0};
    };
    ImplicitSimplex s{{apex, ends[0], ends[1], ends[1]}, {}};
    s.across[0] = outer(f);
    s.across[1] = skipped == 1 && i + 1 == count ? outer(edge(n - 1)) : neighbour(i + 1, 2);
    s.across[2] = skipped == 1 && i == 0 ? outer(edge(0)) : neighbour(i + count - 1, 1);
    for (std::uint16_t facet = 0; facet < 3; ++facet) {
      if (s.across[facet].outer()) entries_[s.across[facet].face()] = {number, facet};
    }
    simplices_.push_back(s);
  }
  for (std::uint16_t f = 0; f < n; ++f) first_entry_.push_back(f);
}

void Shape::connect_simplices() {
  constexpr std::uint32_t none = detail::KeyTable::none;
  detail::KeyTable open(3 * simplices_.size());  // facets without their other side yet: simplex 16, facet 16
  std::size_t waiting = 0;
  for (std::uint16_t s = 0; s < simplices_.size(); ++s) {
    for (std::uint16_t i = 0; i < 4; ++i) {
      const auto& v = simplices_[s].vertex;
      std::uint32_t& other = open[facet_key({v[i == 0 ? 1 : 0], v[i < 2 ? 2 : 1], v[i < 3 ? 3 : 2]})];
      if (other == none) {
        other = (std::uint32_t{s} << 16U) | i;
        ++waiting;
        continue;
      }
      const Across across{static_cast<std::uint16_t>(other >> 16U), static_cast<std::uint16_t>(other & 0xffffU)};
      simplices_[s].across[i] = across;
      simplices_[across.index].across[across.place] = {s, i};
      other = none;
      --waiting;
    }
  }
  first_entry_.reserve(face_count());
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    first_entry_.push_back(static_cast<std::uint16_t>(entries_.size()));
    for (std::uint16_t t = 0; t < triangle_count(f); ++t) {
      std::uint32_t& behind = open[facet_key(triangle(f, t))];
      if (behind == none) return make_flat();
      const Across across{static_cast<std::uint16_t>(behind >> 16U), static_cast<std::uint16_t>(behind & 0xffffU)};
      entries_.push_back(across);
      simplices_[across.index].across[across.place] = {static_cast<std::uint16_t>(Across::outer_bit | f), t};
      behind = none;
      --waiting;
    }
  }
  if (waiting > 0) make_flat();
}

// One simplex without extent, entered by every triangle. Nothing can be in it, and no walk continues from it.
void Shape::make_flat() {
  simplices_.assign(1, ImplicitSimplex{{key_.apex, key_.apex, key_.apex, key_.apex}, {}});
  first_entry_.clear();
  entries_.clear();
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    first_entry_.push_back(static_cast<std::uint16_t>(entries_.size()));
    entries_.insert(entries_.end(), triangle_count(f), Across{});
  }
}

bool Shape::is_on_face(std::uint16_t point, std::uint16_t face) const {
  if (point >= key_.corner_count) return face_of_point(point) == face;
  const auto darts = darts_at(point);
  return std::any_of(darts.begin(), darts.end(), [&](std::uint16_t d) { return face_of_[d] == face; });
}

Shape::Feature Shape::feature(std::span<const std::uint16_t> points) const {
  const Feature inside = {static_cast<Kind>(dimension_), 0};
  if (points.size() == dimension_ + 1) return inside;
  if (points.size() == 1 && points[0] < key_.corner_count) return {Kind::vertex, darts_at(points[0]).front()};
  const auto corner = std::find_if(points.begin(), points.end(), [&](auto p) { return p < key_.corner_count; });
  if (corner == points.end()) {
    const std::uint16_t f = face_of_point(points[0]);
    return points.size() == 1 && f < face_count() ? Feature{Kind::face, first_dart_[f]} : inside;
  }
  const std::uint16_t other = points[*corner == points[0] ? points.size() - 1 : 0];
  for (const std::uint16_t d : darts_at(*corner)) {  // in the order of faces
    if (points.size() == 2 && origin_[phi1(d)] == other) return {Kind::edge, d};
    if (points.size() == 2 && origin_[phi_1(d)] == other) return {Kind::edge, phi_1(d)};
    const auto on_face = [&](std::uint16_t p) { return p == *corner || is_on_face(p, face_of_[d]); };
    if (dimension_ == 3 && std::all_of(points.begin(), points.end(), on_face))
      return {Kind::face, first_dart_[face_of_[d]]};
  }
  return inside;
}

bool Shape::is_flat() const { return simplices_[0].vertex[0] == simplices_[0].vertex[1]; }

Shape::~Shape() {
  delete stars_.load(std::memory_order_acquire);
  delete exits_.load(std::memory_order_acquire);
}

const Stars& Shape::make_stars() const {
  const bool none = dimension_ == 2 || is_flat();
  return keep_first<Stars>(stars_, none ? std::make_unique<Stars>() : std::make_unique<Stars>(simplices_, fans()));
}

const detail::ExitTable& Shape::make_exits() const {
  return keep_first<detail::ExitTable>(exits_, std::make_unique<detail::ExitTable>(*this));
}

Stars::Fans Shape::fans() const {
  Stars::Fans fans;
  fans.triangles.reserve(entries_.size());
  fans.first.assign(first_entry_.begin(), first_entry_.end());
  fans.first.push_back(static_cast<std::uint32_t>(entries_.size()));
  for (std::uint16_t f = 0; f < face_count(); ++f) {
    for (std::uint16_t t = 0; t < triangle_count(f); ++t) fans.triangles.push_back(triangle(f, t));
  }
  return fans;
}

// Without stars and exits, which walks make on demand: which ranks make them depends on where their particles are.
std::size_t Shape::bytes() const {
  return sizeof(Shape) + (dart_count() * 5U + key_.corner_count) * sizeof(std::uint16_t) +
         points_of_face_.size() * sizeof(std::uint64_t) + simplices_.size() * sizeof(ImplicitSimplex) +
         entries_.size() * sizeof(Across);
}

}  // namespace dartcast
