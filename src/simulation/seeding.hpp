// Where new particles are put: at random in the free cells, or just inside a patch of walls.
#pragma once

#include <cstdint>
#include <vector>

#include "base/keyed_random.hpp"
#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"

namespace dartcast {

/// Particles that one call, or one step of an inlet, adds at most. A count beyond it is a mistake: it would take hours
/// before memory ends.
inline constexpr std::uint64_t most_at_once = std::uint64_t{1} << 31U;
/// Throws InvalidArgument where the count is beyond it.
void check_count(std::size_t count);

/// A point, and the simplex that it lies in up to rounding: to be added exactly, and drawn again where that fails.
struct Sample {
  SimplexId simplex;
  Vec3 position;
};

/// Sums of sizes in fixed point: of a power of 2 that depends on the largest size and their number alone, so that the
/// sums do not depend on the order or the grouping. The largest of n sizes has 61 - log2(n) bits or more.
class FixedPointScale {
 public:
  FixedPointScale() = default;
  FixedPointScale(double largest, std::size_t count);
  [[nodiscard]] std::uint64_t operator()(double size) const;

 private:
  double factor_ = 0.0;
};

/// Points of equal likelihood by volume in the free cells, at the complex's positions when it was made. Cost to make:
/// linear.
class VolumeSampler {
 public:
  /// Throws InvalidArgument where no cell is free.
  explicit VolumeSampler(const CellComplex& complex, Threads threads = {});
  /// In a free cell. Cost: the logarithm of the cells.
  [[nodiscard]] Sample sample(const CellComplex& complex, KeyedRandom& random) const;

 private:
  std::vector<Cell> cells_;
  FixedPointScale scale_;
  std::vector<std::uint64_t> volume_up_to_;
};

/// Points of equal likelihood by area on a patch's faces, moved inwards by 1/64 of the way to the opposite corner of
/// the simplex there.
class PatchSampler {
 public:
  /// Throws InvalidArgument where the patch has no face at a free cell. Cost: linear in the cells.
  PatchSampler(const CellComplex& complex, Patch patch);
  /// After an edit it is as a new one, but it may be empty. Cost: the cells touched, and the patch's faces.
  void update_after_edit(const CellComplex& complex, const ComplexEditReport& edit);
  /// Takes the areas at the complex's current positions. Cost: the patch's faces.
  void update(const CellComplex& complex);
  /// Whether the patch has no face at a free cell.
  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Precondition: it is not empty.
  [[nodiscard]] Sample sample(const CellComplex& complex, KeyedRandom& random) const;

 private:
  void add(const CombinatorialMap& map, Cell c);

  struct Triangle {
    SimplexId simplex;
    std::uint16_t facet;
  };
  Patch patch_;
  std::vector<Triangle> triangles_;
  std::vector<double> areas_;
  std::vector<std::uint64_t> area_up_to_;
};

}  // namespace dartcast
