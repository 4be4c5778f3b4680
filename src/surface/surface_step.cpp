// One step on a surface: rays that unfold from triangle to triangle, vertices, walls.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/surface.hpp"
#include "surface/fan.hpp"
#include "surface/unfold.hpp"

namespace dartcast {

namespace {

using detail::Fan;
using detail::FanCorner;
using detail::Frame;
using detail::Heading;
using detail::TriangleWeights;
using detail::Unfolded;

constexpr double pi = std::numbers::pi;

// A direction that is meant to run along a wall, and differs from it by no more than this, runs along it exactly. The
// difference is rounding. Nothing else depends on it.
constexpr double rounding_of_angles = 1e-12;

Heading heading_at(double angle) {
  const SineCosine turned = sine_cosine(angle);
  return {turned.cosine, turned.sine};
}

// The triangle of a particle, laid out on one of its edges, and the particle's direction there.
class Course {
 public:
  Course(const Surface& surface, SurfacePlace& place) : surface_(surface), place_(place) { lay_out(first_base()); }

  [[nodiscard]] const SurfacePlace& place() const { return place_; }
  [[nodiscard]] unsigned base() const { return base_; }
  [[nodiscard]] const Heading& heading() const { return heading_; }
  void head(const Heading& heading) { heading_ = heading; }

  // Weights in the order of the layout: base's start, its end, apex.
  [[nodiscard]] TriangleWeights weights() const {
    const auto& w = place_.weights;
    return {w[base_], w[(base_ + 1) % 3], w[(base_ + 2) % 3]};
  }
  void put(const TriangleWeights& w) {
    for (unsigned i = 0; i < 3; ++i) place_.weights[(base_ + i) % 3] = w[i];
  }

  // Lays the same triangle out on another edge. The heading stays the same in space.
  void turn_to(unsigned base) {
    if (base == base_) return;
    heading_ = detail::turned_to(layout_, (base + 3 - base_) % 3, heading_);
    lay_out(base);
  }

  // Goes to a corner of another triangle, at an angle from its first edge; along its edges exactly.
  void go_to_corner(const FanCorner& to, double angle) {
    place_.triangle = to.triangle;
    place_.weights = {};
    place_.weights[to.corner] = 1.0;
    const bool along_last = angle >= to.angle;
    lay_out(along_last ? (to.corner + 2) % 3 : to.corner);
    heading_ = along_last ? Heading{-1.0, 0.0} : heading_at(angle);
  }

  // Crosses the base: unfolded, the direction is the same. Precondition: the apex's weight is 0.
  void cross_base(const AcrossEdge& across) {
    const TriangleWeights w = weights();
    place_.triangle = across.triangle;
    lay_out((across.edge + 1) % 3);
    put({w[1], w[0], 0.0});
    heading_ = {-heading_.along, std::max(-heading_.across, 0.0)};
  }

  [[nodiscard]] detail::Exit way_out() const {
    detail::Exit exit = detail::way_out(layout_, weights(), heading_);
    exit.length /= layout_.scale;
    return exit;
  }

  [[nodiscard]] AcrossEdge across_base() const { return surface_.across(place_.triangle, (base_ + 2) % 3); }

  [[nodiscard]] Frame frame() const {
    const auto v = surface_.corners(place_.triangle);
    return detail::frame_of(v[base_], v[(base_ + 1) % 3], v[(base_ + 2) % 3]);
  }
  [[nodiscard]] Vec3 in_space(const Heading& h, double length) const {
    const Frame f = frame();
    return (f.along * h.along + f.across * h.across) * length;
  }

  // The base for a particle on a border: the edge, or an edge that starts at the vertex.
  [[nodiscard]] unsigned border_base() const {
    const auto& w = place_.weights;
    const auto at =
        static_cast<unsigned>(place_.kind() == Kind::vertex ? std::max_element(w.begin(), w.end()) - w.begin()
                                                            : std::find(w.begin(), w.end(), 0.0) - w.begin() + 1);
    return at % 3;
  }

 private:
  [[nodiscard]] unsigned first_base() const { return place_.kind() == Kind::face ? 0 : border_base(); }

