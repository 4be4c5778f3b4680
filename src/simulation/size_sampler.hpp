// Diameters drawn from a distribution. Not installed.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/scene.hpp"

namespace dartcast {

class SizeSampler {
 public:
  /// Throws InvalidArgument if a number is out of range, or the cuts leave less than 1% of the distribution.
  SizeSampler(const SizeDistribution& sizes, std::uint64_t seed);

  /// A function of the seed and the particle's id alone.
  [[nodiscard]] double diameter(std::uint64_t id) const;
  /// The mean of the cube, m^3. It is off by less than 1e-6 of it.
  [[nodiscard]] double mean_cube() const { return mean_cube_; }

 private:
  [[nodiscard]] bool is_normal() const { return sizes_.law == SizeLaw::normal || sizes_.law == SizeLaw::lognormal; }
  [[nodiscard]] double at_deviate(double z) const;
  [[nodiscard]] double cut_deviate(double diameter) const;
  void take_table();
  void take_normal();
  void take_rosin_rammler();

  SizeDistribution sizes_;
  std::uint64_t seed_;
  std::vector<double> up_to_;        // table: sums of the shares
  double least_ = 0.0, most_ = 1.0;  // rosin_rammler: shares below the cuts
  double mean_cube_ = 0.0;
};

}  // namespace dartcast
