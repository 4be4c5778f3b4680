// The first simplex of each step, where most steps end. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
//
// Steps are tested block by block, four in a vector, with as few branches as possible. Those that go on are then sorted
// by how they do.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracking/batch/batch_slice_starts.inl"
#include "tracking/batch/batch_steps.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline std::uint32_t lowest(std::uint32_t bits) { return static_cast<std::uint32_t>(std::countr_zero(bits)); }

// A block of steps; in masks there is a bit for each.
struct FirstBlock {
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t all;
  std::array<long long, block> signs;  // FacetSigns4
  std::uint32_t inside;                // targets strictly inside, or on facets but surely on no wall

  void begin(std::uint32_t i, std::uint32_t size) {
    first = i;
    count = std::min(block, size - i);
    all = count == block ? ~std::uint32_t{0} : (std::uint32_t{1} << count) - 1;
    inside = 0;
  }
  [[nodiscard]] FacetSigns4 signs_of(std::uint32_t k) const { return FacetSigns4(signs[k]); }
  void store(const Mask4& of_four, std::uint32_t k) { store_bits(of_four, &signs[k]); }
};

// Four in a row from i on.
template <bool moved>
inline Vec3x4 targets_from(const Batch<moved>& b, std::uint32_t i) {
  return i + 4 <= b.size ? load_vec3x4(b.targets + i) : b.targets_of(index4_from(i, b.size));
}

// Ends the steps whose targets are inside: nothing in a simplex is in the way.
template <bool moved>
inline void end_inside(Batch<moved>& b, const FirstBlock& at) {
  for (std::uint32_t in = at.inside; in != 0; in &= in - 1) {
    const std::uint32_t i = at.first + lowest(in);
    b.states[i].position = b.targets[i];
    b.states[i].touching_count = 0;
  }
  const auto ended = static_cast<std::uint64_t>(std::popcount(at.inside));
  b.counters.particle_steps += ended;
  b.counters.orientation.tests += 4 * ended;
  b.counters.histogram[4] += ended;
  b.counters.forecast_kept += ended;
}

// Defers the steps among those in the mask `some` that are held, or that touch a wall and rest there. Returns a mask of
// them.
template <bool moved, class Rests>
inline std::uint32_t defer_unusual(Batch<moved>& b, const FirstBlock& at, std::uint32_t some, const Rests& rests) {
  std::uint32_t deferred = 0;
  std::uint32_t unusual = some & held_or_touching(b.states + at.first, at.count);
  for (; unusual != 0; unusual &= unusual - 1) {
    const std::uint32_t i = at.first + lowest(unusual);
    if (!b.states[i].held && !rests(i)) continue;
    b.defer(i);
    deferred |= unusual & (0U - unusual);
  }
  return deferred;
}

// If vertices stand still, by barycentric coordinates: only steps that leave the simplex read the scene.
class FirstSimplexAtRest {
 public:
  FirstSimplexAtRest(Batch<false>& batch, bool cells_positive, WalkLists& lists)
      : b(batch), cells_positive_(cells_positive), out(lists) {}

  void run() {
    std::uint32_t sorted = 0;
    for (std::uint32_t first = 0; first < b.size; first += block) {
      at.begin(first, b.size);
      test();
      const std::uint32_t deferred =
          defer_unusual(b, at, at.all, [&](std::uint32_t i) { return b.states[i].position == b.targets[i]; });
      at.inside &= ~deferred;
      on_facets_ &= ~deferred;
      count_zeros();
      end_inside(b, at);
      if (on_facets_ != 0) end_on_facets();
      const std::uint32_t prefetched = undecided_.count;  // their corners
      list_remaining(at.all & ~(deferred | at.inside | on_facets_));
      for (; sorted + 4 <= prefetched; sorted += 4) sort_undecided(sorted);
    }
    for (; sorted < undecided_.count; sorted += 4) sort_undecided(sorted);
  }

 private:
  // Stores a bit for each facet that a target is behind; none at all if the sign of any coordinate is not proved.
  void test() {
    on_facets_ = still_free_ = 0;
    for (std::uint32_t k = 0; k < at.count; k += 4) {
      const Vec3x4 q = targets_from(b, at.first + k);
      const SimplexCache4& caches = b.caches[(at.first + k) / 4];
      const Double4 c[4] = {coordinate_of(caches, 0, q), coordinate_of(caches, 1, q), coordinate_of(caches, 2, q),
                            coordinate_of(caches, 3, q)};
      const Double4 m[4] = {magnitude(c[0]), magnitude(c[1]), magnitude(c[2]), magnitude(c[3])};
      const Double4 lowest = smaller(smaller(c[0], c[1]), smaller(c[2], c[3]));
      at.inside |= lanes_set(lowest > coordinate_margin) << k;
      const Mask4 in_range = (larger(larger(m[0], m[1]), larger(m[2], m[3])) <= max_for_sign) & (lowest > -surely_near);
      const Mask4 known = (smaller(smaller(m[0], m[1]), smaller(m[2], m[3])) > coordinate_margin) & in_range;
      const Mask4 negative = facet_bits(c[0] < 0.0, c[1] < 0.0, c[2] < 0.0, c[3] < 0.0);
      at.store(known & negative, k);
      if (any_flag(b.flags + at.first + k)) {
        const Mask4 proved = facet_bits(m[0] > coordinate_margin, m[1] > coordinate_margin, m[2] > coordinate_margin,
                                        m[3] > coordinate_margin);
        test_zeros(k, q, in_range, proved, negative);
      }
    }
    at.inside &= at.all;
    on_facets_ &= at.all;
  }

