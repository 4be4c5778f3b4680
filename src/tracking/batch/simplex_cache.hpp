// A cache of each particle's simplex from one step to the next: the next step then reads less of the scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace dartcast::detail {

/// The cache of one particle's simplex. One value of each array per corner of the simplex. There are two kinds.
///
/// Previous geometry, if vertices move: the corners as they were at the last step. Their positions are long out of the
/// processor's caches when the next step asks for them. Here (x, y, z) are relative to the particle, rounded to floats.
/// The determinants of the particle are w, unknown if they do not prove its coordinates.
///
/// Barycentric coordinates, if vertices stand still. Coordinate i of any point q is x q.x + y q.y + z q.z + w, to
/// within the margin of tracking/batch/coordinate_bounds.hpp. A step that ends in the same simplex reads nothing of the
/// scene. They are unknown until a step has ended in the simplex. On lattices they may be exact: see CacheFlags.
struct SimplexCacheEntry {
  std::array<float, 4> x, y, z;
  std::array<double, 4> w;
};

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();  // w
inline SimplexCacheEntry unknown_entry() { return {{}, {}, {}, {unknown, unknown, unknown, unknown}}; }

/// w of a simplex whose coordinates are not accurate enough: with it no sign of a coordinate is proved.
inline constexpr double proves_nothing = -std::numeric_limits<double>::infinity();

enum class CacheKind : std::uint8_t { none, previous_geometry, barycentric };

/// The entries of four particles in a row, as vectors load them: [corner][particle].
struct alignas(64) SimplexCache4 {
  template <class T>
  using Table = std::array<std::array<T, 4>, 4>;
  Table<float> x, y, z;
  Table<double> w;

  [[nodiscard]] SimplexCacheEntry of(std::size_t particle) const {
    SimplexCacheEntry entry;
    for (std::size_t i = 0; i < 4; ++i) {
      entry.x[i] = x[i][particle];
      entry.y[i] = y[i][particle];
      entry.z[i] = z[i][particle];
      entry.w[i] = w[i][particle];
    }
    return entry;
  }
  void put(std::size_t particle, const SimplexCacheEntry& entry) {
    for (std::size_t i = 0; i < 4; ++i) {
      x[i][particle] = entry.x[i];
      y[i][particle] = entry.y[i];
      z[i][particle] = entry.z[i];
      w[i][particle] = entry.w[i];
    }
  }
};

/// Flags of a particle that has barycentric coordinates. Bit 4: they are exact, so that zeros of a target are proved,
/// too. If it is set, bits 0 to 3 are the facets of the simplex that the particle lies on, and it lies on no wall.
using CacheFlags = std::uint8_t;
inline constexpr CacheFlags exact_flag = 16;

/// Entries and flags of particles in a row. Flags come in fours, too.
struct SimplexCacheSpan {
  std::span<SimplexCache4> fours;
  std::span<CacheFlags> flags;

  [[nodiscard]] bool empty() const { return fours.empty(); }
};

/// One entry per particle.
class SimplexCache {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void resize(std::size_t size) {
    size_ = size;
    fours_.resize((size + 3) / 4);
    flags_.resize(4 * fours_.size());
  }
  [[nodiscard]] SimplexCacheEntry operator[](std::size_t i) const { return fours_[i / 4].of(i % 4); }
  [[nodiscard]] CacheFlags flags(std::size_t i) const { return flags_[i]; }
  void put(std::size_t i, const SimplexCacheEntry& entry, CacheFlags flags = 0) {
    fours_[i / 4].put(i % 4, entry);
    flags_[i] = flags;
  }
  /// As put() of an unknown entry.
  void forget(std::size_t i) {
    for (auto& of_corner : fours_[i / 4].w) of_corner[i % 4] = unknown;
    flags_[i] = 0;
  }
  void push_back(const SimplexCacheEntry& entry, CacheFlags flags = 0) {
    resize(size_ + 1);
    put(size_ - 1, entry, flags);
  }
  /// Those of the particles from `begin` on; empty if none are kept. Precondition: begin is a multiple of four.
  [[nodiscard]] SimplexCacheSpan from(std::size_t begin) {
    if (empty()) return {};
    return {std::span(fours_).subspan(begin / 4), std::span(flags_).subspan(begin)};
  }

 private:
  std::size_t size_ = 0;
  std::vector<SimplexCache4> fours_;
  std::vector<CacheFlags> flags_;
};

}  // namespace dartcast::detail