  void lay_out(unsigned base) {
    const auto v = surface_.corners(place_.triangle);
    base_ = base;
    layout_ = detail::unfold(v[base], v[(base + 1) % 3], v[(base + 2) % 3]);
  }

  const Surface& surface_;
  SurfacePlace& place_;
  unsigned base_ = 0;
  Unfolded layout_;
  Heading heading_;
};

// The dart of the edge, or from the vertex, at the place; invalid on an edge within a polygon.
Dart dart_of(const Surface& surface, const SurfacePlace& place, const AcrossEdge& across) {
  const Shape& shape = surface.map().shape(place.triangle.cell);
  if (place.kind() == Kind::edge)
    return across.face.valid() ? Dart{across.face.cell, shape.first_dart(across.face.face)} : Dart{};
  const auto& w = place.weights;
  const auto corner = static_cast<std::size_t>(std::max_element(w.begin(), w.end()) - w.begin());
  const std::uint16_t local = shape.simplices()[place.triangle.simplex].vertex[corner];
  std::uint16_t dart = 0;
  while (shape.origin(dart) != local) ++dart;
  return {place.triangle.cell, dart};
}

class Stepping {
 public:
  Stepping(const Surface& surface, SurfacePlace& place, const SurfaceOptions& options, const SurfaceTrace& trace,
           std::uint32_t particle)
      : surface_(surface), course_(surface, place), options_(options), trace_(trace), particle_(particle) {}

  SurfaceStep run(const Vec3& displacement, const SurfaceContactCallback& respond) {
    AfterSurfaceContact next{displacement, false};
    while (true) {
      set_out(next.displacement);
      if (left_ == 0.0 || (begin(next.along) && advance())) break;
      const SurfaceContact contact = describe();
      ++result_.contacts;
      if (trace_.contacts != nullptr) trace_.contacts->push_back(contact);
      result_.end = SurfaceEnd::stopped;
      if (!respond || result_.contacts == options_.max_contacts) break;
      next = respond(contact);
      check_displacement(next.displacement);
      result_.end = SurfaceEnd::arrived;
      began_ = now();
    }
    if (result_.length > 0.0 || left_ > 0.0) result_.direction = course_.in_space(course_.heading(), 1.0);
    result_.remaining = result_.direction * left_;
    return result_;
  }

  static void check_displacement(const Vec3& v) {
    const auto in_range = [](double x) { return std::abs(x) <= largest_magnitude; };
    if (!in_range(v.x) || !in_range(v.y) || !in_range(v.z))
      throw InvalidArgument("step: a displacement must be finite, and at most 2^300 along each axis");
  }

 private:
  // Projects a displacement into the plane of the triangle.
  void set_out(const Vec3& displacement) {
    const Frame f = course_.frame();
    const double along = dot(displacement, f.along);
    const double across = dot(displacement, f.across);
    way_ = left_ = hypotenuse(along, across);
    if (left_ == 0.0) return;
    course_.head({along / left_, across / left_});
    set_out_ = f.along * along + f.across * across;
  }

  // Goes from an edge or a vertex to the triangle that the heading points into. False at a wall.
  bool begin(bool along) {
    if (course_.place().kind() == Kind::face) return true;
    course_.turn_to(course_.border_base());
    if (course_.place().kind() == Kind::vertex) return begin_at_vertex(along);
    if (course_.heading().across >= (along ? rounding_of_angles : 0.0)) return true;
    const AcrossEdge across = course_.across_base();
    if (across.wall && !along) return false;
    if (across.wall) {
      course_.head({course_.heading().along < 0.0 ? -1.0 : 1.0, 0.0});
    } else if (course_.heading().across < 0.0) {
      cross(across);
    }
    return true;
  }

  bool begin_at_vertex(bool along) {
    const Fan fan = fan_here();
    const double angle = angle_here();
    const double own = fan.corners[fan.own].angle;
    if (fan.closed) {
      if (angle >= 0.0 && angle <= own) return true;
      const double back = angle > 0.0 ? angle - pi : angle + pi;
      pass(fan, back >= 0.0 && back <= own ? back + fan.total / 2 : angle);
      return true;
    }
    return begin_between_walls(fan, angle, angle >= 0.0 && angle <= own, along);
  }

