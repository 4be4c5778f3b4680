// Shape matching: the best rotation or linear transformation of each region, and the goals that follow.
#include "bodies/shape_matching.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.hpp"
#include "bodies/rotation.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// A principal moment below this share of the greatest one is 0. The region is flat across it, up to rounding of its
// points (relative to its size by 2^-20 at most).
constexpr double flat_share = 0x1p-40;

constexpr double min_volume = 0.125;  // share of the volume at rest that keep_volume takes for a squeezed body's

Mat3 from_eigen(const Eigen::Matrix3d& m) {
  return {{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}};
}

// The inverse of a symmetric matrix on the space that it spans, and the projection onto its complement.
struct Inverse {
  Mat3 inverse;
  Mat3 not_spanned;
};
Inverse inverse_where_spanned(const Mat3& a) {
  Eigen::Matrix3d m;
  m << a.x.x, a.y.x, a.z.x, a.x.y, a.y.y, a.z.y, a.x.z, a.y.z, a.z.z;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  const Eigen::Vector3d& values = solver.eigenvalues();  // increasing
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = solver.eigenvectors().col(i);
    if (values[i] > flat_share * values[2])
      inverse += e * e.transpose() / values[i];
    else
      across += e * e.transpose();
  }
  return {from_eigen(inverse), from_eigen(across)};
}

void check_shape(std::span<const Vec3> points, std::span<const double> masses, const MatchOptions& options) {
  if (points.empty()) throw InvalidArgument("rest shape: there is no point");
  if (masses.size() != points.size())
    throw InvalidArgument(fmt::format("rest shape: {} masses for {} points", masses.size(), points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) throw InvalidArgument(fmt::format("rest shape: point {} is not finite", i));
    if (!is_mass(masses[i]))
      throw InvalidArgument(
          fmt::format("rest shape: the mass of point {} is {}: it must be between 2^-300 and 2^300", i, masses[i]));
  }
  if (!(options.linear >= 0.0 && options.linear <= 1.0))
    throw InvalidArgument("rest shape: the linear share must be between 0 and 1");
}

// The number of clusters of each point.
std::vector<double> counted(const std::vector<std::vector<std::uint32_t>>& clusters, std::size_t size) {
  std::vector<double> count(size, 0.0);
  std::vector<std::size_t> last(size, 0);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].empty()) throw InvalidArgument(fmt::format("rest shape: cluster {} is empty", c));
    for (const std::uint32_t i : clusters[c]) {
      if (i >= size) throw InvalidArgument(fmt::format("rest shape: cluster {} names point {} of {}", c, i, size));
      if (last[i] == c + 1) throw InvalidArgument(fmt::format("rest shape: cluster {} names point {} twice", c, i));
      last[i] = c + 1;
      count[i] += 1.0;
    }
  }
  const auto left_out = std::find(count.begin(), count.end(), 0.0);
  if (left_out != count.end())
    throw InvalidArgument(fmt::format("rest shape: point {} is in no cluster", left_out - count.begin()));
  return count;
}

}  // namespace

RestShape::RestShape(std::span<const Vec3> points, std::span<const double> masses, const MatchOptions& options)
    : linear_(options.linear), keep_volume_(options.keep_volume), masses_(masses.begin(), masses.end()) {
  check_shape(points, masses, options);
  auto clusters = options.clusters;
  if (clusters.empty()) {
    clusters.emplace_back();
    for (std::uint32_t i = 0; i < points.size(); ++i) clusters.back().push_back(i);
  }
  shares_ = counted(clusters, points.size());
  for (double& s : shares_) s = 1.0 / s;
  for (const auto& cluster : clusters) add_region(cluster, points);
}

void RestShape::add_region(std::span<const std::uint32_t> particles, std::span<const Vec3> points) {
  Region region{0.0, zero_matrix(), {}, {}};
  Vec3 sum;  // relative to a point of it, for less rounding
  const Vec3 origin = points[particles.front()];
  for (const std::uint32_t i : particles) {
    const double weight = masses_[i] * shares_[i];
    region.mass += weight;
    sum += (points[i] - origin) * weight;
  }
  const Vec3 centre = sum * (1.0 / region.mass);
  for (const std::uint32_t i : particles) {
    const Member member{i, masses_[i] * shares_[i], (points[i] - origin) - centre};
    region.moments = region.moments + outer(member.rest * member.weight, member.rest);
    members_.push_back(member);
  }
  const Inverse found = inverse_where_spanned(region.moments);
  region.inverse = found.inverse;
  region.not_spanned = found.not_spanned;
  regions_.push_back(region);
  first_.push_back(members_.size());
}

