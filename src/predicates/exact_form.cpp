// Roots of forms: made square-free by the greatest common divisor with the derivative, then halved in Bernstein's form
// until one change of sign remains. Signs at roots: the interval is halved until the form has one sign there. After some
// halvings one common divisor says whether the form is 0 at the root, so it ends always.
#include "predicates/exact_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace dartcast::detail {

namespace {

using Integers = std::vector<ExactInteger>;

// After so many halvings a form that has no sign yet is likely to be 0.
constexpr int halvings_before_divisor = 8;
constexpr int time_bits = 40;

ExactInteger power_of_two(int k) { return ExactInteger(1) << static_cast<unsigned>(k); }

void trim(ExactPolynomial& p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
}

void make_primitive(ExactPolynomial& p) {
  ExactInteger divisor = 0;
  for (const ExactInteger& c : p) divisor = gcd(divisor, c);
  if (divisor <= 1) return;
  for (ExactInteger& c : p) c /= divisor;
}

// Divides a, times a number that is not 0, by b. The remainder stands in a.
ExactPolynomial divide(ExactPolynomial& a, const ExactPolynomial& b) {
  if (a.size() < b.size()) return {};
  ExactPolynomial quotient(a.size() - b.size() + 1);
  while (a.size() >= b.size() && !a.empty()) {
    const ExactInteger lead = a.back();
    const std::size_t shift = a.size() - b.size();
    for (ExactInteger& c : a) c *= b.back();
    for (ExactInteger& c : quotient) c *= b.back();
    quotient[shift] += lead;
    for (std::size_t i = 0; i < b.size(); ++i) a[i + shift] -= lead * b[i];
    trim(a);
  }
  trim(quotient);
  return quotient;
}

ExactPolynomial common_divisor(ExactPolynomial a, ExactPolynomial b) {
  trim(a);
  trim(b);
  while (!b.empty()) {
    divide(a, b);
    make_primitive(a);
    std::swap(a, b);
  }
  make_primitive(a);
  return a;
}

ExactPolynomial square_free(ExactPolynomial p) {
  make_primitive(p);
  if (p.size() <= 2) return p;
  ExactPolynomial derivative;
  for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * static_cast<int>(i));
  const ExactPolynomial divisor = common_divisor(p, derivative);
  if (divisor.size() <= 1) return p;
  ExactPolynomial quotient = divide(p, divisor);
  make_primitive(quotient);
  return quotient;
}

// c over the binomials, times their least common multiple.
Integers bernstein(const ExactPolynomial& p) {
  Integers b(p);
  const std::size_t degree = p.size() - 1;
  if (degree == 2) {
    b[0] *= 2;
    b[2] *= 2;
  } else if (degree == 3) {
    b[0] *= 3;
    b[3] *= 3;
  }
  return b;
}

struct Halves {
  Integers left, right;
};

Halves halves_of(Integers b) {
  const std::size_t degree = b.size() - 1;
  Halves halves{Integers(degree + 1), Integers(degree + 1)};
  for (std::size_t k = 0; k <= degree; ++k) {
    const auto shift = static_cast<unsigned>(degree - k);
    halves.left[k] = b[0] << shift;
    halves.right[degree - k] = b[degree - k] << shift;
    for (std::size_t i = 0; i + k < degree; ++i) b[i] += b[i + 1];
  }
  return halves;
}

int changes_of_sign(const Integers& b) {
  int changes = 0;
  int last = 0;
  for (const ExactInteger& c : b) {
    const int sign = c.sign();
    if (sign == 0) continue;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  return changes;
}

// The value at j / 2^k, times a positive number.
ExactInteger value_at(const Integers& c, const ExactInteger& j, int k) {
  const ExactInteger s = power_of_two(k) - j;
  ExactInteger value = 0;
  ExactInteger power = 1;
  for (std::size_t i = c.size(); i-- > 0;) {
    value = value * j + c[i] * power;
    power *= s;
  }
  return value;
}

Integers coefficients(const ExactForm& f) { return {f.c.begin(), f.c.begin() + f.degree + 1}; }

// The sign that all coefficients of Bernstein's form on (j, j + 1) / 2^k share, or 0.
int common_sign(const ExactForm& f, const ExactInteger& j, int k) {
  const ExactInteger s0 = power_of_two(k) - j;
  const ExactInteger s1 = s0 - 1;
  const ExactInteger t1 = j + 1;
  const auto& c = f.c;
  Integers b{c[0]};
  if (f.degree == 1) b = {c[0] * s0 + c[1] * j, c[0] * s1 + c[1] * t1};
  if (f.degree == 2) {
    b = {(c[0] * s0 + c[1] * j) * s0 + c[2] * j * j, 2 * c[0] * s0 * s1 + c[1] * (s0 * t1 + s1 * j) + 2 * c[2] * j * t1,
         (c[0] * s1 + c[1] * t1) * s1 + c[2] * t1 * t1};
  }
  const int sign = b.front().sign();
  return std::all_of(b.begin(), b.end(), [sign](const ExactInteger& x) { return x.sign() == sign; }) ? sign : 0;
}

}  // namespace