  // `inside`: whether the angle is in the particle's own triangle.
  bool begin_between_walls(const Fan& fan, double angle, bool inside, bool along) {
    const double half = fan.total / 2;
    double off = angle + fan.before - half;  // from the middle between the walls
    if (!inside) off -= 2 * pi * std::round(off / (2 * pi));
    if (along && std::abs(off) > half - rounding_of_angles) {
      const FanCorner& side = off < 0.0 ? fan.corners.front() : fan.corners.back();
      course_.go_to_corner(side, off < 0.0 ? 0.0 : side.angle);
      return true;
    }
    if (inside) return true;
    if (std::abs(off) > half) return false;
    const auto [corner, rest] = fan.at(off + half);
    course_.go_to_corner(corner, rest);
    return true;
  }

  // The fan of the vertex at which the particle is. The vertex becomes the base's start.
  Fan fan_here() {
    course_.turn_to(course_.border_base());
    return detail::fan_of(surface_, course_.place().triangle, course_.base());
  }
  [[nodiscard]] double angle_here() const { return polar_angle(course_.heading().across, course_.heading().along); }

  // Continues from a vertex at an angle from the fan's first edge, any number of turns away.
  void pass(const Fan& fan, double angle) {
    note_crossing({});
    angle -= fan.total * std::floor(angle / fan.total);
    const auto [corner, rest] = fan.at(angle);
    course_.go_to_corner(corner, rest);
  }

  void cross(const AcrossEdge& across) {
    note_crossing(across);
    course_.cross_base(across);
  }

  void note_crossing(const AcrossEdge& across) {
    ++result_.crossings;
    if (trace_.crossings == nullptr) return;
    const SurfacePlace& place = course_.place();
    trace_.crossings->push_back({now(), surface_.point(place), place.kind(), dart_of(surface_, place, across), place});
  }

  // Goes straight to the end of the path (true), or to a wall (false).
  bool advance() {
    while (true) {
      if (result_.crossings >= options_.max_crossings) {
        result_.end = SurfaceEnd::limit;
        return true;
      }
      const detail::Exit exit = course_.way_out();
      if (left_ < exit.length) {
        arrive(exit);
        return true;
      }
      course_.put(exit.weights);
      result_.length += exit.length;
      left_ -= exit.length;
      if (!(course_.place().kind() == Kind::vertex ? go_through_vertex() : go_over_edge())) return false;
      if (left_ == 0.0) return true;
    }
  }

  void arrive(const detail::Exit& exit) {
    const double f = left_ / exit.length;
    TriangleWeights w = course_.weights();
    for (unsigned i = 0; i < 3; ++i) w[i] = (1.0 - f) * w[i] + f * exit.weights[i];
    course_.put(detail::normalized(w));
    result_.length += left_;
    left_ = 0.0;
  }

  bool go_over_edge() {
    course_.turn_to(course_.border_base());
    const AcrossEdge across = course_.across_base();
    if (across.wall) return false;
    cross(across);
    return true;
  }

  bool go_through_vertex() {
    const Fan fan = fan_here();
    if (!fan.closed) return false;
    const double ahead = angle_here();
    const double back = std::clamp(ahead > 0.0 ? ahead - pi : ahead + pi, 0.0, fan.corners[fan.own].angle);
    pass(fan, back + fan.total / 2);
    return true;
  }

  // Fraction of the step.
  [[nodiscard]] double now() const { return way_ > 0.0 ? began_ + (1.0 - began_) * (1.0 - left_ / way_) : began_; }