  // The same if coordinates are exact: zeros are proved, too. A particle with exact coordinates is on no wall. A
  // target that lies on no other facets than its particle is on no wall either: such a wall would hold the particle.
  [[gnu::noinline]] void test_zeros(std::uint32_t k, const Vec3x4& q, const Mask4& in_range, const Mask4& proved,
                                    const Mask4& negative) {
    CacheFlags* const of_four = b.flags + at.first + k;
    const Mask4 flags = {of_four[0], of_four[1], of_four[2], of_four[3]};
    const Mask4 zeros = proved_zeros(b.caches[(at.first + k) / 4], q) & ((flags & splat_bits(exact_flag)) != 0);
    const Mask4 known = in_range & ((proved | zeros) == splat_bits(15));
    at.store(known & (negative | (zeros << 4)), k);
    const Mask4 on_facets = known & (negative == 0) & (zeros != 0);
    const Mask4 still_free = on_facets & ((zeros & ~flags) == 0);
    on_facets_ |= lanes_set(on_facets & ~still_free) << k;
    still_free_ |= lanes_set(still_free) << k;
    at.inside |= lanes_set(still_free) << k;
    set_facet_flags(zeros, at.inside >> k, of_four);
  }

  void count_zeros() {
    for (std::uint32_t on = at.inside & still_free_; on != 0; on &= on - 1)
      b.counters.orientation.exact += static_cast<unsigned>(std::popcount(at.signs_of(lowest(on)).zero()));
  }

  // Ends the steps whose targets lie on facets of the simplex that the particle is in.
  [[gnu::noinline]] void end_on_facets() {
    for (std::uint32_t bits = on_facets_; bits != 0; bits &= bits - 1) {
      const std::uint32_t i = at.first + lowest(bits);
      const unsigned on = at.signs_of(lowest(bits)).zero();
      const WalkCursor cursor =
          first_cursor(i, b.states[i], b.map.record(b.states[i].cell), 4, static_cast<unsigned>(std::popcount(on)));
      if (b.is_off_walls(cursor, b.vertices[i], on)) b.arrive(cursor, b.vertices[i], on);
    }
  }

  // Prefetches what they need next.
  void list_remaining(std::uint32_t remaining) {
    std::uint32_t exits = out.exits.count;
    std::uint32_t undecided = undecided_.count;
    for (; remaining != 0; remaining &= remaining - 1) {
      const std::uint32_t i = at.first + lowest(remaining);
      const std::uint32_t* record = b.map.record(b.states[i].cell);
      __builtin_prefetch(record);
      const FacetSigns4 signs = at.signs_of(lowest(remaining));
      const unsigned behind = signs.negative();
      if (!std::has_single_bit(behind)) prefetch_corners(b.now, b.vertices[i]);
      // Written to both lists: no branch could predict which.
      out.exits.at[exits] = exit_candidate(i, behind, signs.zero(), record);
      undecided_.at[undecided] = {i, record};
      const std::uint32_t proved = behind != 0 ? 1 : 0;
      exits += proved;
      undecided += 1 - proved;
    }
    out.exits.count = exits;
    undecided_.count = undecided;
  }

  // Four steps that coordinates do not decide, from number k on: walks to far targets, and others in rounds.
  void sort_undecided(std::uint32_t k) {
    const Index4 i = undecided_.particles(k);
    const BatchDeterminants determinants(b.simplices_of(b.now, i), b.targets_of(i));
    const unsigned far = lanes_set(determinants.far_away());
    const unsigned farther = lanes_set(determinants.far_away(farther_coordinate));
    const std::uint32_t end = std::min(k + 4, undecided_.count);
    for (std::uint32_t l = 0; k + l < end; ++l) {
      const WalkStart walk = undecided_.at[k + l];
      if (((far >> l) & 1U) != 0)
        (cells_positive_ && ((farther >> l) & 1U) != 0 ? out.farther : out.far).add(walk);
      else  // rounds count three more tests
        out.rounds.add(first_cursor(walk.particle, b.states[walk.particle], walk.record, 1, 0));
    }
  }

  Batch<false>& b;
  bool cells_positive_;
  WalkLists& out;
  FirstBlock at;
  std::uint32_t on_facets_;   // targets there, maybe on walls
  std::uint32_t still_free_;  // there, on no wall
  BatchList<WalkStart> undecided_;
};

// If vertices move, by determinants.
class FirstSimplexMoved {
 public:
  FirstSimplexMoved(Batch<true>& batch, const StepOptions& options, WalkLists& lists)
      : b(batch), tolerance_(options.tolerance), splitting_(batch, options, lists.apart), out(lists) {}

