// Vectors of 32 bytes in two registers of 16, for instruction sets that have no longer ones. g++ would take their lanes one
// by one where they are compared or chosen.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "base/simd_kernel.hpp"

#if defined(DARTCAST_AVX2)
#define DARTCAST_VECTOR(T) T __attribute__((vector_size(32)))
#else
#define DARTCAST_VECTOR(T) RegisterPair<T>

namespace dartcast::detail::portable {
namespace {

// Types of vectors are named by typedef: an alias of a template drops the attribute.
template <class T>
struct RegisterPair {
  typedef T Half __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
  static constexpr std::size_t lanes = 16 / sizeof(T);
  using MaskLane = std::conditional_t<sizeof(T) == 8, long long, int>;
  using Mask = RegisterPair<MaskLane>;
  typedef MaskLane MaskHalf __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

  Half low, high;

  RegisterPair() = default;
  RegisterPair(const Half& l, const Half& h) : low(l), high(h) {}
  RegisterPair(T x) : low(x - Half{}), high(low) {}  // NOLINT(google-explicit-constructor): as with vectors
  RegisterPair(T a, T b, T c, T d) requires(lanes == 2) : low{a, b}, high{c, d} {}
  RegisterPair(T a, T b, T c, T d, T e, T f, T g, T h) requires(lanes == 4) : low{a, b, c, d}, high{e, f, g, h} {}

  // A lane that can be written.
  struct Lane {
    RegisterPair& of;
    std::size_t i;
    Lane& operator=(T x) {
      (i < lanes ? of.low : of.high)[i % lanes] = x;
      return *this;
    }
    operator T() const { return std::as_const(of)[i]; }  // NOLINT(google-explicit-constructor)
  };
  T operator[](std::size_t i) const { return i < lanes ? low[i] : high[i - lanes]; }
  Lane operator[](std::size_t i) { return {*this, i}; }

  friend RegisterPair operator+(const RegisterPair& a, const RegisterPair& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend RegisterPair operator-(const RegisterPair& a, const RegisterPair& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend RegisterPair operator*(const RegisterPair& a, const RegisterPair& b) {
    return {a.low * b.low, a.high * b.high};
  }
  friend RegisterPair operator/(const RegisterPair& a, const RegisterPair& b) {
    return {a.low / b.low, a.high / b.high};
  }
  friend RegisterPair operator-(const RegisterPair& a) { return {-a.low, -a.high}; }
  friend RegisterPair operator&(const RegisterPair& a, const RegisterPair& b) {
    return {a.low & b.low, a.high & b.high};
  }
  friend RegisterPair operator|(const RegisterPair& a, const RegisterPair& b) {
    return {a.low | b.low, a.high | b.high};
  }
  friend RegisterPair operator^(const RegisterPair& a, const RegisterPair& b) {
    return {a.low ^ b.low, a.high ^ b.high};
  }
  friend RegisterPair operator~(const RegisterPair& a) { return {~a.low, ~a.high}; }
  friend RegisterPair operator<<(const RegisterPair& a, int n) { return {a.low << n, a.high << n}; }
  friend RegisterPair operator>>(const RegisterPair& a, int n) { return {a.low >> n, a.high >> n}; }
  RegisterPair& operator+=(const RegisterPair& b) { return *this = *this + b; }
  RegisterPair& operator-=(const RegisterPair& b) { return *this = *this - b; }
  RegisterPair& operator*=(const RegisterPair& b) { return *this = *this * b; }
  RegisterPair& operator/=(const RegisterPair& b) { return *this = *this / b; }
  RegisterPair& operator&=(const RegisterPair& b) { return *this = *this & b; }
  RegisterPair& operator|=(const RegisterPair& b) { return *this = *this | b; }

  friend Mask operator<(const RegisterPair& a, const RegisterPair& b) { return mask(a.low < b.low, a.high < b.high); }
  friend Mask operator>(const RegisterPair& a, const RegisterPair& b) { return mask(a.low > b.low, a.high > b.high); }
  friend Mask operator<=(const RegisterPair& a, const RegisterPair& b) {
    return mask(a.low <= b.low, a.high <= b.high);
  }
  friend Mask operator>=(const RegisterPair& a, const RegisterPair& b) {
    return mask(a.low >= b.low, a.high >= b.high);
  }
  friend Mask operator==(const RegisterPair& a, const RegisterPair& b) {
    return {same(a.low, b.low), same(a.high, b.high)};
  }
  friend Mask operator!=(const RegisterPair& a, const RegisterPair& b) { return ~(a == b); }

 private:
  template <class M>
  static Mask mask(const M& l, const M& h) {
    return {reinterpret_cast<MaskHalf>(l), reinterpret_cast<MaskHalf>(h)};
  }
  // Integers of 64 bits by those of 32: SSE2 compares no longer ones.
  static MaskHalf same(const Half& a, const Half& b) {
    if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
      typedef int Words __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
      const Words equal = reinterpret_cast<Words>(a) == reinterpret_cast<Words>(b);
      return reinterpret_cast<MaskHalf>(equal & __builtin_shufflevector(equal, equal, 1, 0, 3, 2));
    } else {
      return reinterpret_cast<MaskHalf>(a == b);
    }
  }
};

// The same bits.
template <class To, class From>
inline To bits_as(const RegisterPair<From>& x) {
  return {reinterpret_cast<typename To::Half>(x.low), reinterpret_cast<typename To::Half>(x.high)};
}

// The lanes of a where the mask is set, of b elsewhere.
template <class T>
inline RegisterPair<T> choose(const typename RegisterPair<T>::Mask& m, const RegisterPair<T>& a,
                              const RegisterPair<T>& b) {
  using Mask = typename RegisterPair<T>::Mask;
  return bits_as<RegisterPair<T> >((bits_as<Mask>(a) & m) | (bits_as<Mask>(b) & ~m));
}

}  // namespace
}  // namespace dartcast::detail::portable

#endif
