// Quadruples of points on which a sign test can go wrong, for tests.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/random.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::test {

using Quadruple = std::array<Vec3, 4>;

enum class QuadrupleKind {
  uniform,
  nearly_coplanar,
  exactly_coplanar,
  small_lattice,
  one_ulp_off,
  any_magnitude,
  far_from_origin,
  nearly_collinear,
};
inline constexpr int quadruple_kinds = 8;

class Quadruples {
 public:
  explicit Quadruples(std::uint64_t seed) : random_(seed) {}

  Quadruple make(QuadrupleKind kind) {
    switch (kind) {
      case QuadrupleKind::uniform: return each([&] { return random_.uniform(-1.0, 1.0); });
      case QuadrupleKind::nearly_coplanar:
        return nearly_coplanar(random_.uniform(-2.0, 2.0), random_.uniform(-2.0, 2.0));
      case QuadrupleKind::exactly_coplanar: return shuffled(coplanar_integers(1 << 20));
      case QuadrupleKind::small_lattice: return each([&] { return integer(4); });
      case QuadrupleKind::one_ulp_off: return one_ulp_off();
      case QuadrupleKind::any_magnitude: return each([&] { return signed_power(-40, 40); });
      case QuadrupleKind::far_from_origin: return far_from_origin();
      case QuadrupleKind::nearly_collinear: return nearly_collinear();
    }
    return {};
  }

  /// A number of random sign and of magnitude in [2^lowest, 2^highest).
  double signed_power(int lowest, int highest) {
    const int exponent = lowest + static_cast<int>(random_.below(static_cast<std::uint32_t>(highest - lowest)));
    return std::ldexp(random_.uniform(1.0, 2.0), exponent) * (random_.below(2) == 0 ? 1.0 : -1.0);
  }

  double integer(int largest) {
    return static_cast<double>(random_.below(2U * static_cast<std::uint32_t>(largest) + 1U)) - largest;
  }

  Random& random() { return random_; }

  /// Points of a plane on an integer lattice: a, b, c and a + i (b - a) + j (c - a).
  Quadruple coplanar_integers(int largest) {
    const auto point = [&] { return Vec3{integer(largest), integer(largest), integer(largest)}; };
    const Vec3 a = point();
    const Vec3 b = point();
    const Vec3 c = point();
    return {a, b, c, a + integer(8) * (b - a) + integer(8) * (c - a)};
  }

  Quadruple shuffled(Quadruple q) {
    for (std::uint32_t i = 3; i > 0; --i) std::swap(q[i], q[random_.below(i + 1)]);
    return q;
  }

 private:
  template <class Number>
  static Quadruple each(Number&& number) {
    Quadruple q;
    for (Vec3& p : q) p = {number(), number(), number()};
    return q;
  }

  void nudge(double& x) {
    const double towards = random_.below(2) == 0 ? 1.0 : -1.0;
    x = std::nextafter(x, towards * std::numeric_limits<double>::infinity());
  }

  double& any_coordinate(Quadruple& q) {
    Vec3& p = q[random_.below(4)];
    const std::array<double*, 3> coordinates = {&p.x, &p.y, &p.z};
    return *coordinates[random_.below(3)];
  }

  Quadruple nearly_coplanar(double u, double v) {
    Quadruple q = make(QuadrupleKind::uniform);
    q[3] = q[0] + u * (q[1] - q[0]) + v * (q[2] - q[0]);
    return shuffled(q);
  }

  Quadruple one_ulp_off() {
    Quadruple q = coplanar_integers(64);
    double& x = any_coordinate(q);
    if (x == 0.0) x = 0x1p-60;
    nudge(x);
    return shuffled(q);
  }

  Quadruple far_from_origin() {
    const double offset = std::ldexp(1.0, static_cast<int>(random_.below(50)));
    Quadruple q = nearly_coplanar(random_.uniform(), random_.uniform());
    for (Vec3& p : q) p += Vec3{offset, -offset, 3.0 * offset};
    return q;
  }

  Quadruple nearly_collinear() {
    Quadruple q = make(QuadrupleKind::uniform);
    for (std::size_t i = 2; i < 4; ++i) q[i] = q[0] + random_.uniform(-2.0, 2.0) * (q[1] - q[0]);
    if (random_.below(2) == 0) nudge(any_coordinate(q));
    return shuffled(q);
  }

  Random random_;
};

}  // namespace dartcast::test