unsigned RestShape::match(std::span<const Vec3> positions, std::span<Fit> fits) const {
  unsigned fallbacks = 0;
  for (std::size_t c = 0; c < regions_.size(); ++c) {
    const std::span<const Member> members(members_.data() + first_[c], first_[c + 1] - first_[c]);
    Vec3 sum;
    const Vec3 origin = positions[members.front().particle];
    for (const Member& m : members) sum += (positions[m.particle] - origin) * m.weight;
    fits[c].centre = origin + sum * (1.0 / regions_[c].mass);
    Mat3 covariance = zero_matrix();
    for (const Member& m : members) {
      const Vec3 x = (positions[m.particle] - fits[c].centre) * m.weight;
      covariance = covariance + outer(x, m.rest);
    }
    const Rotation r = nearest_rotation(covariance, fits[c].rotation);
    fallbacks += r.fallback ? 1 : 0;
    fits[c].rotation = r.q;
    fit(regions_[c], covariance, fits[c]);
  }
  return fallbacks;
}

// Across a flat region the linear transformation is the rotation, because the points determine nothing else.
void RestShape::fit(const Region& region, const Mat3& covariance, Fit& fit) const {
  const Mat3 rotation = matrix(fit.rotation);
  fit.transform = rotation;
  fit.strain = 0.0;
  if (linear_ == 0.0) return;
  Mat3 best = covariance * region.inverse + rotation * region.not_spanned;
  if (keep_volume_) best = best * (1.0 / cube_root(std::max(determinant(best), min_volume)));
  const Mat3 beyond = best - rotation;
  fit.transform = rotation + beyond * linear_;
  fit.strain = 0.5 * linear_ * (1.0 - linear_) * dot(beyond * region.moments, beyond);
}

double RestShape::goals(std::span<const Fit> fits, std::span<Vec3> goals) const {
  std::fill(goals.begin(), goals.end(), Vec3{});
  double constant = 0.0;
  for (std::size_t c = 0; c < regions_.size(); ++c) {
    constant += fits[c].strain;
    for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
      const Member& m = members_[k];
      goals[m.particle] += (fits[c].centre + fits[c].transform * m.rest) * shares_[m.particle];
    }
  }
  return regions_.size() == 1 ? constant : constant + spread(fits, goals);
}

// sum of weight |goal of the region - mean goal|^2 / 2.
double RestShape::spread(std::span<const Fit> fits, std::span<const Vec3> goals) const {
  double sum = 0.0;
  for (std::size_t c = 0; c < regions_.size(); ++c) {
    for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
      const Member& m = members_[k];
      const Vec3 off = (fits[c].centre + fits[c].transform * m.rest) - goals[m.particle];
      sum += 0.5 * m.weight * dot(off, off);
    }
  }
  return sum;
}

double matching_energy(const RestShape& shape, std::span<const Vec3> positions, std::span<const Vec3> goals,
                       double constant) {
  double sum = constant;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 off = positions[i] - goals[i];
    sum += 0.5 * shape.masses()[i] * dot(off, off);
  }
  return sum;
}

std::vector<std::vector<std::uint32_t>> overlapping_clusters(std::span<const Vec3> points, double size) {
  constexpr double limit = 0x1p+20;
  if (!(size > 0.0)) throw InvalidArgument("clusters: the size must be positive");
  const auto bad = std::find_if_not(points.begin(), points.end(), is_finite);
  if (bad != points.end()) throw InvalidArgument(fmt::format("clusters: point {} is not finite", bad - points.begin()));
  if (points.empty()) return {};
  Vec3 low = points.front();
  for (const Vec3& p : points) low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  using Cube = std::array<std::int32_t, 3>;
  std::vector<std::pair<Cube, std::uint32_t>> entries;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 at = (points[i] - low) * (2.0 / size);
    if (!(std::max({at.x, at.y, at.z}) < limit))
      throw InvalidArgument("clusters: the size is too small for the extent of the points");
    const Cube first = {static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                        static_cast<std::int32_t>(at.z)};
    for (int k = 0; k < 8; ++k)  // cube p covers lattice intervals p and p + 1
      entries.push_back({{first[0] - (k & 1), first[1] - (k >> 1 & 1), first[2] - (k >> 2)}, i});
  }
  std::sort(entries.begin(), entries.end());
  std::vector<std::vector<std::uint32_t>> clusters;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    if (e == 0 || entries[e].first != entries[e - 1].first) clusters.emplace_back();
    clusters.back().push_back(entries[e].second);
  }
  return clusters;
}

}  // namespace dartcast
