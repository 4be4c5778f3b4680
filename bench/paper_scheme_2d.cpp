#include "bench/paper_scheme_2d.hpp"

#include <algorithm>

#include "bench/paper_steps.hpp"

namespace dartcast::bench {

namespace {

// Positive where b is to the left of a.
double turn_from(const Vec3& a, const Vec3& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

// The step of one particle from p to q. Functions that return bool say whether the step goes on, in state k.
class PaperWalk2D : public PaperPath<PaperState2D> {
 public:
  using PaperPath::PaperPath;

  PaperResult step();
  PaperResult step_after_move();
  void aim_in_cell(Cell cell);

 private:
  bool in_face();
  bool in_edge();
  bool along_edge();
  bool in_vertex();
  bool leave_vertex(Dart i, int after_first, int after_last, CellFace wall);
  bool cross_edge();

  [[nodiscard]] Vec3 at(const CellView& c, std::uint16_t dart) const {
    return x_[c.vertex(c.shape().origin(dart)).value];
  }
  [[nodiscard]] bool is_free(Dart i) const { return i.valid() && map_.is_free(i.cell); }
  // The side of q: 1 to the left of the half-line from p through x.
  int side_of(const Vec3& x) { return test(turn_from(x - s_.p, q_ - s_.p)); }
  bool go_on(Kind k, Dart i) {
    s_.k = k;
    s_.i = i;
    return true;
  }
};

PaperResult PaperWalk2D::step() {
  bool goes_on = true;
  while (goes_on && !too_long())
    goes_on = s_.k == Kind::face ? in_face() : s_.k == Kind::edge ? in_edge() : in_vertex();
  if (goes_on) end(PaperEnd::error);
  return result_;
}

// Section 6.1: the particle's place in the cell is no longer known, so its way starts from a point that is in it.
PaperResult PaperWalk2D::step_after_move() {
  const Vec3 from = s_.p;
  const CellView c = map_.view(s_.i.cell);
  const std::uint16_t corners = c.shape().corner_count();
  Vec3 sum;
  for (std::uint16_t n = 0; n < corners; ++n) sum += at(c, n);
  s_.p = sum * (1.0 / corners);
  s_.k = Kind::face;
  step();
  if (result_.end != PaperEnd::collision || s_.k != Kind::edge) return result_;
  const Vec3 a = d1(s_.i);
  const Vec3 along = d2(s_.i) - a;
  const double before = turn_from(from - a, along);
  result_.time = share_to(before, turn_from(q_ - a, along));
  if (before < 0.0) s_.p = from + (q_ - from) * result_.time;
  return result_;
}

// Orientation: turns around the face to the edge whose angle d1 p d2 holds the way to q; the first test decides which
// way. Displacement: is q before, after or on that edge?
bool PaperWalk2D::in_face() {
  const CellView c = map_.view(s_.i.cell);
  const Shape& shape = c.shape();
  std::uint16_t n = s_.i.number;
  if (side_of(at(c, n)) < 0) {
    do n = shape.phi_1(n);
    while (side_of(at(c, n)) < 0 && !too_long());
  } else {
    while (side_of(at(c, shape.phi1(n))) > 0 && !too_long()) n = shape.phi1(n);
  }
  s_.i.number = n;
  const Vec3 a = at(c, n);
  const Vec3 along = at(c, shape.phi1(n)) - a;
  const double outside = turn_from(q_ - a, along);
  const int side = test(outside);
  if (side < 0) return arrive();
  go(share_to(turn_from(s_.p - a, along), outside));
  s_.k = Kind::edge;
  return side == 0 || cross_edge();
}

// Into one of the two faces, or along the edge.
bool PaperWalk2D::in_edge() {
  const Vec3 a = d1(s_.i);
  const int side = test(turn_from(q_ - a, d2(s_.i) - a));
  if (side == 0) return along_edge();
  return side > 0 ? cross_edge() : go_on(Kind::face, map_.phi1(s_.i));
}

// q is on the edge's line: between its ends, or beyond one of them.
bool PaperWalk2D::along_edge() {
  const Vec3 a = d1(s_.i);
  const Vec3 b = d2(s_.i);
  const int after_a = test(dot(q_ - a, b - a));
  const int before_b = test(dot(b - q_, b - a));
  if (after_a > 0 && before_b > 0) return arrive();
  const Vec3 vertex = after_a > 0 ? b : a;
  const double way = norm(q_ - s_.p);
  if (way > 0.0) left_ *= 1.0 - std::min(1.0, norm(vertex - s_.p) / way);
  s_.p = vertex;
  return go_on(Kind::vertex, after_a > 0 ? map_.phi1(s_.i) : s_.i);
}

// The dual of the face state: turns around the vertex, from face to face, to the one between whose two edges there the
// way to q is. `wall`: where free faces were left last.
bool PaperWalk2D::in_vertex() {
  if (q_ == s_.p) return arrive();
  Dart i = s_.i;
  CellFace wall;
  const auto turn_over = [&](Dart edge) {
    if (map_.is_free(edge.cell)) wall = map_.face(edge);
    i = map_.phi2(edge);
    return i.valid();
  };
  int after_first = side_of(d2(i));
  int after_last = -1;
  if (after_first < 0) {
    while (after_first < 0) {
      if (!turn_over(i)) return collide(wall);
      if (too_long()) return end(PaperEnd::error);
      i = map_.phi1(i);
      after_first = side_of(d2(i));
    }
  } else {
    while ((after_last = side_of(d1(map_.phi_1(i)))) > 0) {
      if (!turn_over(map_.phi_1(i))) return collide(wall);
      if (too_long()) return end(PaperEnd::error);
      after_first = 1;
    }
  }
  return leave_vertex(i, after_first, after_last, wall);
}

// Into the face of i, or along one of its two edges at the vertex; a collision where what is entered is blocked.
bool PaperWalk2D::leave_vertex(Dart i, int after_first, int after_last, CellFace wall) {
  const Dart last = map_.phi_1(i);
  const Dart edge = after_first == 0 && dot(d2(i) - s_.p, q_ - s_.p) > 0.0 ? i : after_last == 0 ? last : Dart{};
  if (edge.valid()) {
    const Dart free_side = is_free(edge) ? edge : map_.phi2(edge);
    return is_free(free_side) ? go_on(Kind::edge, free_side) : collide(wall);
  }
  return is_free(i) ? go_on(Kind::face, map_.phi1(i)) : collide(wall);
}

// Into the next face; a collision where it can't be reached.
bool PaperWalk2D::cross_edge() {
  const CellFace f = map_.face(s_.i);
  if (map_.view(f.cell).is_wall(f.face)) return collide(f);
  return go_on(Kind::face, map_.phi1(map_.phi2(s_.i)));
}

// The forecast there is, where it is in the cell and p not on its edge, else the first such edge.
void PaperWalk2D::aim_in_cell(Cell cell) {
  const CellView c = map_.view(cell);
  const std::uint16_t count = c.shape().dart_count();
  const std::uint16_t first = s_.i.cell == cell ? s_.i.number : std::uint16_t{0};
  s_.k = Kind::face;
  for (std::uint16_t k = 0; k < count; ++k) {
    s_.i = {cell, static_cast<std::uint16_t>((first + k) % count)};
    if (turn_from(d1(s_.i) - s_.p, d2(s_.i) - s_.p) > tolerance_) return;
  }
}

template class PaperSchemeOf<PaperState2D, PaperWalk2D>;

}  // namespace dartcast::bench
