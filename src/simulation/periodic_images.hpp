// The numbers that particles of a simulation carry through periodic faces: counts of images, and vectors. Not installed.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/particle_set.hpp"

namespace dartcast {

/// Names of the numbers of user data that count crossings: image_A for each pair of the patches A and B. A crossing from A
/// to B counts 1, and one from B to A -1.
std::vector<std::string> image_numbers(const CellComplex& complex);

class PeriodicImages {
 public:
  /// Numbers of user data that have these names count. Three in a row named NAME_x, NAME_y, NAME_z are a vector, which
  /// turns. Both outlive it.
  PeriodicImages(const CellComplex& complex, const std::vector<std::string>& user_data);

  /// Null if there are no pairs.
  [[nodiscard]] const detail::PeriodicFaces* pairs() const { return complex_.periodic(); }
  [[nodiscard]] std::size_t size() const { return columns_.size(); }
  /// For Environment::set_crossing_callback(). `set` outlives it.
  [[nodiscard]] CrossingCallback callback(ParticleSet& set) const;
  /// Where a particle would be without pairs: each pair's motion is taken back as often as it was made, from the last pair
  /// to the first. So it is right if the motions may be made in any order, as translations may.
  [[nodiscard]] Vec3 unwrapped(const Vec3& position, std::span<const double> user_data) const;

 private:
  void cross(const PeriodicCrossing& crossing, ParticleSet& set) const;

  const CellComplex& complex_;
  std::vector<std::size_t> columns_;  // by pair; none: not counted
  std::vector<std::size_t> vectors_;  // the first of each three
};

}  // namespace dartcast
