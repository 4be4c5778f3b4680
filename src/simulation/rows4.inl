// Rows of arrays of particles, loaded and stored four at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/double4.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The reverse of load_vec3x4().
inline void store_vec3x4(const Vec3x4& four, Vec3* out) {
  const Double4 xy01 = shuffled<0, 4, 1, 5>(four.x, four.y);
  const Double4 xy23 = shuffled<2, 6, 3, 7>(four.x, four.y);
  const Double4 yz1 = shuffled<1, 5, 1, 5>(four.y, four.z);
  double* const at = &out->x;
  store_doubles(shuffled<0, 1, 4, 2>(xy01, four.z), at);
  store_doubles(shuffled<0, 1, 4, 5>(yz1, xy23), at + 4);
  store_doubles(shuffled<6, 2, 3, 7>(xy23, four.z), at + 8);
}

// Four rows of arrays. Beyond the end the last row is loaded again, and not stored.
class Rows4 {
 public:
  Rows4(std::size_t first, std::size_t size)
      : first_(first),
        count_(static_cast<unsigned>(std::min<std::size_t>(4, size - first))),
        at_(index4_from(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(size))) {}

  [[nodiscard]] std::size_t at(unsigned k) const { return at_.at[k]; }
  [[nodiscard]] unsigned count() const { return count_; }
  [[nodiscard]] Vec3x4 load(std::span<const Vec3> all) const {
    if (count_ == 4) return load_vec3x4(&all[first_]);
    return load_vec3x4(all[at(0)], all[at(1)], all[at(2)], all[at(3)]);
  }
  [[nodiscard]] Double4 load(std::span<const double> all) const {
    if (count_ == 4) return load_doubles(&all[first_]);
    return Double4{all[at(0)], all[at(1)], all[at(2)], all[at(3)]};
  }
  [[nodiscard]] Mask4 load(std::span<const std::uint64_t> all) const {
    if (count_ == 4) return load_bits(&all[first_]);
    const auto bits = [&](unsigned k) { return static_cast<long long>(all[at(k)]); };
    return Mask4{bits(0), bits(1), bits(2), bits(3)};
  }
  void store(const Vec3x4& four, std::span<Vec3> all) const {
    if (count_ == 4) return store_vec3x4(four, &all[first_]);
    for (unsigned k = 0; k < count_; ++k) all[first_ + k] = {four.x[k], four.y[k], four.z[k]};
  }
  void store(const Double4& four, std::span<double> all) const {
    if (count_ == 4) return store_doubles(four, &all[first_]);
    for (unsigned k = 0; k < count_; ++k) all[first_ + k] = four[k];
  }

 private:
  std::size_t first_;
  unsigned count_;
  Index4 at_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