  void run() {
    for (std::uint32_t i = 0; i < std::min(b.size, block); ++i) prefetch_corners(b.now, b.vertices[i]);
    for (std::uint32_t first = 0; first < b.size; first += block) {
      at.begin(first, b.size);
      test();
      std::uint32_t gone = splitting_.split(first, at.all & ~one_part_);
      gone |= defer_unusual(b, at, at.all & ~gone, [&](std::uint32_t i) { return rests(i); });
      at.inside &= at.all & ~gone;
      end_inside(b, at);
      carry(at.all & ~(gone | at.inside));
    }
  }

 private:
  void test() {
    far_away_ = one_part_ = 0;
    for (std::uint32_t k = 0; k < at.count; k += 4) {
      for (std::uint32_t i = at.first + block + k; i < std::min(at.first + block + k + 4, b.size); ++i)
        prefetch_corners(b.now, b.vertices[i]);
      const Index4 i = index4_from(at.first + k, b.size);
      const Corners4 now = b.simplices_of(b.now, i);
      const Vec3x4 q = targets_from(b, at.first + k);
      const BatchDeterminants d(now, q);
      const Mask4 signs = d.signs(now, q);
      at.store(signs, k);
      at.inside |= lanes_set(signs == splat_bits(FacetSigns4::valid)) << k;
      far_away_ |= lanes_set(d.far_away()) << k;
      SimplexCache4& old = b.caches[(at.first + k) / 4];
      const OnePart one(old, d.relative, b.places_of(i), q, tolerance_);
      Mask4 proved = one.by_size();
      if (lanes_set(proved) != 15U) proved |= one.by_shape();
      one_part_ |= lanes_set(proved) << k;
      b.old_determinants[(at.first + k) / 4] = old.w;
      store_previous_geometry(d, old);  // steps that go on, or are deferred, overwrite it later
    }
  }

  // Whether a particle that touches a wall, and has no far target, stays where the mesh carries it: then it keeps
  // touching the wall. So, too, if the filter does not prove that it is carried to the inside.
  [[nodiscard]] bool rests(std::uint32_t i) const {
    if (is_far(i)) return false;
    const Vec3 x = b.start_of(i);
    return !Determinants(corners_of(b.now, b.vertices[i]), x).all_proved_positive() || x == b.targets[i];
  }
  [[nodiscard]] bool is_far(std::uint32_t i) const { return ((far_away_ >> (i - at.first)) & 1U) != 0; }

  // Prefetches the cells of the remaining steps, then sorts these, four at a time.
  void carry(std::uint32_t remaining) {
    std::array<std::uint32_t, block> left;
    std::uint32_t count = 0;
    for (; remaining != 0; remaining &= remaining - 1) {
      left[count] = at.first + lowest(remaining);
      __builtin_prefetch(b.map.record(b.states[left[count++]].cell));
    }
    for (std::uint32_t l = 0; l < count; l += 4) {
      const Index4 k = index4_from(l, count);
      carry_four({{left[k.at[0]], left[k.at[1]], left[k.at[2]], left[k.at[3]]}}, std::min(count - l, 4U));
    }
  }

  // Four steps whose starts the mesh carries. If these are not proved to lie inside, the others walk apart if their
  // targets are far, and are deferred elsewhere.
  void carry_four(const Index4& i, std::uint32_t count) {
    const Corners4 now = b.simplices_of(b.now, i);
    const unsigned left_behind = lanes_set(BatchDeterminants(now, b.places_of(i)).any_negative());
    const Vec3x4 q = b.targets_of(i);
    const Vec3x4 x = b.starts_of(i, now);  // not a number if it is unknown
    const unsigned inside =
        lanes_set(BatchDeterminants(now, x).all_positive() & ((x.x != q.x) | (x.y != q.y) | (x.z != q.z)));
    for (std::uint32_t l = 0; l < count; ++l) {
      const std::uint32_t particle = i.at[l];
      if (((inside >> l) & 1U) == 0) {
        if (!is_far(particle) || !splitting_.add(particle, 1)) b.defer(particle);
        continue;
      }
      b.left_behind[particle] = ((left_behind >> l) & 1U) != 0;
      go_on(particle);
    }
  }

  void go_on(std::uint32_t i) {
    const std::uint32_t* record = b.map.record(b.states[i].cell);
    const FacetSigns4 signs = at.signs_of(i - at.first);
    if (is_far(i)) return out.far.add({i, record});
    if (!signs.is_known()) return static_cast<void>(b.defer(i));
    if (signs.negative() != 0) return out.exits.add(exit_candidate(i, signs.negative(), signs.open(), record));
    const WalkCursor cursor =
        first_cursor(i, b.states[i], record, 4, static_cast<unsigned>(std::popcount(signs.open())));
    if (signs.zero() == 0 || b.is_off_walls(cursor, b.vertices[i], signs.zero())) b.end(cursor);
  }

  Batch<true>& b;
  double tolerance_;
  Splitting splitting_;
  WalkLists& out;
  FirstBlock at;
  std::uint32_t far_away_;  // targets some simplices away
  std::uint32_t one_part_;  // steps that need no splitting
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
