#include "bench/paper_scheme.hpp"

#include <algorithm>
#include <utility>

#include "bench/paper_steps.hpp"

namespace dartcast::bench {

namespace {

// Where a forecast turns in sections 5.1 to 5.3: around a face, from edge to edge.
struct AroundFace {
  static std::uint16_t next(const Shape& s, std::uint16_t dart) { return s.phi1(dart); }
  static std::uint16_t previous(const Shape& s, std::uint16_t dart) { return s.phi_1(dart); }
  static std::uint16_t d1(const Shape& s, std::uint16_t dart) { return s.origin(dart); }
  static std::uint16_t d2(const Shape& s, std::uint16_t dart) { return s.origin(s.phi1(dart)); }
};

// And in section 5.4: around the origin of the dart, from face to face of the cell.
struct AroundVertex {
  static std::uint16_t next(const Shape& s, std::uint16_t dart) { return s.phi1(s.phi2(dart)); }
  static std::uint16_t previous(const Shape& s, std::uint16_t dart) { return s.phi2(s.phi_1(dart)); }
  static std::uint16_t d1(const Shape& s, std::uint16_t dart) { return s.origin(s.phi_1(dart)); }
  static std::uint16_t d2(const Shape& s, std::uint16_t dart) { return s.origin(s.phi1(dart)); }
};

}  // namespace

// The step of one particle from p to q. Functions that return bool say whether the step goes on, in state k.
class PaperWalk : public PaperPath<PaperState> {
 public:
  using PaperPath::PaperPath;

  PaperResult step();
  PaperResult step_after_move();
  void aim_in_cell(Cell cell);

 private:
  bool in_volume();
  bool in_face();
  bool in_edge();
  bool along_edge();
  bool in_vertex();
  bool along_face_of_vertex();
  bool cross_face();
  bool aim_from(Dart from);
  bool enter_face(Dart i);
  [[nodiscard]] bool is_flat() const;

  template <class Around>
  std::uint16_t turn(const CellView& c, std::uint16_t dart, const Vec3& axis);
  [[nodiscard]] double beyond(Dart i) const;
  [[nodiscard]] Vec3 point_of_face(const CellView& c, std::uint16_t face) const;
  [[nodiscard]] Vec3 centre(const CellView& c) const;

