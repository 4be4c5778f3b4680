// What is kept of a particle's simplex from one step to the next, so that the next need not read what is cold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace dartcast::detail {

/// Kept beside a particle's state. One value of each array per corner of the simplex.
///
/// A trail, where vertices move: the corners as they were, which the next step would have to read from memory that is
/// long since cold. (x, y, z): relative to the particle, rounded; w: the determinants of the particle; unknown where
/// they don't prove its coordinates.
///
/// Coordinates, where vertices stand still: the barycentric coordinates of any point q, x q.x + y q.y + z q.z + w, to
/// within the margin of tracking/batch/coordinate_bounds.hpp. A step that ends in the same simplex reads nothing of the
/// scene. Unknown until a step has ended in the simplex. On lattices they may be exact: see Mark.
struct SimplexCacheEntry {
  std::array<float, 4> x, y, z;
  std::array<double, 4> w;
};

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();  // w
inline SimplexCacheEntry unknown_entry() { return {{}, {}, {}, {unknown, unknown, unknown, unknown}}; }

/// w of a simplex that has no coordinates that are good enough. Not even one facet that the target is behind is proved.
inline constexpr double proves_nothing = -std::numeric_limits<double>::infinity();

enum class CacheKind : std::uint8_t { none, previous_geometry, barycentric };

/// The memos of four particles in a row, as vectors take them: [corner][particle].
struct alignas(64) SimplexCache4 {
  template <class T>
  using Table = std::array<std::array<T, 4>, 4>;
  Table<float> x, y, z;
  Table<double> w;

  [[nodiscard]] SimplexCacheEntry of(std::size_t particle) const {
    SimplexCacheEntry m;
    for (std::size_t i = 0; i < 4; ++i) {
      m.x[i] = x[i][particle];
      m.y[i] = y[i][particle];
      m.z[i] = z[i][particle];
      m.w[i] = w[i][particle];
    }
    return m;
  }
  void put(std::size_t particle, const SimplexCacheEntry& m) {
    for (std::size_t i = 0; i < 4; ++i) {
      x[i][particle] = m.x[i];
      y[i][particle] = m.y[i];
      z[i][particle] = m.z[i];
      w[i][particle] = m.w[i];
    }
  }
};

/// What else is known of a particle that has coordinates. Bit 4: they are exact, so that a target's zeros are proved,
/// too. Then bits 0 to 3: the facets of its simplex that it lies on; and it lies on no wall.
using CacheFlags = std::uint8_t;
inline constexpr CacheFlags exact_flag = 16;

/// SimplexCache and marks of particles in a row. Marks come in fours, too.
struct SimplexCacheSpan {
  std::span<SimplexCache4> fours;
  std::span<CacheFlags> marks;

  [[nodiscard]] bool empty() const { return fours.empty(); }
};

/// One memo per particle.
class SimplexCache {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void resize(std::size_t size) {
    size_ = size;
    fours_.resize((size + 3) / 4);
    marks_.resize(4 * fours_.size());
  }
  [[nodiscard]] SimplexCacheEntry operator[](std::size_t i) const { return fours_[i / 4].of(i % 4); }
  [[nodiscard]] CacheFlags mark(std::size_t i) const { return marks_[i]; }
  void put(std::size_t i, const SimplexCacheEntry& m, CacheFlags mark = 0) {
    fours_[i / 4].put(i % 4, m);
    marks_[i] = mark;
  }
  /// As put() of an unknown one.
  void forget(std::size_t i) {
    for (auto& of_corner : fours_[i / 4].w) of_corner[i % 4] = unknown;
    marks_[i] = 0;
  }
  void push_back(const SimplexCacheEntry& m, CacheFlags mark = 0) {
    resize(size_ + 1);
    put(size_ - 1, m, mark);
  }
  /// Of the particles from `begin` on; empty where none are kept. Precondition: begin is a multiple of four.
  [[nodiscard]] SimplexCacheSpan from(std::size_t begin) {
    if (empty()) return {};
    return {std::span(fours_).subspan(begin / 4), std::span(marks_).subspan(begin)};
  }

 private:
  std::size_t size_ = 0;
  std::vector<SimplexCache4> fours_;
  std::vector<CacheFlags> marks_;
};

}  // namespace dartcast::detail
