// Lays triangles out in the plane, and finds the edge or corner by which a ray leaves.
#include "surface/unfold.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast::detail {

namespace {

// A weight or a rate below this is 0. It is far below rounding, and products of larger values are in the exact range.
constexpr double smallest_weight = 0x1p-200;

double twice_area(const Vec3& a, const Vec3& b, const Vec3& c, double Vec3::*u, double Vec3::*v) {
  const auto flat = [&](const Vec3& p) { return Vec3{p.*u, p.*v, 0.0}; };
  return orient2d_value(flat(a), flat(b), flat(c));
}

double length_of(const Vec3& v) { return hypotenuse(v.x, v.y, v.z); }

struct UnfoldedEdges {
  Vec3 base, side;  // from a to b, and to c; scaled
  double scale;
};

UnfoldedEdges edges_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 base = b - a;
  const Vec3 side = c - a;
  const Vec3 extent = extent_of(base, side);
  const double scale = std::ldexp(1.0, -std::ilogb(std::max({extent.x, extent.y, extent.z})));
  return {base * scale, side * scale, scale};
}

// The vector (b - a) x (c - a), scaled. In a thin triangle the products cancel, and each is then computed exactly.
Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c, const UnfoldedEdges& e) {
  const Vec3 n = cross(e.base, e.side);
  const double square = dot(n, n);
  if (square > 0x1p-900 && square > 0x1p-8 * dot(e.base, e.base) * dot(e.side, e.side)) return n;
  return Vec3{twice_area(a, b, c, &Vec3::y, &Vec3::z), twice_area(a, b, c, &Vec3::z, &Vec3::x),
              twice_area(a, b, c, &Vec3::x, &Vec3::y)} *
         e.scale * e.scale;
}

Heading unit(double along, double across) {
  const double length = hypotenuse(along, across);
  return {along / length, across / length};
}

// The speed at which the weights change, up to a factor: weight i changes by the length along the ray times rate[i] /
// area.
struct Rates {
  TriangleWeights rate;
  double area;
};

Rates rates_of(const Unfolded& t, const Heading& h) {
  TriangleWeights rate = {(t.x - t.length) * h.across - t.height * h.along, t.height * h.along - t.x * h.across,
                          t.length * h.across};
  const double largest = std::max({std::abs(rate[0]), std::abs(rate[1]), std::abs(rate[2])});
  for (double& r : rate) r = std::abs(r) < smallest_weight * largest ? 0.0 : r / largest;
  return {rate, t.length * t.height / largest};
}

// The determinant a d - b c of numbers that are 0, or at least 2^-200 and at most 1. It has the exact sign and is
// accurate to some 2^-53 of the larger product. Each product is off by 2^-53 of itself, and so is their difference.
double determinant(double a, double b, double c, double d) {
  const double ad = a * d;
  const double bc = b * c;
  if (std::abs(ad - bc) > 0x1p-20 * std::max(ad, bc)) return ad - bc;
  return orient2d_value({}, {a, b, 0.0}, {c, d, 0.0});
}

// Leaves by edge i, if the remaining part of weight j is known: it is accurate to rounding of itself.
Exit by_edge(const TriangleWeights& from, const Rates& r, unsigned i, unsigned j, double left) {
  const unsigned k = 3 - i - j;
  Exit exit;
  exit.weights[i] = 0.0;
  exit.weights[j] = left;
  exit.weights[k] = from[k] + from[i] * (r.rate[k] / -r.rate[i]);
  exit.weights = normalized(exit.weights);
  exit.length = from[i] * r.area / -r.rate[i];
  return exit;
}

// Leaves straight to the apex. If no weight decreases, the ray runs there: see way_out().
Exit to_apex(const Unfolded& t, const TriangleWeights& from) {
  const double x = from[1] * t.length + from[2] * t.x;
  return {{0.0, 0.0, 1.0}, hypotenuse(t.x - x, t.height - from[2] * t.height)};
}

}  // namespace

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return twice_area(a, b, c, &Vec3::x, &Vec3::y) != 0.0 || twice_area(a, b, c, &Vec3::y, &Vec3::z) != 0.0 ||
         twice_area(a, b, c, &Vec3::z, &Vec3::x) != 0.0;
}

Unfolded unfold(const Vec3& a, const Vec3& b, const Vec3& c) {
  const UnfoldedEdges e = edges_of(a, b, c);
  Unfolded t;
  t.length = length_of(e.base);
  t.x = dot(e.base, e.side) / t.length;
  t.height = length_of(normal_of(a, b, c, e)) / t.length;
  t.scale = e.scale;
  return t;
}

Frame frame_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const UnfoldedEdges e = edges_of(a, b, c);
  const auto divided = [](const Vec3& v) {
    const double length = length_of(v);
    return Vec3{v.x / length, v.y / length, v.z / length};
  };
  Frame f;
  f.along = divided(e.base);
  f.normal = divided(normal_of(a, b, c, e));
  f.across = cross(f.normal, f.along);
  return f;
}

Heading turned_to(const Unfolded& t, unsigned edge, const Heading& h) {
  const double x = edge == 1 ? t.x - t.length : -t.x;
  const double y = edge == 1 ? t.height : -t.height;
  return unit(h.along * x + h.across * y, h.across * x - h.along * y);
}

double angle_at_base(const Unfolded& t) { return polar_angle(t.height, t.x); }

TriangleWeights normalized(TriangleWeights w) {
  for (double& x : w) x = x < smallest_weight ? 0.0 : x;
  const auto largest = static_cast<unsigned>(std::max_element(w.begin(), w.end()) - w.begin());
  w[largest] = 1.0 - (w[(largest + 1) % 3] + w[(largest + 2) % 3]);
  return w;
}

bool are_weights(const TriangleWeights& w) {
  const auto is_weight = [](double x) { return x == 0.0 || (x >= smallest_weight && x <= 1.0); };
  return std::all_of(w.begin(), w.end(), is_weight) && std::abs(((w[0] + w[1]) + w[2]) - 1.0) <= 0x1p-50;
}

// Only a weight that is not 0 can decrease. So a ray does not leave by the edge or the corner from which it starts, no
// matter how numbers were rounded. At least one weight decreases. With u = t.x - t.length rounded, u <= t.x, and so u
// across <= x across for across >= 0, rounded or not. Hence rate[0] and rate[1] are not both positive. If both are 0,
// the ray runs to the apex as exactly as doubles can represent. With across < 0 rate[2] is negative.
Exit way_out(const Unfolded& t, const TriangleWeights& from, const Heading& h) {
  const Rates r = rates_of(t, h);
  std::array<unsigned, 3> falling{};
  unsigned count = 0;
  for (unsigned i = 0; i < 3; ++i) {
    if (r.rate[i] < 0.0 && from[i] > 0.0) falling[count++] = i;
  }
  if (count == 0) return to_apex(t, from);
  const unsigned i = falling[0];
  const unsigned j = falling[1];
  if (count == 1) {
    const unsigned k = (i + 1) % 3;
    return by_edge(from, r, i, k, from[k] + from[i] * (r.rate[k] / -r.rate[i]));
  }
  // If this is negative, from[i] / -rate[i] < from[j] / -rate[j].
  const double order = determinant(from[i], from[j], -r.rate[i], -r.rate[j]);
  if (order > 0.0) return by_edge(from, r, j, i, order / -r.rate[j]);
  return by_edge(from, r, i, j, -order / -r.rate[i]);
}

}  // namespace dartcast::detail