bool ExactForm::is_zero() const {
  return std::all_of(c.begin(), c.begin() + degree + 1, [](const ExactInteger& x) { return x == 0; });
}

ExactForm operator*(const ExactForm& f, const ExactForm& g) {
  ExactForm product;
  product.degree = f.degree + g.degree;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(f.degree); ++i) {
    for (std::size_t j = 0; j <= static_cast<std::size_t>(g.degree); ++j) product.c[i + j] += f.c[i] * g.c[j];
  }
  return product;
}

ExactForm operator+(const ExactForm& f, const ExactForm& g) {
  ExactForm sum = f;
  for (std::size_t i = 0; i < sum.c.size(); ++i) sum.c[i] += g.c[i];
  return sum;
}

ExactForm operator-(const ExactForm& f, const ExactForm& g) {
  ExactForm difference = f;
  for (std::size_t i = 0; i < difference.c.size(); ++i) difference.c[i] -= g.c[i];
  return difference;
}

ExactTime ExactTime::start() { return {}; }

ExactTime ExactTime::end() {
  ExactTime time;
  time.j_ = 1;
  return time;
}

// f changes its sign at its root alone, and is not 0 at the ends.
void ExactTime::halve() {
  ++k_;
  j_ *= 2;
  const int middle = value_at(f_, j_ + 1, k_).sign();
  exact_ = middle == 0;
  if (exact_ || middle == sign_before_) ++j_;
}

// The roots of a divisor of f_ are roots of f_. It has one here, and a simple one. f is 0 at it if the divisor changes
// its sign over the interval.
bool ExactTime::is_root_of(const ExactPolynomial& f) const {
  const ExactPolynomial divisor = common_divisor(f_, f);
  return divisor.size() > 1 && value_at(divisor, j_, k_).sign() * value_at(divisor, j_ + 1, k_).sign() < 0;
}

int ExactTime::sign_of(const ExactForm& f) {
  if (f.is_zero()) return 0;
  for (int halvings = 0; !exact_; ++halvings) {
    const int sign = common_sign(f, j_, k_);
    if (sign != 0) return sign;
    if (halvings == halvings_before_divisor && is_root_of(coefficients(f))) return 0;
    halve();
  }
  return value_at(coefficients(f), j_, k_).sign();
}

double ExactTime::rounded_down() {
  while (!exact_ && k_ < time_bits) halve();
  if (k_ <= time_bits) return std::ldexp(j_.convert_to<double>(), -k_);
  const ExactInteger rounded = j_ >> static_cast<unsigned>(k_ - time_bits);
  return std::ldexp(rounded.convert_to<double>(), -time_bits);
}

std::vector<ExactTime> roots_inside(const ExactForm& f) {
  ExactPolynomial p = coefficients(f);
  trim(p);
  p.erase(p.begin(), std::find_if(p.begin(), p.end(), [](const ExactInteger& c) { return c != 0; }));
  std::vector<ExactTime> roots;
  if (p.size() <= 1) return roots;
  p = square_free(p);

  // Intervals still to be looked at, the earliest last.
  ExactTime whole;
  whole.exact_ = false;
  whole.f_ = p;
  struct Part {
    ExactTime time;
    Integers bernstein;  // f's coefficients there, times a positive number
  };
  std::vector<Part> open{{whole, bernstein(p)}};
  while (!open.empty()) {
    Part part = std::move(open.back());
    open.pop_back();
    if (part.time.exact_) {
      roots.push_back(std::move(part.time));
      continue;
    }
    const Integers& b = part.bernstein;
    const int changes = changes_of_sign(b);
    if (changes == 0) continue;
    if (changes == 1 && b.front() != 0 && b.back() != 0) {
      part.time.sign_before_ = b.front().sign();
      roots.push_back(std::move(part.time));
      continue;
    }
    Halves halves = halves_of(b);
    ExactTime left = part.time;
    ExactTime right = std::move(part.time);
    left.k_ = right.k_ = right.k_ + 1;
    left.j_ *= 2;
    right.j_ = left.j_ + 1;
    ExactTime middle;
    middle.k_ = right.k_;
    middle.j_ = right.j_;
    const bool middle_is_root = halves.right.front() == 0;
    open.push_back({std::move(right), std::move(halves.right)});
    if (middle_is_root) open.push_back({std::move(middle), {}});
    open.push_back({std::move(left), std::move(halves.left)});
  }
  return roots;
}

}  // namespace dartcast::detail
