// The first simplex of each step, where most steps end. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "tracking/batch/batch_steps.inl"
#include "tracking/carry.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// The first simplex of each step, tested against its corners. Returns the number of exits.
template <CacheKind kind>
inline std::size_t Batch<kind>::start() {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < std::min(size_, block); ++i) prefetch(now_, vertices_[i]);
  for (std::uint32_t first = 0; first < size_; first += block) {
    const std::uint32_t n = std::min(block, size_ - first);
    test_block(first, n);
    const std::uint32_t remaining = carry_remaining(first, end_inside(first, n));
    for (std::uint32_t l = 0; l < remaining; ++l) {
      const std::uint32_t i = first + remaining_[l];
      const std::uint32_t* record = map_.record(states_[i].cell);
      const FacetSigns4 signs(signs_[remaining_[l]]);
      if (((far_away_ >> remaining_[l]) & 1U) != 0) {
        add_far_walk({i, record}, ((farther_away_ >> remaining_[l]) & 1U) != 0);
      } else if (signs.negative() != 0 && signs.is_known()) {
        exits_[count++] = exit_candidate(i, signs.negative(), signs.open(), record);
      } else {
        WalkCursor cursor = first_cursor(i, states_[i], record, 4, 0);
        leave_simplex(cursor, vertices_[i], remaining_[l]);
      }
    }
  }
  return count;
}

// The same by barycentric coordinates, where vertices stand still. Only steps that leave the simplex read the scene.
template <CacheKind kind>
inline std::size_t Batch<kind>::start_by_coordinates() {
  std::size_t count = 0;
  std::size_t undecided = 0;
  std::size_t sorted = 0;
  for (std::uint32_t first = 0; first < size_; first += block) {
    const std::uint32_t n = std::min(block, size_ - first);
    test_coordinates(first, n);
    const std::uint32_t remaining = end_inside(first, n);
    const std::size_t prefetched = undecided;  // their corners
    if (on_facets_ != 0) end_on_facets(first);
    for (std::uint32_t l = 0; l < remaining; ++l) {
      const std::uint32_t i = first + remaining_[l];
      const std::uint32_t* record = map_.record(states_[i].cell);
      __builtin_prefetch(record);
      const FacetSigns4 signs(signs_[remaining_[l]]);
      const unsigned behind = signs.negative();
      exits_[count] = exit_candidate(i, behind, signs.zero(), record);
      undecided_[undecided] = {i, record};
      if (!std::has_single_bit(behind)) prefetch(now_, vertices_[i]);
      const std::size_t proved = behind != 0 ? 1 : 0;
      count += proved;
      undecided += 1 - proved;
    }
    for (; sorted + 4 <= prefetched; sorted += 4) sort_undecided(sorted, undecided);
  }
  for (; sorted < undecided; sorted += 4) sort_undecided(sorted, undecided);
  return count;
}

// Four steps of `count` that coordinates do not decide, from number k on: walks to far targets, and others in rounds.
template <CacheKind kind>
inline void Batch<kind>::sort_undecided(std::size_t k, std::size_t count) {
  const std::size_t last = count - 1;
  const auto particle = [&](std::size_t l) { return undecided_[std::min(k + l, last)].particle; };
  const Index4 i = {{particle(0), particle(1), particle(2), particle(3)}};
  const BatchDeterminants determinants(simplices_of(now_, i), targets_of(i));
  const unsigned far = lanes_set(determinants.far_away());
  const unsigned farther = lanes_set(determinants.far_away(farther_coordinate));
  for (std::size_t l = 0; l < std::min<std::size_t>(4, count - k); ++l) {
    const WalkStart& d = undecided_[k + l];
    if (((far >> l) & 1U) != 0)
      add_far_walk(d, ((farther >> l) & 1U) != 0);
    else
      add_to_rounds(first_cursor(d.particle, states_[d.particle], d.record, 1, 0));  // walk_on() counts three more
  }
}

template <CacheKind kind>
inline void Batch<kind>::add_far_walk(const WalkStart& walk, bool farther) {
  if (!moved && farther && cells_positive_)
    farther_walks_[farther_count_++] = walk;
  else
    far_walks_[far_count_++] = walk;
}

