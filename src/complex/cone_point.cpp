// Finds a point from which a cell can be coned.
#include "complex/cone_point.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "dartcast/predicates.hpp"

namespace dartcast::detail {

Vec3 mean(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  Vec3 sum;
  for (const std::uint32_t v : corners) sum += points[v];
  return sum * (1.0 / static_cast<double>(corners.size()));
}

bool all_positive(const Vec3& apex, std::span<const ConeTriangle> triangles) {
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const ConeTriangle& t) { return orient3d(apex, t.a, t.b, t.c) == Sign::positive; });
}

namespace {

struct ConeFacet {
  Vec3 at, inward;  // inward: of length 1
};

std::vector<ConeFacet> facets_of(std::span<const ConeTriangle> triangles, double size) {
  std::vector<ConeFacet> facets;
  facets.reserve(triangles.size());
  for (const ConeTriangle& t : triangles) {
    Vec3 n = cross((t.c - t.a) * (1.0 / size), (t.b - t.a) * (1.0 / size));  // of a magnitude that can be squared
    const double length = norm(n);
    if (!(length > 0.0)) continue;
    n *= 1.0 / length;
    facets.push_back({t.a, n});
  }
  return facets;
}

// A point strictly behind all triangles, found by moving away from the nearest one; `start` if none is found. The
// result is only a proposal: the validity check decides.
Vec3 kernel_point(const Vec3& start, std::span<const ConeTriangle> triangles, double size) {
  constexpr int steps = 400;
  Vec3 x = start;
  Vec3 best = start;
  double best_distance = -size;
  const std::vector<ConeFacet> facets = facets_of(triangles, size);
  for (int k = 0; k < steps; ++k) {
    double nearest = 2.0 * size;
    Vec3 inward;
    for (const ConeFacet& f : facets) {
      const double distance = dot(f.inward, x - f.at);
      if (distance < nearest) {
        nearest = distance;
        inward = f.inward;
      }
    }
    if (nearest > best_distance) {
      best_distance = nearest;
      best = x;
    }
    x += inward * (0.25 * size / (k + 2.0));
  }
  return best;
}

}  // namespace

std::vector<double> weights_for(const Vec3& x, std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  const Vec3 m = mean(points, corners);
  const auto n = static_cast<Eigen::Index>(corners.size());
  Eigen::Matrix3Xd centred(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 d = points[corners[static_cast<std::size_t>(i)]] - m;
    centred.col(i) << d.x, d.y, d.z;
  }
  const Eigen::Vector3d offset(x.x - m.x, x.y - m.y, x.z - m.z);
  const Eigen::Matrix3d gram = centred * centred.transpose();
  const Eigen::VectorXd correction = centred.transpose() * gram.ldlt().solve(offset);
  std::vector<double> weights(corners.size());
  for (Eigen::Index i = 0; i < n; ++i)
    weights[static_cast<std::size_t>(i)] = 1.0 / static_cast<double>(n) + correction(i);
  return weights;
}

std::vector<double> cone_weights(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                 std::span<const ConeTriangle> triangles) {
  const Vec3 m = mean(points, corners);
  std::vector<double> equal(corners.size(), 1.0 / static_cast<double>(corners.size()));
  if (all_positive(m, triangles)) return equal;
  double size = 0.0;
  for (const std::uint32_t v : corners) size = std::max(size, norm(points[v] - m));
  const Vec3 x = kernel_point(m, triangles, size);
  return all_positive(x, triangles) ? weights_for(x, points, corners) : equal;
}

}  // namespace dartcast::detail
