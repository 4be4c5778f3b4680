// Where new particles are put: at random in the free cells, or just inside a patch of walls.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/keyed_random.hpp"
#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/ranks.hpp"
#include "parts/part_cells.hpp"
#include "simulation/particle_share.hpp"

namespace dartcast {

/// Particles that one call, or one step of an inlet, adds at most. A count beyond it is a mistake: it would take hours
/// before memory ends.
inline constexpr std::uint64_t most_at_once = std::uint64_t{1} << 31U;
/// Throws InvalidArgument if the count is beyond it.
void check_count(std::size_t count);

/// A point, and the simplex that it lies in up to rounding: to be added exactly, and drawn again if that fails. The
/// weights are for a simplex that holds no such point.
struct Sample {
  SimplexId simplex;
  Vec3 position;
  Weights weights;
};

/// Sums of sizes in fixed point. The power of 2 depends on the largest size and their number alone. So the sums do not
/// depend on the order or the grouping. The largest of n sizes has 61 - log2(n) bits or more.
class FixedPointScale {
 public:
  FixedPointScale() = default;
  FixedPointScale(double largest, std::size_t count);
  [[nodiscard]] std::uint64_t operator()(double size) const;

 private:
  double factor_ = 0.0;
};

/// One rank's part of an environment, for samplers; none: this process has all.
struct SampledPart {
  const PartCells& cells;
  Ranks& ranks;
};

/// The scale for sizes of which this rank has so many, and this largest one. Collective if there is a part.
FixedPointScale scale_of(double largest, std::size_t count, const std::optional<SampledPart>& part);

/// Sizes in a row, each as long a piece of a line as it is large: a place on the line chooses an entry. If ranks have an
/// environment's parts, each has its own entries, and the line is that of one process.
class SizeTable {
 public:
  SizeTable() = default;
  /// `cells`: of each size, ascending. Collective if there is a part.
  SizeTable(std::vector<std::uint64_t> sizes, std::span<const Cell> cells, const std::optional<SampledPart>& part);

  /// Over all ranks; 0: there is nothing to choose.
  [[nodiscard]] std::uint64_t length() const { return length_; }
  [[nodiscard]] std::uint64_t begin(std::size_t entry) const { return begin_[entry]; }
  /// None: it is another rank's.
  [[nodiscard]] std::optional<std::size_t> entry_at(std::uint64_t place) const;

 private:
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint64_t> size_;
  std::uint64_t length_ = 0;
};

/// Points of equal likelihood by volume in the free cells, at the complex's positions when it was made. Cost to make:
/// linear.
class VolumeSampler {
 public:
  /// Throws InvalidArgument if no cell is free.
  explicit VolumeSampler(const CellComplex& complex, Threads threads = {}, const std::optional<SampledPart>& part = {});
  /// In a free cell; none: in another rank's. Cost: the logarithm of the cells.
  [[nodiscard]] std::optional<Sample> sample(const CellComplex& complex, KeyedRandom& random) const;

 private:
  std::vector<Cell> cells_;
  FixedPointScale scale_;
  SizeTable volumes_;
};

/// The velocity of a fluid relative to the mesh at a corner of a simplex.
using FlowAtCorner = std::function<Vec3(SimplexId simplex, unsigned corner)>;

/// Points of equal likelihood by area on a patch's faces, or by the volume that flows in through them. They are moved
/// inwards by 1/64 of the way to the opposite corner of the simplex there.
class PatchSampler {
 public:
  /// Throws InvalidArgument if the patch has no face at a free cell. Cost: linear in the cells.
  PatchSampler(const CellComplex& complex, Patch patch, const std::optional<SampledPart>& part = {});
  /// After an edit it is as a new one, but it may be empty. Cost: the cells touched, and the patch's faces.
  void update_after_edit(const CellComplex& complex, const ComplexEditReport& edit);
  /// Takes the areas at the complex's current positions. Cost: the patch's faces.
  void update(const CellComplex& complex);
  /// Takes the flux into the mesh instead: linear on each triangle, and 0 at corners with a flow out of the mesh. Returns
  /// whether anything flows in; the sampler is of no use if not. Cost: likewise.
  bool update(const CellComplex& complex, const FlowAtCorner& flow);
  /// Whether the patch has no face at a free cell.
  [[nodiscard]] bool empty() const { return !part_ && triangles_.empty(); }
  /// None: on another rank's face. Precondition: it is not empty.
  [[nodiscard]] std::optional<Sample> sample(const CellComplex& complex, KeyedRandom& random) const;

 private:
  void add(const CombinatorialMap& map, Cell c);

  struct Triangle {
    SimplexId simplex;
    std::uint16_t facet;
  };
  void set_sizes(const std::vector<double>& sizes);

  Patch patch_;
  std::optional<SampledPart> part_;
  std::vector<Triangle> triangles_;
  SizeTable sizes_;
  bool by_flux_ = false;
  std::vector<std::array<double, 3>> inflow_;  // by flux: of each triangle, at its corners, up to one factor for all
};

/// One point for all particles.
class PointSampler {
 public:
  /// Collective if there is a part. Cost: as Environment::locate(), whose first call after a move is linear in the cells.
  PointSampler(Environment& environment, const Vec3& at, const std::optional<SampledPart>& part);
  /// Whether the point is in no free cell.
  [[nodiscard]] bool empty() const { return empty_; }
  /// None: in another rank's cell.
  [[nodiscard]] std::optional<Sample> sample(const CellComplex& /*complex*/, KeyedRandom& /*random*/) const {
    return sample_;
  }

 private:
  std::optional<Sample> sample_;
  bool empty_ = true;
};

struct Placing {
  Environment& environment;
  ParticleShare share;              ///< of a whole environment
  std::optional<SampledPart> part;  ///< then the place decides whose a particle is
  std::uint64_t seed;
};

/// Adds those of these particles that are this rank's. Returns their ids: those that came late stand behind the others.
/// Where points fall outside again and again, as in an inverted cell, the last is added by its weights. Collective if there is a part.
template <class Sampler>
std::vector<std::uint64_t> place(const Placing& placing, Particles& particles, const Sampler& sampler,
                                 std::uint64_t first, std::uint64_t count);

}  // namespace dartcast
