// The volume of a simplex with corners on straight lines as an exact polynomial, and its roots by Sturm's theorem:
// independent of the library.
#pragma once

#include <array>
#include <vector>

#include "complex/simplex.hpp"
#include "support/dyadic.hpp"

namespace dartcast::test {

struct Polynomial {
  std::vector<Dyadic> factors;  // by rising powers; the last one is not zero
};

/// Each axis is measured in a power of two of its own: it changes no sign of a volume.
class MovingSimplex {
 public:
  MovingSimplex(const Corners& before, const Corners& after);

  [[nodiscard]] int sign_of_volume(const Dyadic& time) const;

  /// Whether the volume, positive at 0, has a root in (0, time].
  [[nodiscard]] bool has_root_by(const Dyadic& time) const;

  /// The last multiple of 2^-bits before the first root. Precondition: there is one in (0, 1].
  [[nodiscard]] Dyadic last_before_root(int bits) const;

  /// Signs of the facets' area vectors at a time, along the longest of them: -1, 0 or 1 for each corner.
  [[nodiscard]] std::array<int, 4> facet_signs(const Dyadic& time) const;

 private:
  using Point = std::array<Polynomial, 3>;  // linear in time

  [[nodiscard]] Point edge(std::size_t i) const;
  [[nodiscard]] int changes(const Dyadic& time) const;

  std::array<Point, 4> corners_;
  Polynomial volume_;
  std::vector<Polynomial> chain_;
};

}  // namespace dartcast::test