template <CacheKind kind>
inline void Batch<kind>::test_block(std::uint32_t first, std::uint32_t n) {
  inside_ = 0;
  far_away_ = 0;
  farther_away_ = 0;
  one_part_ = 0;
  carried_inside_ = 0;
  arrivals_ = 0;
  for (std::uint32_t k = 0; k < n; k += 4) {
    prefetch_ahead(first + k);
    const Index4 i = index4_from(first + k, size_);
    const Corners4 now = simplices_of(now_, i);
    const Vec3x4 q = targets_from(first + k);
    const BatchDeterminants d(now, q);
    const Mask4 signs = d.signs(now, q);
    store_signs(signs, k);
    inside_ |= lanes_set(signs == splat_bits(FacetSigns4::valid)) << k;
    far_away_ |= lanes_set(d.far_away()) << k;
    if constexpr (!moved) farther_away_ |= lanes_set(d.far_away(farther_coordinate)) << k;
    if constexpr (moved) {
      SimplexCache4& previous_caches = caches_[i.at[0] / 4];
      const OnePart one(previous_caches, d.relative, places_of(i), q, options_.tolerance);
      Mask4 proved = one.by_size();
      if (lanes_set(proved) != 15U) proved |= one.by_shape();
      one_part_ |= lanes_set(proved) << k;
      carried_inside_ |= lanes_set(surely_carried_inside(previous_caches, d, q)) << k;
      previous_determinants_[i.at[0] / 4] = previous_caches.w;
      store_previous_geometry(d, previous_caches);  // steps that go on, or are deferred, overwrite it later
    }
  }
}

// Stores a bit for each facet that a target is behind; none at all where the sign of any coordinate is not proved.
template <CacheKind kind>
inline void Batch<kind>::test_coordinates(std::uint32_t first, std::uint32_t n) {
  inside_ = 0;
  on_facets_ = 0;
  still_free_ = 0;
  for (std::uint32_t k = 0; k < n; k += 4) {
    const Vec3x4 q = targets_from(first + k);
    const SimplexCache4& caches = caches_[(first + k) / 4];
    const Double4 c[4] = {coordinate_of(caches, 0, q), coordinate_of(caches, 1, q), coordinate_of(caches, 2, q),
                          coordinate_of(caches, 3, q)};
    const Double4 m[4] = {magnitude(c[0]), magnitude(c[1]), magnitude(c[2]), magnitude(c[3])};
    const Double4 lowest = smaller(smaller(c[0], c[1]), smaller(c[2], c[3]));
    inside_ |= lanes_set(lowest > coordinate_margin) << k;
    const Mask4 in_range = (larger(larger(m[0], m[1]), larger(m[2], m[3])) <= max_for_sign) & (lowest > -surely_near);
    const Mask4 known = (smaller(smaller(m[0], m[1]), smaller(m[2], m[3])) > coordinate_margin) & in_range;
    const Mask4 negative = facet_bits(c[0] < 0.0, c[1] < 0.0, c[2] < 0.0, c[3] < 0.0);
    store_signs(known & negative, k);
    if (any_flag(flags_ + first + k)) {
      const Mask4 proved = facet_bits(m[0] > coordinate_margin, m[1] > coordinate_margin, m[2] > coordinate_margin,
                                      m[3] > coordinate_margin);
      test_zeros(first, k, q, in_range, proved, negative);
    }
  }
}

// The same where coordinates are exact: zeros are proved, too. A particle with exact coordinates is on no wall. A
// target that lies on no other facets than its particle is on no wall either: such a wall would hold the particle.
template <CacheKind kind>
void Batch<kind>::test_zeros(std::uint32_t first, std::uint32_t k, const Vec3x4& q, const Mask4& in_range,
                             const Mask4& proved, const Mask4& negative) {
  const CacheFlags* of_four = flags_ + first + k;
  const Mask4 flags = {of_four[0], of_four[1], of_four[2], of_four[3]};
  const Mask4 zeros = proved_zeros(caches_[(first + k) / 4], q) & ((flags & splat_bits(exact_flag)) != 0);
  const Mask4 known = in_range & ((proved | zeros) == splat_bits(15));
  store_signs(known & (negative | (zeros << 4)), k);
  const Mask4 on_facets = known & (negative == 0) & (zeros != 0);
  const Mask4 still_free = on_facets & ((zeros & ~flags) == 0);
  on_facets_ |= lanes_set(on_facets & ~still_free) << k;
  still_free_ |= lanes_set(still_free) << k;
  inside_ |= lanes_set(still_free) << k;
  set_facet_flags(zeros, inside_ >> k, flags_ + first + k);
}

