// Far walks that go apart from the others, if vertices move. Their step has several slices, or the filter does not
// prove where the mesh carries the start, as at walls. Here they and their starts are found. They walk in
// batch_slice_walks.inl. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "tracking/batch/batch_steps.inl"
#include "tracking/carry.hpp"
#include "tracking/space.hpp"

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

// The target of a walk in the first of so many slices.
inline Vec3 slice_target(const Batch<true>& b, std::uint32_t i, unsigned slices) {
  const Vec3& here = b.states[i].position;
  return slices == 1 ? b.targets[i] : next_slice(here, b.targets[i] - here, slices).target;
}

class Splitting {
 public:
  Splitting(Batch<true>& batch, const StepOptions& options, BatchList<SliceWalk>& apart)
      : b(batch), options_(options), apart_(apart) {}

  // Takes the steps that are held, or split, and in the mask `which` out of the block that begins with number `first`.
  // They walk apart, or are deferred. Returns a mask of them. The others have one slice.
  std::uint32_t split(std::uint32_t first, std::uint32_t which) {
    for (std::uint32_t left = which; left != 0; left &= left - 1)
      prefetch_corners(b.before, b.vertices[first + static_cast<std::uint32_t>(std::countr_zero(left))]);
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

  // Adds a far walk of one particle. Returns false if the target is near, or the particle's coordinates are not known.
  // It does so, too, if its simplex is not proved to be positive, or the particle is rounded out of it.
  [[gnu::noinline]] bool add(std::uint32_t i, unsigned slices) {
    const Space<Between> space{&b.map, {b.before, b.now, 1.0 / slices}, b.simplex_count};
    const SimplexId at = b.states[i].at();
    __builtin_prefetch(b.map.record(at.cell));
    const Corners corners = corners_of(space.positions, b.vertices[i]);
    const Determinants d(corners, slice_target(b, i, slices));
    const Weights weights = determinants_of(b.old_determinants.data(), i);
    if (std::isnan(weights[0]) || !d.proves_positive() || !is_far_away(d)) return false;
    const SimplexPlacement start = place_in_simplex(space, at, corners, combine(corners, shares_of(weights)));
    if (start.simplex != at) return false;
    apart_.add(slice_walk(i, slices, start.position));
    return true;
  }

 private:
  [[nodiscard]] SliceWalk slice_walk(std::uint32_t i, std::uint32_t slices, const Vec3& x) const {
    return {i, slices, b.map.record(b.states[i].cell), {x.x, x.y, x.z}};
  }

  [[gnu::noinline]] unsigned split_four(const Index4& i, std::uint32_t count) {
    const auto [w] = determinants_of(b.old_determinants.data(), i);
    const Corners4 before = b.simplices_of(b.before, i);
    const Corners4 now = b.simplices_of(b.now, i);
    const Vec3x4 here = b.places_of(i);
    const Vec3x4 q = b.targets_of(i);
    // Unknown if the coordinates are not known, or the simplex is not proved to be positive.
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
      const bool unknown = b.states[particle].held || known[l] == 0;
      if (!unknown && slices[l] == 1.0) continue;
      taken_out |= 1U << l;
      const auto number = static_cast<std::uint32_t>(slices[l]);
      const bool walks = !unknown && far[l] != 0;
      if (walks && inside[l] != 0) {
        const SliceWalk walk = slice_walk(particle, number, {start.x[l], start.y[l], start.z[l]});
        __builtin_prefetch(walk.record);
        apart_.add(walk);
      } else if (!walks || !add(particle, number)) {
        b.defer(particle);
      }
    }
    return taken_out;
  }

  Batch<true>& b;
  const StepOptions& options_;
  BatchList<SliceWalk>& apart_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
