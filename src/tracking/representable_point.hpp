// A double inside a thin simplex, close to a point that rounding put beside it.
//
// Between two walls that meet at a small angle, all doubles next to a point of their common edge may lie outside. The
// doubles around a point form a lattice. The search reduces a basis of this lattice (A. K. Lenstra, H. W. Lenstra, L.
// Lovasz, "Factoring polynomials with rational coefficients", 1982) in the norm in which the space between the facets
// is round. Then it tries the lattice point nearest to the middle of that space (L. Babai, "On Lovasz' lattice
// reduction and the nearest lattice point problem", 1986). Floating point only guides the search; exact signs check
// what it finds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "complex/simplex.hpp"
#include "tracking/step_state.hpp"

namespace dartcast::detail {

/// Whether x lies in the closed simplex; exact. Precondition: the simplex is positive.
template <std::size_t N>
bool in_closed_simplex(const std::array<Vec3, N>& v, const Vec3& x) {
  const Determinants d(v, x);
  std::uint64_t exact = 0;
  for (unsigned i = 0; i < N; ++i) {
    const Sign s = sign_of(d, i, v, x, exact);
    if (s == Sign::negative || s == Sign::undecidable) return false;
  }
  return true;
}

/// Barycentric coordinates in a simplex as functions of the place. Exact values behind them: those of a sliver are
/// small differences.
template <std::size_t N>
class Coordinates {
 public:
  using Weights = std::array<double, N>;

  explicit Coordinates(const std::array<Vec3, N>& v) : v_(v), volume_(volume_value(v)) {
    for (unsigned i = 0; i < N; ++i) {
      gradient_[i] = facet_gradient(v, i) * (1.0 / volume_);
      steepness_[i] = norm(gradient_[i]);
    }
  }

  [[nodiscard]] Weights at(const Vec3& x) const {
    Weights w;
    for (unsigned i = 0; i < N; ++i) w[i] = orient_facet_value(v_, i, x) / volume_;
    return w;
  }
  [[nodiscard]] Vec3 place(const Weights& w) const {
    if constexpr (N == 4) return (v_[0] * w[0] + v_[1] * w[1]) + (v_[2] * w[2] + v_[3] * w[3]);
    return (v_[0] * w[0] + v_[1] * w[1]) + v_[2] * w[2];
  }
  [[nodiscard]] Weights moved(Weights w, const Vec3& step) const {
    for (unsigned i = 0; i < N; ++i) w[i] += dot(gradient_[i], step);
    return w;
  }
  [[nodiscard]] const Vec3& gradient(unsigned i) const { return gradient_[i]; }
  [[nodiscard]] Vec3 normal(unsigned i) const { return gradient_[i] * (1.0 / steepness_[i]); }  ///< of facet i, inward
  [[nodiscard]] double height(const Weights& w, unsigned i) const { return w[i] / steepness_[i]; }  ///< over facet i

  /// The coordinates of the point of the simplex next to the one that has coordinates w, up to rounding.
  [[nodiscard]] Weights inside(Weights w) const {
    for (unsigned turn = 0; turn < N; ++turn) {
      const auto i = static_cast<unsigned>(std::min_element(w.begin(), w.end()) - w.begin());
      if (!(w[i] < 0.0)) break;
      w = moved(w, normal(i) * -height(w, i));
      w[i] = 0.0;
    }
    double sum = 0.0;
    for (double& c : w) sum += c = std::max(c, 0.0);
    for (double& c : w) c /= sum;
    return w;
  }

  /// Moves the point from the facet that it is next to, into the middle between it and the nearest one that faces it.
  [[nodiscard]] Weights centred(const Weights& w) const {
    std::array<double, N> h;
    for (unsigned i = 0; i < N; ++i) h[i] = height(w, i);
    const auto next = static_cast<unsigned>(std::min_element(h.begin(), h.end()) - h.begin());
    unsigned facing = next;
    for (unsigned i = 0; i < N; ++i) {
      const bool faces = i != next && dot(normal(i), normal(next)) < -0.5;
      if (faces && (facing == next || h[i] < h[facing])) facing = i;
    }
    if (facing == next) return w;
    const Vec3 across = normal(next) - normal(facing);
    const Weights middle = moved(w, across * ((h[facing] - h[next]) / dot(across, across)));
    for (unsigned i = 0; i < N; ++i) {
      if (!(height(middle, i) > 0.5 * h[next])) return w;  // a third facet is in the way
    }
    return middle;
  }