// Ends the steps whose targets lie strictly inside: nothing in a simplex is in the way. Lists the others in remaining_,
// and returns their number.
template <CacheKind kind>
inline std::uint32_t Batch<kind>::end_inside(std::uint32_t first, std::uint32_t n) {
  const std::uint32_t all = n == block ? ~std::uint32_t{0} : (std::uint32_t{1} << n) - 1;
  std::uint32_t deferred = 0;
  if constexpr (moved) deferred = split_steps(first, all & ~one_part_);
  std::uint32_t unusual = all & ~deferred & held_or_touching(states_, size_, first, n);
  for (; unusual != 0; unusual &= unusual - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(unusual));
    if (defer_unusual(first + k, k)) deferred |= std::uint32_t{1} << k;
  }
  inside_ &= all & ~deferred;
  on_facets_ &= all & ~deferred;
  if constexpr (kind == CacheKind::barycentric) {
    for (std::uint32_t on = inside_ & still_free_; on != 0; on &= on - 1)
      counters_.orientation.exact += static_cast<unsigned>(
          std::popcount(FacetSigns4(signs_[static_cast<std::size_t>(std::countr_zero(on))]).zero()));
  }
  for (std::uint32_t in = inside_; in != 0; in &= in - 1) {
    const std::uint32_t i = first + static_cast<std::uint32_t>(std::countr_zero(in));
    states_[i].position = targets_[i];
    states_[i].touching_count = 0;
  }
  const auto ended = static_cast<std::uint64_t>(std::popcount(inside_));
  counters_.particle_steps += ended;
  counters_.orientation.tests += 4 * ended;
  counters_.histogram[4] += ended;
  counters_.forecast_kept += ended;
  std::uint32_t remaining = 0;
  for (std::uint32_t on = all & ~deferred & ~inside_ & ~on_facets_; on != 0; on &= on - 1)
    remaining_[remaining++] = static_cast<std::uint32_t>(std::countr_zero(on));
  return remaining;
}

// Ends the steps whose targets lie on facets of the simplex that the particle is in.
template <CacheKind kind>
void Batch<kind>::end_on_facets(std::uint32_t first) {
  for (std::uint32_t bits = on_facets_; bits != 0; bits &= bits - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(bits));
    const std::uint32_t i = first + k;
    const unsigned on = FacetSigns4(signs_[k]).zero();
    const WalkCursor cursor =
        first_cursor(i, states_[i], map_.record(states_[i].cell), 4, static_cast<unsigned>(std::popcount(on)));
    if (const auto wall = find_touched_wall(map_, cursor, vertices_[i], on)) {
      end_on_wall(cursor, on, *wall);
    } else {
      end(cursor);
      flags_[i] = static_cast<CacheFlags>(exact_flag | on);
    }
  }
}

// Defers a step in one part that is held, or rests on a wall. k: its place in the block. Returns false where the step is
// neither.
template <CacheKind kind>
inline bool Batch<kind>::defer_unusual(std::uint32_t i, std::uint32_t k) {
  const ParticleState& s = states_[i];
  const bool far = moved && ((far_away_ >> k) & 1U) != 0;
  if (!s.held && (s.touching_count == 0 || far || !rests(i))) return false;
  defer(i);
  return true;
}

// Where the mesh carries a particle that had these determinants, in the simplex where its step starts.
template <CacheKind kind>
inline Vec3 Batch<kind>::carried_position(std::uint32_t i, const Weights& w) const {
  return flushed(combine(corners_of(now_, vertices_[i]), shares_of(w)));
}

// The same; nothing where the filter does not prove that it lies inside the moved simplex, or where it is unknown.
template <CacheKind kind>
inline std::optional<Vec3> Batch<kind>::carried_position_inside(std::uint32_t i) const {
  const Vec3 x = carried_position(i, determinants_of(previous_determinants_.data(), i));
  return Determinants(corners_of(now_, vertices_[i]), x).all_proved_positive() ? std::optional(x) : std::nullopt;
}