  SurfaceContact describe() {
    SurfaceContact c;
    c.particle = particle_;
    c.time_of_impact = std::clamp(now(), 0.0, 1.0);
    c.place = course_.place();
    c.point = surface_.point(c.place);
    c.kind = c.place.kind();
    course_.turn_to(course_.border_base());
    AcrossEdge across;
    if (c.kind == Kind::edge) {
      across = course_.across_base();
      c.patch = surface_.map().patch(across.face);
      c.normal = course_.in_space({0.0, 1.0}, 1.0);
      c.sides = {course_.in_space({1.0, 0.0}, 1.0), course_.in_space({-1.0, 0.0}, 1.0)};
    } else {
      const Fan fan = fan_here();
      c.normal = course_.in_space(heading_at(fan.total / 2 - fan.before), 1.0);
      c.sides = {course_.in_space(heading_at(-fan.before), 1.0),
                 course_.in_space(heading_at(fan.total - fan.before), 1.0)};
    }
    c.dart = dart_of(surface_, c.place, across);
    c.displacement = set_out_;
    c.unused = course_.in_space(course_.heading(), left_);
    return c;
  }

  const Surface& surface_;
  Course course_;
  const SurfaceOptions& options_;
  const SurfaceTrace& trace_;
  std::uint32_t particle_;
  SurfaceStep result_;
  Vec3 set_out_;
  double way_ = 0.0;    // length to go at the last start
  double left_ = 0.0;   // remaining part of it
  double began_ = 0.0;  // time of the last start, as a fraction of the step
};

// A place on the border of a blocked face may also be one of a free face.
SurfacePlace in_free_face(const Surface& surface, const SurfacePlace& place) {
  if (surface.map().is_free(place.triangle.cell) || place.kind() == Kind::face) return place;
  const auto& w = place.weights;
  if (place.kind() == Kind::edge) {
    const auto edge = static_cast<unsigned>(std::find(w.begin(), w.end(), 0.0) - w.begin());
    const AcrossEdge across = surface.across(place.triangle, edge);
    if (!across.triangle.valid() || !surface.map().is_free(across.triangle.cell)) return place;
    SurfacePlace other{across.triangle, {}};
    other.weights[(across.edge + 1) % 3] = w[(edge + 2) % 3];
    other.weights[(across.edge + 2) % 3] = w[(edge + 1) % 3];
    return other;
  }
  const auto corner = static_cast<unsigned>(std::max_element(w.begin(), w.end()) - w.begin());
  const Fan fan = detail::fan_of(surface, place.triangle, corner, detail::FanWalls::passed);
  const auto free = std::find_if(fan.corners.begin(), fan.corners.end(),
                                 [&](const FanCorner& c) { return surface.map().is_free(c.triangle.cell); });
  if (free == fan.corners.end()) return place;
  SurfacePlace other{free->triangle, {}};
  other.weights[free->corner] = 1.0;
  return other;
}

}  // namespace

SurfaceStep step(const Surface& surface, SurfacePlace& place, const Vec3& displacement,
                 const SurfaceContactCallback& respond, const SurfaceOptions& options, const SurfaceTrace& trace,
                 std::uint32_t particle) {
  if (!surface.contains(place)) throw InvalidArgument("step: the place is none of this surface");
  if (options.max_contacts == 0) throw InvalidArgument("step: max_contacts is 0: it must be at least 1");
  Stepping::check_displacement(displacement);
  SurfacePlace moved = in_free_face(surface, place);
  if (!surface.map().is_free(moved.triangle.cell)) {
    SurfaceStep held;
    held.end = SurfaceEnd::held;
    held.remaining = displacement;
    return held;
  }
  const SurfaceStep result = Stepping(surface, moved, options, trace, particle).run(displacement, respond);
  place = moved;
  return result;
}

Vec3 tangent(const Surface& surface, SimplexId triangle, unsigned corner, double angle, double length) {
  if (corner > 2 || !surface.contains(SurfacePlace{triangle, {1.0, 0.0, 0.0}}))
    throw InvalidArgument("tangent: the surface has no such triangle or corner");
  const auto v = surface.corners(triangle);
  const Frame f = detail::frame_of(v[corner], v[(corner + 1) % 3], v[(corner + 2) % 3]);
  const SineCosine turned = sine_cosine(angle);
  return (f.along * turned.cosine + f.across * turned.sine) * length;
}

}  // namespace dartcast