 private:
  std::array<Vec3, N> v_;
  double volume_;
  std::array<Vec3, N> gradient_;
  std::array<double, N> steepness_;
};

/// The effect of a step on the coordinates, as shares of the loss allowed to each. Its effect on the place, as shares
/// of the distance allowed.
template <std::size_t N>
using Effect = std::array<double, N + 3>;

template <std::size_t M>
double dot(const std::array<double, M>& a, const std::array<double, M>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
template <std::size_t M>
void subtract(std::array<double, M>& a, double n, const std::array<double, M>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= n * b[i];
}

/// A basis of a lattice of steps, reduced in the norm of their effects.
template <std::size_t N>
class LatticeBasis {
 public:
  using Effect = detail::Effect<N>;

  /// `unit`: the lattice's spacing along each axis; `effect_of`: linear in a step.
  template <class EffectOf>
  LatticeBasis(const Vec3& unit, const EffectOf& effect_of) : step_{Vec3{unit.x, 0.0, 0.0}, Vec3{0.0, unit.y, 0.0}} {
    if constexpr (axes == 3) step_[2] = {0.0, 0.0, unit.z};
    for (unsigned k = 0; k < axes; ++k) effect_[k] = effect_of(step_[k]);
    orthogonalize();
    constexpr int max_rounds = 1000;  // rounding may keep it from ending
    unsigned k = 1;
    for (int round = 0; k < axes && round < max_rounds; ++round) {
      if (shorten(k, effect_of)) continue;  // large factors are rounded: once more
      const double mu = share(effect_[k], k - 1);
      if (dot(own_[k], own_[k]) >= (0.75 - mu * mu) * dot(own_[k - 1], own_[k - 1])) {
        ++k;
        continue;
      }
      std::swap(step_[k], step_[k - 1]);
      std::swap(effect_[k], effect_[k - 1]);
      orthogonalize();
      k = std::max(k - 1, 1U);
    }
  }

  /// The step of the lattice whose effect is about the one wanted.
  [[nodiscard]] Vec3 nearest(Effect wanted) const {
    Vec3 sum;
    for (unsigned k = axes; k-- > 0;) {
      const double n = std::nearbyint(share(wanted, k));
      subtract(wanted, n, effect_[k]);
      sum += step_[k] * n;
    }
    return sum;
  }

 private:
  [[nodiscard]] double share(const Effect& e, unsigned k) const { return dot(e, own_[k]) / dot(own_[k], own_[k]); }

  // Subtracts multiples of the steps before from step k; false if there is nothing to subtract.
  template <class EffectOf>
  bool shorten(unsigned k, const EffectOf& effect_of) {
    bool shortened = false;
    for (unsigned j = k; j-- > 0;) {
      const double n = std::nearbyint(share(effect_[k], j));
      if (n == 0.0) continue;
      step_[k] -= step_[j] * n;
      effect_[k] = effect_of(step_[k]);
      shortened = true;
    }
    if (shortened) orthogonalize();
    return shortened;
  }

  void orthogonalize() {
    own_ = effect_;
    for (unsigned k = 1; k < axes; ++k) {
      for (unsigned j = 0; j < k; ++j) subtract(own_[k], share(own_[k], j), own_[j]);
    }
  }

  static constexpr std::size_t axes = N - 1;

  std::array<Vec3, axes> step_;
  std::array<Effect, axes> effect_;
  std::array<Effect, axes> own_;  // what each adds to the effects of those before
};

/// A double close to the point with coordinates `room`, at most about `distance` away. None of the coordinates is lost
/// if one is found as close as the room allows.
template <std::size_t N>
Vec3 representable_near(const Coordinates<N>& coordinates, const std::array<double, N>& room, double distance) {
  const Vec3 middle = coordinates.place(room);
  const auto spacing = [&](double c) {
    const double large = std::max({std::abs(c), distance, smallest_magnitude});
    return std::max(large * std::numeric_limits<double>::epsilon(), smallest_magnitude);
  };
  const auto power_of_two = [](double s) { return std::ldexp(1.0, std::ilogb(s)); };
  const Vec3 unit = {power_of_two(spacing(middle.x)), power_of_two(spacing(middle.y)), power_of_two(spacing(middle.z))};
  Vec3 found = {std::nearbyint(middle.x / unit.x) * unit.x, std::nearbyint(middle.y / unit.y) * unit.y,
                std::nearbyint(middle.z / unit.z) * unit.z};
  const auto effect_of = [&](const Vec3& step) {
    Effect<N> e{};
    for (unsigned i = 0; i < N; ++i) e[i] = dot(coordinates.gradient(i), step) / room[i];
    e[N] = step.x / distance;
    e[N + 1] = step.y / distance;
    e[N + 2] = step.z / distance;
    return e;
  };
  const LatticeBasis<N> basis(unit, effect_of);
  constexpr int corrections = 4;  // the effects of long steps are rounded: each time a small part of the rest is left
  for (int turn = 0; turn < corrections; ++turn) {
    const std::array<double, N> here = coordinates.at(found);
    Effect<N> wanted = effect_of(middle - found);
    for (unsigned i = 0; i < N; ++i) wanted[i] = (room[i] - here[i]) / room[i];
    found += basis.nearest(wanted);
  }
  return flushed(found);
}

/// A double in the closed simplex close to x, a point at most a few units in the last place outside. Nothing if none is
/// found: the simplex may be thinner than a unit in the last place. At an edge of a small angle a, the distance is of
/// the order of a^(-1/3) units. This is optimal. Cost: some 10 us for each doubling of the distance. Precondition: the
/// simplex is positive.
template <std::size_t N>
std::optional<Vec3> representable_inside(const std::array<Vec3, N>& v, const Vec3& x) {
  const Coordinates<N> coordinates(v);
  const std::array<double, N> next = coordinates.inside(coordinates.at(x));
  double size = 0.0;
  for (const Vec3& corner : v) size = std::max(size, norm(corner - x));
  for (int k = std::numeric_limits<double>::digits; k > 0; --k) {
    const double drawn = std::ldexp(1.0, -k);  // towards the simplex's mean, if there is more room
    std::array<double, N> room;
    for (unsigned i = 0; i < N; ++i) room[i] = (1.0 - drawn) * next[i] + drawn * (1.0 / N);
    for (int turn = 0; turn < 3; ++turn) room = coordinates.centred(room);
    const Vec3 found = representable_near(coordinates, room, drawn * size);
    if (in_closed_simplex(v, found)) return found;
  }
  return {};
}

}  // namespace dartcast::detail
