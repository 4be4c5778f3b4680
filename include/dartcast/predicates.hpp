// Exact signs of determinants of stored doubles (guarantee G1).
//
// A filter with a proven bound decides almost all signs. On lattices, where zeros are common, a test proves that the
// doubles are exact. The remaining signs go to floating-point expansions. This work is based on J. R. Shewchuk,
// "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// One rule holds for all coordinates of vertices, particles and targets. Below smallest_magnitude a coordinate counts
/// as 0 in every decision. Up to largest_magnitude signs are exact: no product of three differences overflows, and none
/// has a digit below the smallest double. A point or a target beyond that is refused. A vertex may move there; then the
/// simplices at it are invalid until it is back.
inline constexpr double smallest_magnitude = 0x1p-300;
inline constexpr double largest_magnitude = 0x1p+300;

/// Whether exact signs can be taken of determinants of this point: it is finite, and at most largest_magnitude.
inline bool in_exact_range(const Vec3& p) {
  return std::abs(p.x) <= largest_magnitude && std::abs(p.y) <= largest_magnitude && std::abs(p.z) <= largest_magnitude;
}

/// The point with the coordinates that decisions see: those below smallest_magnitude are 0.
inline Vec3 flushed(Vec3 x) {
  const auto flush = [](double& c) {
    if (std::abs(c) < smallest_magnitude) c = 0.0;
  };
  flush(x.x);
  flush(x.y);
  flush(x.z);
  return x;
}

/// A sign, or `undecidable` if a coordinate is not finite or above largest_magnitude. It is never a wrong sign.
enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1, undecidable = 2 };

constexpr Sign operator-(Sign s) { return s == Sign::undecidable ? s : static_cast<Sign>(-static_cast<int>(s)); }

/// Sign of det[b - a, c - a, d - a]. It is positive if a, b, c turn counterclockwise as seen from d. The volume of
/// the tetrahedron (a, b, c, d) is a sixth of the determinant. Cost: about 7 ns when the filter decides, 25 ns on
/// lattices, 0.1 to 2 us elsewhere.
Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same, counting in `exact` the signs that the filter left open.
Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint64_t& exact);

/// The same sign without the filter, for callers that have filtered a batch themselves.
Sign orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The bound of a filter. A determinant u . (v x w) of differences of stored doubles is evaluated in doubles in this
/// order. It is off by at most determinant_error times m, as long as bound_holds(). Here m is the product of the
/// largest |x|, |y| and |z| among u, v and w. Shewchuk's bound is (7 + 56 e) e of the permanent, with e = 2^-53, and
/// the permanent is at most 6 m. The last factor covers three things:
///
///  - the rounding of m;
///  - products that underflow: at most 6 * 2^-1075 * 2^301, against e m >= 2^-755;
///  - coordinates that count as 0. They change a difference by less than 2^-299, so the determinant by less than 18 *
///    2^-299 m / 2^-234 < 2^-60 m.
inline constexpr double determinant_error = 6.0 * (7.0 + 56.0 * 0x1p-53) * 0x1p-53 * (1.0 + 0x1p-10);

/// The range of the three factors of m (two in the plane): for the bound to hold, and for a filter to decide. (If a
/// factor is not a number, so is the bound, or the value, and nothing exceeds it.) A coordinate beyond
/// largest_magnitude is at least 2^248 away from any other double. So if a filter decides, all coordinates are
/// within the exact range, although it looks only at differences.
inline constexpr double smallest_extent = 0x1p-234;
inline constexpr double largest_extent = 0x1p+301;
inline constexpr double largest_decided_extent = 0x1p+247;

/// Whether all components are in [smallest_extent, largest].
constexpr bool are_extents(const Vec3& e, double largest) {
  return std::max(std::max(e.x, e.y), e.z) <= largest && std::min(std::min(e.x, e.y), e.z) >= smallest_extent;
}
/// Whether determinant_error bounds the error of a determinant of differences up to this large.
constexpr bool bound_holds(const Vec3& extent) { return are_extents(extent, largest_extent); }
/// Whether a filter may decide: bound_holds(), and all coordinates are within the exact range.
constexpr bool filter_applies(const Vec3& extent) { return are_extents(extent, largest_decided_extent); }

/// The largest |x|, |y| and |z| among some vectors. A component that is infinite makes the result infinite. One that is
/// not a number makes the result not a number, or is ignored.
template <class... Vectors>
Vec3 extent_of(const Vec3& first, const Vectors&... rest) {
  Vec3 largest = {std::abs(first.x), std::abs(first.y), std::abs(first.z)};
  const auto larger = [](double a, double b) { return a < b ? b : a; };  // one instruction
  const auto include = [&](const Vec3& v) {
    largest = {larger(largest.x, std::abs(v.x)), larger(largest.y, std::abs(v.y)), larger(largest.z, std::abs(v.z))};
  };
  (include(rest), ...);
  return largest;
}

