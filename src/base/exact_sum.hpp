// A sum of doubles that does not depend on their order: it is exact, and rounded once. Not installed.
//
// The sum is an integer times 2^-1074, in digits of 32 bits (U. Kulisch, "Computer Arithmetic and Validity", 2008: a
// long accumulator). A digit is held in 64 bits, so that carries wait.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace dartcast {

class ExactSum {
 public:
  void add(double x) {
    if (!std::isfinite(x)) {
      special_ += x;  // infinite, or not a number once and for all: in any order
      return;
    }
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const auto biased = static_cast<unsigned>(bits >> 52U) & 0x7ffU;
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52U) - 1U);
    if (biased > 0) mantissa |= std::uint64_t{1} << 52U;
    if (mantissa == 0) return;
    const unsigned place = biased > 0 ? biased - 1U : 0U;  // of the mantissa's last bit, above 2^-1074
    const std::size_t digit = place / digit_bits;
    const unsigned shift = place % digit_bits;
    const std::uint64_t low = mantissa << shift;
    const std::uint64_t high = shift == 0 ? 0 : mantissa >> (64U - shift);
    const std::int64_t sign = (bits >> 63U) != 0 ? -1 : 1;
    digits_[digit] += sign * static_cast<std::int64_t>(low & digit_mask);
    digits_[digit + 1] += sign * static_cast<std::int64_t>(low >> digit_bits);
    digits_[digit + 2] += sign * static_cast<std::int64_t>(high);
    if (++waiting_ == most_waiting) carry();
  }

  ExactSum& operator+=(const ExactSum& other) {
    ExactSum theirs = other;
    theirs.carry();
    carry();
    for (std::size_t i = 0; i < digit_count; ++i) digits_[i] += theirs.digits_[i];
    waiting_ = 2;
    special_ += other.special_;
    return *this;
  }

  static constexpr std::size_t word_count = 71;  // the digits, and three numbers of specials
  using Words = std::array<std::uint64_t, word_count>;
  /// The sum as words. Those of several sums, each word added to its like modulo 2^64, are words of the sum of all.
  [[nodiscard]] Words words() const {
    ExactSum sum = *this;
    sum.carry();
    Words result{};
    for (std::size_t i = 0; i < digit_count; ++i) result[i] = static_cast<std::uint64_t>(sum.digits_[i]);
    if (std::isnan(special_)) result[digit_count] = 1;
    if (special_ > 0.0) result[digit_count + 1] = 1;
    if (special_ < 0.0) result[digit_count + 2] = 1;
    return result;
  }
  /// `words`: of at most 2^30 sums.
  static ExactSum of(const Words& words) {
    ExactSum sum;
    for (std::size_t i = 0; i < digit_count; ++i) sum.digits_[i] = static_cast<std::int64_t>(words[i]);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (words[digit_count] > 0) sum.special_ = std::numeric_limits<double>::quiet_NaN();
    if (words[digit_count + 1] > 0) sum.special_ += infinite;
    if (words[digit_count + 2] > 0) sum.special_ -= infinite;
    sum.carry();
    return sum;
  }

  /// The sum, rounded to the nearest double.
  [[nodiscard]] double value() const {
    if (special_ != 0.0) return special_;
    ExactSum sum = *this;
    sum.carry();
    const bool negative = sum.digits_.back() < 0;
    if (negative) {
      for (std::int64_t& d : sum.digits_) d = -d;
      sum.carry();
    }
    const double size = sum.rounded();
    return negative ? -size : size;
  }

 private:
  static constexpr unsigned digit_bits = 32;
  static constexpr std::uint64_t digit_mask = 0xffffffffU;
  static constexpr std::size_t digit_count = 68;  // 2045 / 32 + 3 for one number, and 32 bits more for many
  static constexpr std::uint32_t most_waiting = std::uint32_t{1} << 30U;

  // All digits but the last are then in [0, 2^32).
  void carry() {
    std::int64_t over = 0;
    for (std::size_t i = 0; i + 1 < digit_count; ++i) {
      const std::int64_t d = digits_[i] + over;
      over = d >> digit_bits;
      digits_[i] = d & static_cast<std::int64_t>(digit_mask);
    }
    digits_.back() += over;
    waiting_ = 1;
  }

  // Precondition: carried, and not negative. 64 bits from the first one that is set, the last of them also set if any
  // lower one is. The conversion to double then rounds as the whole number would. A number below 2^-1022 has no bits to
  // round off.
  [[nodiscard]] double rounded() const {
    std::size_t top = digit_count - 1;
    while (top > 0 && digits_[top] == 0) --top;
    const auto digit = [&](std::size_t below) {
      return top >= below ? static_cast<std::uint64_t>(digits_[top - below]) : std::uint64_t{0};
    };
    const auto zeros = static_cast<unsigned>(std::countl_zero(digit(0))) - digit_bits;
    std::uint64_t bits = (digit(0) << digit_bits | digit(1)) << zeros;
    if (zeros > 0) bits |= digit(2) >> (digit_bits - zeros);
    bool more = (digit(2) << zeros & digit_mask) != 0;
    for (std::size_t below = 3; below <= top; ++below) more = more || digit(below) != 0;
    const int exponent = static_cast<int>(digit_bits * top) - 1074 - static_cast<int>(digit_bits + zeros);
    return std::ldexp(static_cast<double>(bits | (more ? 1U : 0U)), exponent);
  }

  std::array<std::int64_t, digit_count> digits_{};
  std::uint32_t waiting_ = 0;  // numbers added since the last carry
  double special_ = 0.0;
};

}  // namespace dartcast
