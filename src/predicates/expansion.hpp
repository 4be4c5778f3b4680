// Exact sums and products of doubles, as expansions: unevaluated sums of doubles that do not overlap, smallest first.
//
// This work is based on J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
// predicates", 1997 (two-sum, two-product, and the zero-eliminating fast expansion sum and scaling). Exact as long as
// nothing overflows and no product falls below the smallest double: see the range in predicates.hpp.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace dartcast {

/// An exact value of at most N components, all on the stack.
template <std::size_t N>
struct Expansion {
  std::array<double, N> component;  // only the first `size` are set
  std::size_t size = 0;

  void push(double c) {
    if (c != 0.0) component[size++] = c;
  }

  /// -1, 0 or 1. The largest component is never zero, and it outweighs the rest.
  [[nodiscard]] int sign() const {
    if (size == 0) return 0;
    return component[size - 1] > 0.0 ? 1 : -1;
  }

  /// The value to a few units in the last place, with the exact sign.
  [[nodiscard]] double estimate() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) sum += component[i];
    return sum;
  }
};

namespace detail {

struct TwoTerms {
  double high;
  double low;
};

inline TwoTerms two_sum(double a, double b) {
  const double s = a + b;
  const double bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}

inline TwoTerms fast_two_sum(double large, double small) {
  const double s = large + small;
  return {s, small - (s - large)};
}

inline TwoTerms split(double a) {
  const double c = 0x1.0000002p+27 * a;  // 2^27 + 1
  const double high = c - (c - a);
  return {high, a - high};
}

inline TwoTerms two_product(double a, double b) {
  const double p = a * b;
  const TwoTerms x = split(a);
  const TwoTerms y = split(b);
  return {p, x.low * y.low - (((p - x.high * y.high) - x.low * y.high) - x.high * y.low)};
}

}  // namespace detail

/// a - b, exactly.
inline Expansion<2> difference(double a, double b) {
  const auto [high, low] = detail::two_sum(a, -b);
  Expansion<2> e;
  e.push(low);
  e.push(high);
  return e;
}

template <std::size_t N>
Expansion<N> operator-(Expansion<N> a) {
  for (std::size_t i = 0; i < a.size; ++i) a.component[i] = -a.component[i];
  return a;
}

template <std::size_t N, std::size_t M>
Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<N + M> sum;
  std::size_t i = 0;
  std::size_t j = 0;
  const auto next = [&] {  // the two lists merged by magnitude
    if (j == b.size || (i < a.size && std::abs(a.component[i]) < std::abs(b.component[j]))) return a.component[i++];
    return b.component[j++];
  };
  const std::size_t count = a.size + b.size;
  if (count == 0) return sum;
  double q = next();
  for (std::size_t k = 1; k < count; ++k) {
    const auto [high, low] = detail::two_sum(q, next());
    sum.push(low);
    q = high;
  }
  sum.push(q);
  return sum;
}

template <std::size_t N, std::size_t M>
Expansion<N + M> operator-(const Expansion<N>& a, const Expansion<M>& b) {
  return a + (-b);
}

/// Scales by one double.
template <std::size_t N>
Expansion<2 * N> scale(const Expansion<N>& a, double b) {
  Expansion<2 * N> result;
  if (a.size == 0 || b == 0.0) return result;
  auto [q, first] = detail::two_product(a.component[0], b);
  result.push(first);
  for (std::size_t i = 1; i < a.size; ++i) {
    const auto product = detail::two_product(a.component[i], b);
    const auto sum = detail::two_sum(q, product.low);
    result.push(sum.low);
    const auto last = detail::fast_two_sum(product.high, sum.high);
    result.push(last.low);
    q = last.high;
  }
  result.push(q);
  return result;
}

/// Product: the sum of a scaled by each component of b.
template <std::size_t N, std::size_t M>
Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<2 * N * M> result;
  for (std::size_t j = 0; j < b.size; ++j) {
    const auto sum = result + scale(a, b.component[j]);
    result.size = sum.size;  // never more than 2 N (j + 1): both operands are that short
    for (std::size_t i = 0; i < sum.size; ++i) result.component[i] = sum.component[i];
  }
  return result;
}

}  // namespace dartcast
