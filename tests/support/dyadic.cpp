#include "support/dyadic.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>

namespace dartcast::test {

struct Dyadic::Mantissa {
  boost::multiprecision::cpp_int value;
};

Dyadic::Dyadic(double x) {
  const auto value = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent_), 53));
  exponent_ -= 53;
  if (value != 0) mantissa_ = std::make_shared<const Mantissa>(Mantissa{value});
}

Dyadic Dyadic::power_of_two(int e) {
  Dyadic d(1.0);
  d.exponent_ += e;
  return d;
}

int Dyadic::sign() const { return mantissa_ ? mantissa_->value.sign() : 0; }

Dyadic operator-(const Dyadic& a) { return Dyadic() - a; }

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
  Dyadic product;
  if (a.sign() == 0 || b.sign() == 0) return product;
  auto mantissa = std::make_shared<Dyadic::Mantissa>();
  mantissa->value = a.mantissa_->value * b.mantissa_->value;
  product.mantissa_ = std::move(mantissa);
  product.exponent_ = a.exponent_ + b.exponent_;
  return product;
}

// a + b or a - b.
Dyadic Dyadic::sum(const Dyadic& a, const Dyadic& b, bool minus) {
  if (b.sign() == 0) return a;
  if (a.sign() == 0 && !minus) return b;
  Dyadic result;
  auto mantissa = std::make_shared<Mantissa>();
  result.exponent_ = a.sign() == 0 ? b.exponent_ : std::min(a.exponent_, b.exponent_);
  if (a.sign() != 0) mantissa->value = a.mantissa_->value << static_cast<unsigned>(a.exponent_ - result.exponent_);
  boost::multiprecision::cpp_int other = b.mantissa_->value << static_cast<unsigned>(b.exponent_ - result.exponent_);
  minus ? mantissa->value -= other : mantissa->value += other;
  result.mantissa_ = std::move(mantissa);
  return result;
}

Dyadic determinant(const Exact3<Dyadic>& a, const Exact3<Dyadic>& b, const Exact3<Dyadic>& c, const Exact3<Dyadic>& d) {
  return dot(minus(b, a), cross(minus(c, a), minus(d, a)));
}

Dyadic determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return determinant(exact(a), exact(b), exact(c), exact(d));
}

int exact_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double value = dot(cross(u, v), w);
  const auto absolute = [](const Vec3& p) { return Vec3{std::abs(p.x), std::abs(p.y), std::abs(p.z)}; };
  const Vec3 p = absolute(u), q = absolute(v), r = absolute(w);
  const double bound = r.x * (p.y * q.z + p.z * q.y) + r.y * (p.z * q.x + p.x * q.z) + r.z * (p.x * q.y + p.y * q.x);
  if (std::abs(value) > 1e-14 * bound) return value > 0 ? 1 : -1;
  return determinant(a, b, c, d).sign();
}

Exact3<Dyadic> small_shift(const Vec3& p, std::span<const Vec3> opposite, int bits) {
  Exact3<Dyadic> shift;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Vec3& o : opposite) shift[i] += exact(o)[i] - exact(p)[i];
    shift[i] = Dyadic::power_of_two(-bits) * shift[i] + Dyadic::power_of_two(-(static_cast<int>(i) + 2) * bits);
  }
  return shift;
}

}  // namespace dartcast::test
