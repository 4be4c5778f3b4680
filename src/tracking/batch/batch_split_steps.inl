// Steps that are split in slices: into how many, and the starts of their first walks (batch_slice_walks.inl), four at a time.
// Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "tracking/batch/batch_slice_walks.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// As slice_count() in tracking/carry.hpp, sum by sum: what the number of slices is the root of, rounded up.
class SplittingRule4 {
 public:
  SplittingRule4(const Corners4& before, const Corners4& after) {
    const auto& [v0, v1, v2, v3] = before.corner;
    const Vec3x4 e[3] = {v1 - v0, v2 - v0, v3 - v0};
    const Vec3x4 first = after.corner[0] - v0;
    const Vec3x4 u[3] = {(after.corner[1] - v1) - first, (after.corner[2] - v2) - first,
                         (after.corner[3] - v3) - first};
    const Vec3x4 dual[3] = {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
    const Double4 scale = 1.0 / dot(e[0], dual[0]);
    const auto row = [&](Double4 Vec3x4::*at) {
      return square(((dual[0] * (u[0].*at) + dual[1] * (u[1].*at)) + dual[2] * (u[2].*at)) * scale);
    };
    gradient_ = root((row(&Vec3x4::x) + row(&Vec3x4::y)) + row(&Vec3x4::z));
    const Double4 at_first = smaller(smaller(square(e[0]), square(e[1])), square(e[2]));
    const Double4 others = smaller(smaller(square(v2 - v1), square(v3 - v1)), square(v3 - v2));
    edge_ = root(smaller(at_first, others));
  }

  // own: the particles' motion relative to their simplices.
  [[nodiscard]] Double4 slices_for(const Vec3x4& own, double tolerance) const {
    return root(gradient_ * root(square(own)) / (2.0 * tolerance * edge_));
  }

 private:
  Double4 gradient_;
  Double4 edge_;
};

// Takes the steps in the mask `which` that are held, or that are split, out of the block: they walk apart, or are deferred.
// Returns a mask of them. The others have one slice.
template <CacheKind kind>
inline std::uint32_t Batch<kind>::split_steps(std::uint32_t first, std::uint32_t which) {
  for (std::uint32_t left = which; left != 0; left &= left - 1)
    prefetch(before_, vertices_[first + static_cast<std::uint32_t>(std::countr_zero(left))]);
  std::uint32_t taken_out = 0;
  while (which != 0) {
    std::uint32_t k[4];
    std::uint32_t count = 0;
    for (; count < 4 && which != 0; which &= which - 1)
      k[count++] = static_cast<std::uint32_t>(std::countr_zero(which));
    std::fill(k + count, k + 4, k[count - 1]);
    const unsigned of_four = split_four({{first + k[0], first + k[1], first + k[2], first + k[3]}}, count);
    for (std::uint32_t l = 0; l < count; ++l) taken_out |= ((of_four >> l) & 1U) << k[l];
  }
  return taken_out;
}

template <CacheKind kind>
unsigned Batch<kind>::split_four(const Index4& i, std::uint32_t count) {
  const auto [w] = determinants_of(previous_determinants_.data(), i);
  const Corners4 before = simplices_of(before_, i);
  const Corners4 now = simplices_of(now_, i);
  const Vec3x4 here = places_of(i);
  const Vec3x4 q = targets_of(i);
  // Unknown where the coordinates are not known, or the simplex is not proved to be positive.
  const Mask4 known = (w[0] == w[0]) & BatchDeterminants(now, now.corner[0]).proves_positive();
  const Double4 root_of_slices = SplittingRule4(before, now).slices_for(q - combined(w, now), options_.tolerance);
  Double4 slices{};
  for (unsigned l = 0; l < 4; ++l)
    slices[l] = root_of_slices[l] > 1.0 ? std::min(std::ceil(root_of_slices[l]), double(options_.max_slices)) : 1.0;
  const Double4 time = 1.0 / slices;
  const Corners4 v = between(before, now, time);
  const BatchDeterminants at_target(v, without_tiny(here + (q - here) * time));
  const Mask4 far = at_target.proves_positive() & at_target.far_away();
  const Vec3x4 start = carry_along(w, v);
  const Mask4 inside = BatchDeterminants(v, start).all_positive();
  unsigned taken_out = 0;
  for (std::uint32_t l = 0; l < count; ++l) {
    const std::uint32_t particle = i.at[l];
    const bool unknown = states_[particle].held || known[l] == 0;
    if (!unknown && slices[l] == 1.0) continue;
    taken_out |= 1U << l;
    const auto number = static_cast<std::uint32_t>(slices[l]);
    const std::uint32_t* const record = map_.record(states_[particle].cell);
    const bool walks = !unknown && far[l] != 0;
    if (walks && inside[l] != 0) {
      __builtin_prefetch(record);
      slice_walks_[slice_walk_count_++] = {particle, number, record, {start.x[l], start.y[l], start.z[l]}};
    } else if (!walks || !add_slice_walk(particle, number)) {
      defer(particle);
    }
  }
  return taken_out;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