  [[nodiscard]] Vec3 at(const CellView& c, std::uint16_t local) const { return x_[c.vertex(local).value]; }
};

PaperResult PaperWalk::step() {
  bool goes_on = true;
  while (goes_on && !too_long()) {
    switch (s_.k) {
      case Kind::volume: goes_on = in_volume(); break;
      case Kind::face: goes_on = in_face(); break;
      case Kind::edge: goes_on = in_edge(); break;
      case Kind::vertex: goes_on = in_vertex(); break;
    }
  }
  if (goes_on) end(PaperEnd::error);
  return result_;
}

// Section 6.1: the particle's place in the cell is no longer known, so its way starts from a point that is in it.
PaperResult PaperWalk::step_after_move() {
  const Vec3 from = s_.p;
  const CellView c = map_.view(s_.i.cell);
  s_.p = centre(c);
  s_.sp = point_of_face(c, c.shape().face_of(s_.i.number));
  s_.k = Kind::volume;
  step();
  if (result_.end != PaperEnd::collision || s_.k != Kind::face) return result_;
  const Vec3 normal = cross(d1(s_.i) - s_.sp, d2(s_.i) - s_.sp);
  const double before = dot(normal, from - s_.sp);
  result_.time = share_to(before, dot(normal, q_ - s_.sp));
  if (before < 0.0) s_.p = from + (q_ - from) * result_.time;
  return result_;
}

// Section 5.1: the tetrahedron (p, sp, d1, d2) with p as its apex that holds the way to q; then its base.
bool PaperWalk::in_volume() {
  const CellView c = map_.view(s_.i.cell);
  const Shape& shape = c.shape();
  std::uint16_t n = s_.i.number;
  Vec3 a, b;
  for (;; n = shape.phi2(n), s_.sp = point_of_face(c, shape.face_of(n))) {
    n = turn<AroundFace>(c, n, s_.sp - s_.p);
    a = at(c, AroundFace::d1(shape, n));
    b = at(c, AroundFace::d2(shape, n));
    if (test(dot(cross(a - s_.p, b - s_.p), q_ - s_.p)) >= 0) break;
    if (too_long()) return end(PaperEnd::error);
  }
  s_.i.number = n;
  const Vec3 normal = cross(a - s_.sp, b - s_.sp);
  const double outside = dot(normal, q_ - s_.sp);
  const int side = test(outside);
  if (side < 0) return arrive();
  go(share_to(dot(normal, s_.p - s_.sp), outside));
  if (side > 0) return cross_face();
  s_.k = Kind::face;
  return true;
}

// Section 5.2: off the face to one side, or in its plane to one of its edges. Half-planes contain the face's normal.
bool PaperWalk::in_face() {
  const CellView c = map_.view(s_.i.cell);
  const Vec3 normal = cross(d1(s_.i) - s_.sp, d2(s_.i) - s_.sp);
  const int side = test(dot(normal, q_ - s_.sp));
  if (side > 0) return cross_face();
  if (side < 0) return aim_from(s_.i);
  const Vec3 axis = normal * (1.0 / std::sqrt(norm(normal)));  // about as long as an edge, as the tolerance expects
  s_.i.number = turn<AroundFace>(c, s_.i.number, axis);
  const Vec3 a = d1(s_.i);
  const Vec3 outwards = cross(d2(s_.i) - a, axis);
  const double outside = dot(outwards, q_ - a);
  if (test(outside) < 0) return arrive();
  go(share_to(dot(outwards, s_.p - a), outside));
  s_.k = Kind::edge;
  return true;
}

// Section 5.3: turns around the edge to the cell, between two of its faces, that holds the way to q.
bool PaperWalk::in_edge() {
  Dart i = s_.i;
  int near = test(beyond(i));
  int far = test(beyond(map_.phi2(i)));
  if (near <= 0 && far > 0) {
    i = map_.phi2(i);
    std::swap(near, far);
  }
  CellFace wall;
  while (near > 0 || (near == 0 && !map_.is_free(i.cell))) {
    if (map_.is_free(i.cell)) wall = map_.face(i);
    const Dart across = map_.phi3(i);
    if (!across.valid()) return collide(wall);
    if (too_long()) return end(PaperEnd::error);
    i = map_.phi2(across);
    far = -near;
    near = test(beyond(i));
  }
  if (!map_.is_free(i.cell)) return collide(wall);
  s_.i = i;
  if (near == 0 && far == 0) return along_edge();
  if (near == 0) return enter_face(i);
  if (far == 0) return enter_face(map_.phi2(i));
  return aim_from(i);
}

// Section 5.3: q is on the edge's line.
bool PaperWalk::along_edge() {
  const Vec3 a = d1(s_.i);
  const Vec3 b = d2(s_.i);
  const int after_a = test(dot(q_ - a, b - a) * norm(b - a));
  const int before_b = test(dot(b - q_, b - a) * norm(b - a));
  if (after_a > 0 && before_b > 0) return arrive();
  const Vec3 vertex = after_a > 0 ? b : a;
  const double way = norm(q_ - s_.p);
  if (way > 0.0) left_ *= 1.0 - std::min(1.0, norm(vertex - s_.p) / way);
  s_.p = vertex;
  if (after_a > 0) s_.i = map_.phi1(s_.i);
  s_.k = Kind::vertex;
  return true;
}

// Section 5.4: the dual of 5.1. Turns around the vertex within a cell, sp at its centre, then jumps to the next cell.
bool PaperWalk::in_vertex() {
  if (q_ == s_.p) return arrive();
  Dart i = s_.i;
  CellFace wall;
  for (;;) {
    const CellView c = map_.view(i.cell);
    s_.sp = centre(c);
    i.number = turn<AroundVertex>(c, i.number, s_.sp - s_.p);
    const Vec3 a = at(c, AroundVertex::d1(c.shape(), i.number));
    const Vec3 b = at(c, AroundVertex::d2(c.shape(), i.number));
    const int above = test(dot(cross(a - s_.p, b - s_.p), q_ - s_.p));
    const Dart across = map_.phi3(i);
    const bool next_is_free = across.valid() && map_.is_free(across.cell);
    if (above > 0 || (above == 0 && (c.is_free() || !next_is_free))) {
      if (!c.is_free()) return collide(wall);
      s_.i = i;
      return above > 0 ? aim_from(i) : along_face_of_vertex();
    }
    if (c.is_free()) wall = map_.face(i);
    if (!across.valid()) return collide(wall);
    if (too_long()) return end(PaperEnd::error);
    i = map_.phi1(across);
  }
}

// Section 5.4: q is in the plane of the face of i, so perhaps on one of its two edges at the vertex.
bool PaperWalk::along_face_of_vertex() {
  const Vec3 side = cross(q_ - s_.p, s_.sp - s_.p);
  const Dart before = map_.phi_1(s_.i);
  const bool on_before = test(dot(d1(before) - s_.p, side)) == 0;
  if (!on_before && test(dot(d2(s_.i) - s_.p, side)) != 0) return enter_face(s_.i);
  if (on_before) s_.i = before;
  s_.k = Kind::edge;
  return true;
}

// Into the next cell; a collision where it can't be reached.
bool PaperWalk::cross_face() {
  s_.k = Kind::face;
  const CellFace f = map_.face(s_.i);
  return map_.view(f.cell).is_wall(f.face) ? collide(f) : aim_from(map_.phi3(s_.i));
}

// Section 5.2: from p on the face of `from` into its cell, aiming at the first adjacent face that does not make a flat
// tetrahedron.
bool PaperWalk::aim_from(Dart from) {
  const CellView c = map_.view(from.cell);
  const Shape& shape = c.shape();
  s_.k = Kind::volume;
  std::uint16_t n = from.number;
  do {
    s_.i = {from.cell, shape.phi2(n)};
    s_.sp = point_of_face(c, shape.face_of(s_.i.number));
    ++result_.tests;
    if (!is_flat()) return true;
    n = shape.phi1(n);
  } while (n != from.number);
  return end(PaperEnd::error);
}

// The forecast there is, where it is in the cell, else the first that is not flat.
void PaperWalk::aim_in_cell(Cell cell) {
  const CellView c = map_.view(cell);
  const std::uint16_t count = c.shape().dart_count();
  const std::uint16_t first = s_.i.cell == cell ? s_.i.number : std::uint16_t{0};
  s_.k = Kind::volume;
  for (std::uint16_t k = 0; k < count; ++k) {
    s_.i = {cell, static_cast<std::uint16_t>((first + k) % count)};
    s_.sp = point_of_face(c, c.shape().face_of(s_.i.number));
    if (!is_flat()) return;
  }
}

bool PaperWalk::is_flat() const { return dot(cross(s_.sp - s_.p, d1(s_.i) - s_.p), d2(s_.i) - s_.p) <= tolerance_; }

// From an edge or a vertex at which i starts or ends; p must not be on the edge that is aimed at first.
bool PaperWalk::enter_face(Dart i) {
  s_.k = Kind::face;
  s_.i = map_.phi1(i);
  s_.sp = point_of_face(map_.view(i.cell), map_.face(i).face);
  return true;
}

// Turns until q is between the half-planes that start at the axis through p and contain d1 and d2. The first test
// decides which way.
template <class Around>
std::uint16_t PaperWalk::turn(const CellView& c, std::uint16_t dart, const Vec3& axis) {
  const Shape& shape = c.shape();
  const Vec3 normal = cross(q_ - s_.p, axis);
  const auto side = [&](std::uint16_t corner) { return test(dot(normal, at(c, corner) - s_.p)); };
  if (side(Around::d1(shape, dart)) < 0) {
    do dart = Around::previous(shape, dart);
    while (side(Around::d1(shape, dart)) < 0 && !too_long());
  } else {
    while (side(Around::d2(shape, dart)) > 0 && !too_long()) dart = Around::next(shape, dart);
  }
  return dart;
}

// Positive where q is beyond the plane of the edge and the face of i.
double PaperWalk::beyond(Dart i) const {
  const Vec3 sp = point_of_face(map_.view(i.cell), map_.face(i).face);
  return dot(cross(d1(i) - sp, d2(i) - sp), q_ - sp);
}

// Section 5.1: the barycentre of a triangle, else the middle of the first diagonal whose vertices are not aligned.
Vec3 PaperWalk::point_of_face(const CellView& c, std::uint16_t face) const {
  const Shape& shape = c.shape();
  const int first = shape.first_dart(face);
  const int n = shape.degree(face);
  const auto corner = [&](int k) { return at(c, shape.origin(static_cast<std::uint16_t>(first + k % n))); };
  if (n == 3) return (corner(0) + corner(1) + corner(2)) * (1.0 / 3.0);
  int k = 0;
  const auto aligned = [&] {
    const Vec3 u = corner(k + 1) - corner(k);
    const Vec3 v = corner(k + 2) - corner(k);
    const Vec3 w = cross(u, v);
    return dot(w, w) <= 1e-24 * dot(u, u) * dot(v, v);
  };
  while (k + 1 < n && aligned()) ++k;
  return (corner(k) + corner(k + 2)) * 0.5;
}

Vec3 PaperWalk::centre(const CellView& c) const {
  Vec3 sum;
  for (std::uint16_t v = 0; v < c.shape().corner_count(); ++v) sum += at(c, v);
  return sum * (1.0 / c.shape().corner_count());
}

double mean_edge(const CellComplex& complex) {
  const CombinatorialMap& map = complex.map();
  double sum = 0.0;
  std::size_t count = 0;
  for (const Cell cell : map.cells()) {
    const CellView c = map.view(cell);
    const auto at = [&](std::uint16_t dart) { return complex.positions()[c.vertex(c.shape().origin(dart)).value]; };
    for (std::uint16_t n = 0; n < c.shape().dart_count(); ++n, ++count) sum += norm(at(c.shape().phi1(n)) - at(n));
  }
  return sum / static_cast<double>(count);
}

template class PaperSchemeOf<PaperState, PaperWalk>;

}  // namespace dartcast::bench