/// Whether arithmetic on the differences of these points rounds nothing. `extent` is that of the differences. It rounds
/// nothing if every coordinate is a multiple of a unit g of its axis, and the differences are below 2^16 g. Then the
/// differences are exact. So is every sum of products of one factor from each axis, if it stays below 2^53 units. Such
/// are a determinant of three differences (below 2^51), and two of them in a product with the sum of three more. The
/// result is false if a coordinate is not finite. Precondition: such products do not underflow or overflow. This is so
/// with bound_holds(), or if each extent is 0 or in [2^-250, 2^301].
///
/// Proof. Let g be the unit in the last place of c = 2^37 extent, so that g > 2^-53 c = 2^-16 extent. (If c is so small
/// that g is the smallest double, extent is below 2^16 g, too.) The sum |x| + c is at least c, so it rounds to a
/// multiple of g. Subtracting c leaves a multiple of g, however it is rounded. So the result can equal |x| only if |x|
/// is a multiple of g. Conversely it does equal |x| if |x| is a multiple of g below c. With bound_holds(), each g is
/// above 2^-16 2^-234. So no product is below the smallest double, and no coordinate that counts as 0 is a multiple of
/// g, unless it is 0.
template <class... Points>
bool rounds_nothing(const Vec3& extent, const Points&... points) {
  const Vec3 c = 0x1p+37 * extent;
  const auto off = [](double x, double unit) {
    const double m = std::abs(x);
    return std::abs(((m + unit) - unit) - m);
  };
  return (((off(points.x, c.x) + off(points.y, c.y)) + off(points.z, c.z)) + ...) == 0.0;
}

/// Sign of det[b - a, c - a] of x and y alone. It is positive if a, b, c turn counterclockwise. Half of the
/// determinant is the area of the triangle. Exactness and cost as for orient3d().
Sign orient2d(const Vec3& a, const Vec3& b, const Vec3& c);

/// The same, counting in `exact` the signs that the filter left open.
Sign orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::uint64_t& exact);

/// The same sign without the filter.
Sign orient2d_exact(const Vec3& a, const Vec3& b, const Vec3& c);

/// The determinant of orient2d() as a double, accurate to 2^-49 of itself, with the exact sign. Not a number if a
/// coordinate is outside the range.
double orient2d_value(const Vec3& a, const Vec3& b, const Vec3& c);

/// A determinant in the plane is a b' - a' b, of differences of stored doubles. It is off by at most plane_error times
/// m, as long as plane_bound_holds(). Here m is the product of the largest |x| and |y| among them. Shewchuk's bound is
/// (3 + 16 e) e of the permanent, which is at most 2 m. The last factor covers the same as that of determinant_error.
/// Coordinates that count as 0 change the determinant by less than 4 * 2^-299 m / 2^-234 < 2^-62 m.
inline constexpr double plane_error = 2.0 * (3.0 + 16.0 * 0x1p-53) * 0x1p-53 * (1.0 + 0x1p-10);
/// Whether both are in [smallest_extent, largest].
constexpr bool are_plane_extents(double x, double y, double largest) {
  return std::max(x, y) <= largest && std::min(x, y) >= smallest_extent;
}
/// As bound_holds(), for plane_error.
constexpr bool plane_bound_holds(double x, double y) { return are_plane_extents(x, y, largest_extent); }
/// As filter_applies(), for plane_error.
constexpr bool plane_filter_applies(double x, double y) { return are_plane_extents(x, y, largest_decided_extent); }

/// The determinant of orient3d() as a double, accurate to 2^-49 of itself, with the exact sign (0 only if it is 0).
/// Not a number if a coordinate is outside the range.
double orient3d_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// A point infinitesimally beside p, for ties: p + e w + (e^2, e^3, e^4). Here w is the sum of (opposite vertex - p)
/// over the facets on which p lies (none: w = 0). The first term that does not vanish decides, so no tie remains.
class SymbolicPerturbation {
 public:
  /// `opposite`: the vertices opposite to the facets on which p lies; at most 3.
  SymbolicPerturbation(const Vec3& p, std::span<const Vec3> opposite);

  /// Sign of orient3d(a, b, p + shift, q + shift) if orient3d(a, b, p, q) is zero. Zero only if pq is parallel to
  /// ab.
  [[nodiscard]] Sign of_line(const Vec3& a, const Vec3& b, const Vec3& q) const;

 private:
  [[nodiscard]] Sign of_line_exact(const Vec3& a, const Vec3& b, const Vec3& q) const;

  Vec3 p_;
  std::array<Vec3, 3> opposite_;  // p itself if there are fewer: it adds nothing
};

/// The same in the plane: p + e w + (e^2, e^3).
class PlanarSymbolicPerturbation {
 public:
  /// `opposite`: the vertices opposite to the facets on which p lies; at most 2.
  PlanarSymbolicPerturbation(const Vec3& p, std::span<const Vec3> opposite);

  /// Sign of orient2d(p + shift, q0 + shift, c) if orient2d(p, q0, c) is zero, whatever c. Zero only if p is q0.
  [[nodiscard]] Sign of_line(const Vec3& q0) const;

 private:
  Vec3 p_;
  std::array<Vec3, 2> opposite_;
};

}  // namespace dartcast