// Whether a particle that touches a wall stays where it is: then it keeps touching the wall.
template <CacheKind kind>
inline bool Batch<kind>::rests(std::uint32_t i) const {
  if constexpr (!moved) return states_[i].position == targets_[i];
  const auto carried = carried_position_inside(i);
  return !carried || *carried == targets_[i];
}

// Prefetches the cells of the remaining steps, and keeps those in remaining_ that go on. Returns their number.
template <CacheKind kind>
inline std::uint32_t Batch<kind>::carry_remaining(std::uint32_t first, std::uint32_t remaining) {
  for (std::uint32_t l = 0; l < remaining; ++l) {
    __builtin_prefetch(map_.record(states_[first + remaining_[l]].cell));
  }
  if constexpr (!moved) return remaining;
  std::uint32_t going_on = 0;
  for (std::uint32_t l = 0; l < remaining; l += 4) {
    const std::uint32_t last = remaining - 1;
    const Index4 i = {{first + remaining_[l], first + remaining_[std::min(l + 1, last)],
                       first + remaining_[std::min(l + 2, last)], first + remaining_[std::min(l + 3, last)]}};
    going_on = carry_four(i, std::min(remaining - l, 4U), going_on, first);
  }
  return going_on;
}

// Appends to the first `going_on` entries of remaining_ those of four walks that go on: their starts, carried with the
// mesh, are proved to lie inside. The others walk apart where their targets are far, and are deferred elsewhere.
template <CacheKind kind>
inline std::uint32_t Batch<kind>::carry_four(const Index4& i, std::uint32_t count, std::uint32_t going_on,
                                             std::uint32_t first) {
  const Corners4 now = simplices_of(now_, i);
  const unsigned behind = lanes_set(BatchDeterminants(now, places_of(i)).any_negative());
  unsigned on = 0;
  for (std::uint32_t l = 0; l < 4; ++l) on |= ((carried_inside_ >> (i.at[l] - first)) & 1U) << l;
  if (on != 15U) on |= carried_inside(previous_determinants_.data(), i, now, targets_of(i));
  for (std::uint32_t l = 0; l < count; ++l) {
    const std::uint32_t particle = i.at[l];
    if (((on >> l) & 1U) == 0) {
      if (((far_away_ >> (particle - first)) & 1U) == 0 || !add_slice_walk(particle, 1)) defer(particle);
      continue;
    }
    left_behind_[particle] = ((behind >> l) & 1U) != 0;
    remaining_[going_on++] = particle - first;
  }
  return going_on;
}

// Takes each walk out of its first simplex. Those that leave their cell come last, in a row: no branch could predict
// which they are. Returns the number of all walks in rounds.
template <CacheKind kind>
inline std::size_t Batch<kind>::take_exits(std::size_t exits) {
  std::size_t next = in_rounds_;
  std::size_t out_of_cell = 0;
  for (std::size_t k = 0; k < exits; ++k) {
    const auto [i, behind, open, record] = exits_[k];
    const ParticleState& s = states_[i];
    std::uint32_t tests = 4;
    std::uint32_t exact = open;
    auto facet = static_cast<unsigned>(std::countr_zero(behind));
    if (!std::has_single_bit(behind)) {
      WalkCursor cursor = first_cursor(i, s, record, tests, exact);
      facet = first_exit(cursor, vertices_[i], behind);
      tests = cursor.tests;
      exact = cursor.exact;
    }
    // From registers: a record that was just written in parts could not be loaded as a whole yet.
    const Across across = map_.view(s.cell, record).shape().simplices()[s.simplex].across[facet];
    walks_[next] = {i, s.cell.value, across.index, across.place, tests, exact, entered, record};
    cell_exits_[out_of_cell] = {i, across, facet, tests, exact, record};
    const std::size_t leaves = across.index / Across::outer_bit;
    next += 1 - leaves;
    out_of_cell += leaves;
  }
  for (std::size_t k = 0; k < out_of_cell; ++k) {
    const auto& [i, across, facet, tests, exact, record] = cell_exits_[k];
    walks_[next] = first_cursor(i, states_[i], record, tests, exact);
    if (pass_face(walks_[next], vertices_[i], facet, across)) ++next;
  }
  return next;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
