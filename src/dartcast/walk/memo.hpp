// What is kept of a particle's simplex from one step to the next, so that the next need not read what is cold.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dartcast::detail {

/// Kept beside a particle's state. One value of each array per corner of the simplex.
///
/// A trail, where vertices move: the corners as they were, which the next step would have to read from memory that is
/// long since cold. (x, y, z): relative to the particle, rounded; w: the determinants of the particle; unknown where
/// they don't prove its coordinates.
///
/// Coordinates, where vertices stand still: the barycentric coordinates of any point q, x q.x + y q.y + z q.z + w, to
/// within the margin of walk/coordinates.hpp. A step that ends in the same simplex reads nothing of the scene.
/// Unknown until a step has ended in the simplex.
struct Memo {
  std::array<float, 4> x, y, z;
  std::array<double, 4> w;
};

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();  // w
inline bool is_unknown(const Memo& m) { return std::isnan(m.w[0]); }
inline Memo unknown_memo() { return {{}, {}, {}, {unknown, unknown, unknown, unknown}}; }

/// w of a simplex that has no coordinates that are good enough. Not even one facet that the target is behind is proved.
inline constexpr double proves_nothing = -std::numeric_limits<double>::infinity();

enum class MemoKind : std::uint8_t { none, trail, coordinates };

}  // namespace dartcast::detail
