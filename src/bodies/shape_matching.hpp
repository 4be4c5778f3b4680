// Shape matching: goals for the particles of a body, in its rest shape, as near as possible to their positions.
//
// M. Mueller, B. Heidelberger, M. Teschner, M. Gross, "Meshless deformations based on shape matching", SIGGRAPH 2005.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dynamics/mat3.hpp"

namespace dartcast {

/// A rest shape with masses. It may be flat, a line, or a single point.
///
/// The matching energy per stiffness, for particles at x and goals g of fixed fits, is constant + sum m |x - g|^2 /
/// 2, so that the force per stiffness is -m (x - g). If the fits are those of match(), without keep_volume or with
/// linear = 0, the energy is the least over all fits. Then its derivative is that force, so it is the potential of
/// the force.
class RestShape {
 public:
  /// `masses`: one per point. Throws InvalidArgument if there is no point, a mass is out of range (is_mass()), a
  /// point is not finite, or linear is outside [0, 1]. Throws it, too, if a cluster is empty, or names a missing point
  /// or one twice, or if a point is in no cluster.
  RestShape(std::span<const Vec3> points, std::span<const double> masses, const MatchOptions& options = {});

  [[nodiscard]] std::size_t size() const { return masses_.size(); }
  [[nodiscard]] std::size_t cluster_count() const { return first_.size() - 1; }
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  /// Whether match() gives the fits of least energy.
  [[nodiscard]] bool has_least_fits() const { return !keep_volume_ || linear_ == 0.0; }

  /// Fits the regions to the particles' positions. `fits`: one per cluster; in: the last ones, whose rotations are
  /// guesses; out: the new ones. Returns the number of rotations that needed the fallback. Preconditions: sizes
  /// match. Cost: about 10 ns per member of a cluster, 100 ns per cluster.
  unsigned match(std::span<const Vec3> positions, std::span<Fit> fits) const;

  /// Sets the goals of the fits. Returns the constant of the energy. Cost: a few ns per member.
  double goals(std::span<const Fit> fits, std::span<Vec3> goals) const;

 private:
  // A region's entries are members_[first_[c] .. first_[c + 1]).
  struct Member {
    std::uint32_t particle;
    double weight;  // mass, shared equally among the particle's regions
    Vec3 rest;      // relative to the region's centre of mass
  };
  struct Region {
    double mass;
    Mat3 moments;      // sum of weight rest rest^T
    Mat3 inverse;      // its inverse on the space that the region spans, 0 across it
    Mat3 not_spanned;  // projection onto the complement of that space
  };

  void add_region(std::span<const std::uint32_t> particles, std::span<const Vec3> points);
  void fit(const Region& region, const Mat3& covariance, Fit& fit) const;
  [[nodiscard]] double spread(std::span<const Fit> fits, std::span<const Vec3> goals) const;

  double linear_ = 0.0;
  bool keep_volume_ = true;
  std::vector<double> masses_;
  std::vector<double> shares_;  // 1 / number of regions, per particle
  std::vector<std::size_t> first_ = {0};
  std::vector<Member> members_;
  std::vector<Region> regions_;
};

/// Matching energy per stiffness for goals of fixed fits, given their constant.
double matching_energy(const RestShape& shape, std::span<const Vec3> positions, std::span<const Vec3> goals,
                       double constant);

}  // namespace dartcast
