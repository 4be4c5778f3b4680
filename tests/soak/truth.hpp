// First contacts by all walls of the scene, in exact numbers: without a search, and without the library's predicates.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/environment.hpp"

namespace dartcast::soak {

/// All walls of a scene that is valid.
class Walls {
 public:
  /// `moved`: whether they go from where they were before the last move to where they are; else they stand.
  Walls(const Environment& environment, bool moved);

  /// The fault of the first contact of a step among walls at rest; empty: it has none. `first`: null where there was none.
  [[nodiscard]] std::string check_first(const ParticleState& before, const Vec3& target, const Contact* first,
                                        std::span<const WallHit> hits) const;
  /// The same where the walls move at the same time.
  [[nodiscard]] std::string check_first_simultaneous(const ParticleState& before, const Vec3& target,
                                                     const Contact* first, std::span<const WallHit> hits) const;

 private:
  /// Counterclockwise as seen from the free side. In the plane the third corner is above the first.
  struct Wall {
    std::array<Vec3, 3> from, to;
    Vec3 low, high;
  };

  std::vector<Wall> walls_;
  std::map<std::tuple<std::uint32_t, std::uint16_t, std::uint16_t>, std::size_t> number_;  // cell, face, triangle
  bool plane_;
};

}  // namespace dartcast::soak
