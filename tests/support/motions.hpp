// Motions of a simplex that invert it, almost invert it, or do not, for tests.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/random.hpp"
#include "complex/simplex.hpp"

namespace dartcast::test {

struct Motion {
  Corners before;
  Corners after;
};

enum class MotionKind {
  any,
  small,
  rotation,
  lattice,
  multiple_root,
  nearly_multiple_root,
  sliver,
  far_from_origin,
  translation,
  rest,
};
inline constexpr int motion_kinds = 10;

class Motions {
 public:
  explicit Motions(std::uint64_t seed) : random_(seed) {}

  Random& random() { return random_; }

  /// Positive at the start, mostly.
  Motion make(MotionKind kind) {
    Motion m = made(kind);
    if (volume_sign(m.before) == Sign::negative) {
      std::swap(m.before[0], m.before[1]);
      std::swap(m.after[0], m.after[1]);
    }
    if (random_.below(4) == 0) stretch(m);
    return m;
  }

 private:
  Motion made(MotionKind kind) {
    switch (kind) {
      case MotionKind::any: return {uniform(), uniform()};
      case MotionKind::small: return moved_by(uniform(), 40);
      case MotionKind::rotation: return rotation();
      case MotionKind::lattice: return {integers(3), integers(3)};
      case MotionKind::multiple_root: return multiple_root();
      case MotionKind::nearly_multiple_root: return nearly_multiple_root();
      case MotionKind::sliver: return moved_by(sliver(), 60);
      case MotionKind::far_from_origin: return far_from_origin();
      case MotionKind::translation: return translation();
      case MotionKind::rest: break;
    }
    const Corners v = random_.below(2) == 0 ? sliver() : uniform();
    return {v, v};
  }

  Vec3 vector(double size) {
    return {random_.uniform(-size, size), random_.uniform(-size, size), random_.uniform(-size, size)};
  }
  Corners uniform() { return {vector(1.0), vector(1.0), vector(1.0), vector(1.0)}; }

  double integer(int largest) {
    return static_cast<double>(random_.below(2U * static_cast<std::uint32_t>(largest) + 1U)) - largest;
  }
  Corners integers(int largest) {
    Corners v;
    for (Vec3& p : v) p = {integer(largest), integer(largest), integer(largest)};
    return v;
  }

  Corners sliver() {
    Corners v = uniform();
    const double i = random_.uniform();
    const double j = random_.uniform();
    v[3] = v[0] + i * (v[1] - v[0]) + j * (v[2] - v[0]);
    v[3] += vector(small(60));
    return v;
  }

  // A power of two: one of the `count` from 1 down.
  double small(std::uint32_t count) { return std::ldexp(1.0, -static_cast<int>(random_.below(count))); }

  Motion moved_by(const Corners& v, std::uint32_t sizes) {
    Motion m{v, v};
    const double size = small(sizes);
    for (Vec3& p : m.after) p += vector(size);
    return m;
  }

  // About an axis, by up to a full turn; halfway at 180 degrees the simplex is flat or nearly so.
  Motion rotation() {
    const Corners v = uniform();
    const Vec3 direction = vector(1.0);
    const Vec3 k = direction * (1.0 / norm(direction));
    const double pi = 3.14159265358979323846;
    const double angle = random_.below(3) == 0 ? pi : random_.uniform(0.0, 2.0 * pi);
    Motion m{v, v};
    for (Vec3& p : m.after) {
      const Vec3 along = dot(k, p) * k;
      p = along + std::cos(angle) * (p - along) + std::sin(angle) * cross(k, p);
    }
    return m;
  }

  // Edges that are triangular, each diagonal entry d going to -d k / n or to something positive: roots at n / (n + k),
  // several times the same one; then sheared and moved, all in small integers.
  Motion multiple_root() {
    const double n = 1.0 + random_.below(6);
    const double k = 1.0 + random_.below(6);
    const std::uint32_t shrinking = 2 + random_.below(2);
    std::array<std::array<double, 3>, 3> p{};
    std::array<std::array<double, 3>, 3> q{};
    for (unsigned i = 0; i < 3; ++i) {
      const double d = 1.0 + random_.below(4);
      p[i][i] = d * n;
      q[i][i] = i < shrinking ? -d * k : d * (1.0 + random_.below(3));
      for (unsigned j = i + 1; j < 3; ++j) {
        p[i][j] = integer(3);
        q[i][j] = integer(3);
      }
    }
    const double shear = integer(2);
    Motion m;
    m.before[0] = {integer(5), integer(5), integer(5)};
    m.after[0] = {integer(5), integer(5), integer(5)};
    for (unsigned i = 0; i < 3; ++i) {
      m.before[i + 1] = m.before[0] + Vec3{p[i][0], p[i][1] + shear * p[i][0], p[i][2] - shear * p[i][1]};
      m.after[i + 1] = m.after[0] + Vec3{q[i][0], q[i][1] + shear * q[i][0], q[i][2] - shear * q[i][1]};
    }
    return m;
  }

  Motion nearly_multiple_root() {
    Motion m = multiple_root();
    for (unsigned i = 0; i < 3; ++i) {
      Vec3& p = (random_.below(2) == 0 ? m.before : m.after)[random_.below(4)];
      double& x = random_.below(2) == 0 ? p.x : random_.below(2) == 0 ? p.y : p.z;
      if (x == 0.0) x = 0x1p-60;
      const double far = random_.below(2) == 0 ? 1.0 : -1.0;
      x = random_.below(2) == 0 ? std::nextafter(x, far * std::numeric_limits<double>::infinity())
                                : x + far * std::ldexp(1.0, -static_cast<int>(random_.below(50)));
    }
    return m;
  }

  Motion far_from_origin() {
    Motion m = moved_by(random_.below(2) == 0 ? sliver() : uniform(), 1);
    const Vec3 from = vector(std::ldexp(1.0, static_cast<int>(random_.below(50))));
    const Vec3 to = vector(std::ldexp(1.0, static_cast<int>(random_.below(50))));
    for (Vec3& p : m.before) p += from;
    for (Vec3& p : m.after) p += to;
    return m;
  }

  Motion translation() {
    Motion m{integers(1000), {}};
    const Vec3 by = {integer(1000), integer(1000), integer(1000)};
    for (unsigned i = 0; i < 4; ++i) m.after[i] = m.before[i] + by;
    return m;
  }

  // To another scale, sometimes another one along each axis.
  void stretch(Motion& m) {
    const auto power = [&] { return std::ldexp(1.0, static_cast<int>(random_.below(400)) - 200); };
    const double s = power();
    const Vec3 by = random_.below(2) == 0 ? Vec3{s, s, s} : Vec3{s, power(), power()};
    for (Corners* corners : {&m.before, &m.after}) {
      for (Vec3& p : *corners) p = {p.x * by.x, p.y * by.y, p.z * by.z};
    }
  }

  Random random_;
};

}  // namespace dartcast::test
