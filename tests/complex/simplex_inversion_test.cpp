// The first inversion of a moving simplex, against Sturm's theorem over the integers.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "complex/volume_cubic.hpp"
#include "dartcast/validity.hpp"
#include "support/dyadic.hpp"
#include "support/motions.hpp"
#include "support/moving_simplex.hpp"
#include "support/tier.hpp"

namespace dartcast::flattening_test {

using test::Motion;
using test::MotionKind;
using test::Motions;
using test::MovingSimplex;

const Corners unit = {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

struct Tally {
  int none = 0, from_the_start = 0, by_kind[5] = {}, touching = 0;
};

void expect_first_root(const Motion& m, const std::optional<SimplexInversion>& found, Tally& tally) {
  const MovingSimplex truth(m.before, m.after);
  const test::Dyadic end = 1.0;
  if (!found) {
    ASSERT_EQ(truth.sign_of_volume({}), 1);
    ASSERT_FALSE(truth.has_root_by(end)) << "missed";
    ++tally.none;
    return;
  }
  if (found->kind == InversionKind::from_the_start) {
    ASSERT_LE(truth.sign_of_volume({}), 0);
    ASSERT_EQ(*found, (SimplexInversion{0.0, InversionKind::from_the_start}));
    ++tally.from_the_start;
    return;
  }
  ASSERT_NE(found->kind, InversionKind::undecidable);
  ASSERT_EQ(truth.sign_of_volume({}), 1);
  ASSERT_FALSE(truth.has_root_by(found->safe_time)) << "too late";
  const test::Dyadic next = found->safe_time + inversion_resolution;
  ASSERT_TRUE(truth.has_root_by(next)) << "too early, or invented";
  ++tally.by_kind[static_cast<int>(found->kind)];
  tally.touching += truth.sign_of_volume(next) > 0 ? 1 : 0;
}

// The parts hold only corners that are on that side of the facets' common line just before the root.
void expect_parts(const Motion& m, const SimplexInversion& found) {
  const int count = std::popcount(found.one) + std::popcount(found.other);
  ASSERT_EQ(found.one & found.other, 0);
  ASSERT_LE(std::popcount(found.one), std::popcount(found.other));
  switch (found.kind) {
    case InversionKind::vertex_face: ASSERT_EQ(std::popcount(found.one), 1); [[fallthrough]];
    case InversionKind::edge_edge: ASSERT_EQ(count, 4); break;
    case InversionKind::vertex_edge: ASSERT_EQ(count, 3); break;
    case InversionKind::vertex_vertex: ASSERT_EQ(count, 2); break;
    default: ASSERT_EQ(count, 0); return;
  }
  if (found.kind == InversionKind::edge_edge) ASSERT_TRUE(found.one & 1U);
  const MovingSimplex truth(m.before, m.after);
  const auto signs = truth.facet_signs(truth.last_before_root(140));
  unsigned positive = 0, negative = 0;
  for (unsigned i = 0; i < 4; ++i) {
    positive |= signs[i] > 0 ? 1U << i : 0U;
    negative |= signs[i] < 0 ? 1U << i : 0U;
  }
  const auto within = [](unsigned part, unsigned side) { return (part & ~side) == 0; };
  ASSERT_TRUE((within(found.one, positive) && within(found.other, negative)) ||
              (within(found.one, negative) && within(found.other, positive)))
      << "parts " << int{found.one} << ", " << int{found.other} << "; sides " << positive << ", " << negative;
}

TEST(SimplexInversion, IsTheFirstRootOfTheVolume) {
  std::array<Tally, test::motion_kinds> tallies;
  for (int i = 0; i < test::scaled(4'000, 100'000); ++i) {
    Motions motions(static_cast<std::uint64_t>(i) + 1);
    const auto kind = i % test::motion_kinds;
    const Motion m = motions.make(static_cast<MotionKind>(kind));
    const auto found = find_inversion(m.before, m.after);
    expect_first_root(m, found, tallies[static_cast<std::size_t>(kind)]);
    if (found && !HasFatalFailure()) expect_parts(m, *found);
    if (HasFatalFailure()) FAIL() << "motion " << i << " of kind " << kind;
  }
  if (test::sanitized()) return;
  const auto& of = [&](MotionKind kind) -> const Tally& { return tallies[static_cast<std::size_t>(kind)]; };
  EXPECT_GT(of(MotionKind::any).none, 20);
  EXPECT_GT(of(MotionKind::any).by_kind[0], 50);
  EXPECT_GT(of(MotionKind::any).by_kind[1], 50);
  EXPECT_GT(of(MotionKind::rotation).none, 100);
  EXPECT_GT(of(MotionKind::lattice).by_kind[2] + of(MotionKind::lattice).by_kind[3], 10);
  EXPECT_GT(of(MotionKind::multiple_root).touching, 50);
  EXPECT_GT(of(MotionKind::multiple_root).by_kind[4], 20);
  EXPECT_GT(of(MotionKind::nearly_multiple_root).none, 50);
  EXPECT_GT(of(MotionKind::nearly_multiple_root).touching, 5);
  EXPECT_GT(of(MotionKind::sliver).none, 50);
  EXPECT_EQ(of(MotionKind::translation).by_kind[0], 0);
  EXPECT_EQ(of(MotionKind::rest).by_kind[0], 0);
}

TEST(SimplexInversion, UntilAGivenTimeIsTheSameOrNothing) {
  int cut = 0, kept = 0;
  for (int i = 0; i < test::scaled(4'000, 100'000); ++i) {
    Motions motions(static_cast<std::uint64_t>(i) + 77);
    const Motion m = motions.make(static_cast<MotionKind>(i % test::motion_kinds));
    const auto whole = find_inversion(m.before, m.after);
    if (!whole) {
      EXPECT_FALSE(find_inversion(m.before, m.after, motions.random().uniform()));
      continue;
    }
    const bool from_the_start = whole->kind == InversionKind::from_the_start;
    const double next = whole->safe_time + (from_the_start ? 0.0 : inversion_resolution);
    for (const double until : {next, std::min(1.0, next * 1.5), 1.0}) {
      ASSERT_EQ(find_inversion(m.before, m.after, until), whole) << "motion " << i;
      ++kept;
    }
    if (from_the_start) continue;
    for (const double until : {whole->safe_time, 0.5 * whole->safe_time, std::nextafter(next, 0.0), 0.0}) {
      ASSERT_FALSE(find_inversion(m.before, m.after, until)) << "motion " << i;
      ++cut;
    }
  }
  if (test::sanitized()) return;
  EXPECT_GT(kept, 1000);
  EXPECT_GT(cut, 1000);
}

// Six times the coefficients of the volume in Bernstein's form, the middle ones times 3.
std::array<test::Dyadic, 4> coefficients(const Motion& m) {
  const auto det = [&](unsigned moved) {
    Corners v;
    std::array<test::Exact3<test::Dyadic>, 3> e;
    for (unsigned i = 0; i < 3; ++i) {
      v = ((moved >> i) & 1U) != 0 ? m.after : m.before;
      e[i] = minus(test::exact(v[i + 1]), test::exact(v[0]));
    }
    return test::determinant(test::Exact3<test::Dyadic>(), e[0], e[1], e[2]);
  };
  return {det(0), det(1) + det(2) + det(4), det(3) + det(5) + det(6), det(7)};
}

TEST(VolumeCubic, BoundOfCoefficientsHolds) {
  int applied = 0, misled = 0;
  for (int i = 0; i < test::scaled(10'000, 300'000); ++i) {
    Motions motions(static_cast<std::uint64_t>(i) + 5);
    Motion m = motions.make(static_cast<MotionKind>(i % test::motion_kinds));
    if (motions.random().below(2) == 0) {
      std::swap(m.before[2], m.before[3]);
      std::swap(m.after[2], m.after[3]);
    }
    const detail::VolumeCubic cubic(m.before, m.after);
    if (!cubic.applies) continue;
    ++applied;
    const auto truth = coefficients(m);
    for (unsigned k = 0; k < 4; ++k) {
      const double share = k == 0 || k == 3 ? determinant_error : detail::VolumeCubic::coefficient_error;
      const test::Dyadic bound = test::Dyadic(share) * test::Dyadic(cubic.m);
      ASSERT_FALSE(bound < (test::Dyadic(cubic.c[k]) - truth[k]).abs()) << "motion " << i << ", coefficient " << k;
    }
    const bool positive = std::all_of(truth.begin(), truth.end(), [](const test::Dyadic& c) { return c.sign() > 0; });
    if (cubic.proves_positive()) ASSERT_TRUE(positive) << "motion " << i;
    misled += !positive && detail::all_above(cubic.c, 0.0) ? 1 : 0;
  }
  // How often the coefficients without a bound would be wrong.
  if (!test::sanitized()) EXPECT_GT(misled, test::scaled(1, 50));
  EXPECT_GT(applied, test::scaled(7'000, 200'000));
}

TEST(VolumeCubic, HalvingProvesWhatIsTrueAndMuchOfIt) {
  int proved = 0, left = 0;
  for (int i = 0; i < test::scaled(2'000, 50'000); ++i) {
    Motions motions(static_cast<std::uint64_t>(i) + 31);
    const auto kind = i % 2 == 0 ? MotionKind::rotation : MotionKind::nearly_multiple_root;
    const Motion m = motions.make(kind);
    const detail::VolumeCubic cubic(m.before, m.after);
    const MovingSimplex truth(m.before, m.after);
    for (const double t : {std::floor(motions.random().uniform() * 1024.0) / 1024.0, 1.0}) {
      const bool positive = truth.sign_of_volume({}) > 0 && !truth.has_root_by(t);
      const bool is_proved = cubic.proves_positive_until(t);
      if (is_proved) ASSERT_TRUE(positive) << "motion " << i;
      if (kind == MotionKind::nearly_multiple_root || !cubic.applies) continue;
      proved += is_proved ? 1 : 0;
      left += positive && !is_proved ? 1 : 0;
    }
  }
  if (!test::sanitized()) EXPECT_GT(proved, 5 * left) << left;
}

// A motion of one corner of the unit simplex, or of two.
SimplexInversion flattening_of(Corners after) {
  const auto found = find_inversion(unit, after);
  return found ? *found : SimplexInversion{-1.0};
}

TEST(SimplexInversion, NamesWhatMeets) {
  Corners after = unit;
  after[3] = {0.25, 0.25, -1};  // corner 3 through the facet below it, at 1/2
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.5 - inversion_resolution, InversionKind::vertex_face, 0b1000, 0b0111}));
  after[3] = {4, 4, -1};  // at (2, 2, 0): the edge from there to the origin crosses the one from 1 to 2
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.5 - inversion_resolution, InversionKind::edge_edge, 0b1001, 0b0110}));
  after[3] = {1, 1, -1};  // at (1/2, 1/2, 0): on the edge from 1 to 2
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.5 - inversion_resolution, InversionKind::vertex_edge, 0b1000, 0b0110}));
  after[3] = {0, 0, -3};  // at corner 0, at 1/4
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.25 - inversion_resolution, InversionKind::vertex_vertex, 0b0001, 0b1000}));
  after[3] = {-2, 0, -1};  // at (-1, 0, 0): corner 0 is then between it and corner 1
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.5 - inversion_resolution, InversionKind::vertex_edge, 0b0001, 0b1010}));
  after[3] = {-2, -2, -1};  // at (-1, -1, 0): corner 0 comes to lie in the triangle
  EXPECT_EQ(flattening_of(after),
            (SimplexInversion{0.5 - inversion_resolution, InversionKind::vertex_face, 0b0001, 0b1110}));
  after = {Vec3{0, 0, 0}, {1, 0, 0}, {2, -1, 0}, {3, 0, -1}};  // all on the x axis at 1/2
  EXPECT_EQ(flattening_of(after), (SimplexInversion{0.5 - inversion_resolution, InversionKind::line}));
  after = {Vec3{0, 0, 0}, {-3, 0, 0}, {0, -3, 0}, {0, 0, -3}};  // all at one point at 1/4
  EXPECT_EQ(flattening_of(after), (SimplexInversion{0.25 - inversion_resolution, InversionKind::line}));
}

TEST(SimplexInversion, EndsOfTheStepAndItsInside) {
  Corners after = unit;
  after[3] = {0.25, 0.25, 0};  // flat at the end: counts
  EXPECT_EQ(flattening_of(after).safe_time, 1.0 - inversion_resolution);
  after[3].z = smallest_magnitude;
  EXPECT_FALSE(find_inversion(unit, after));
  EXPECT_EQ(find_inversion(after, unit), std::nullopt);
  after[3].z = 0.0;
  EXPECT_EQ(find_inversion(after, unit), (SimplexInversion{0.0, InversionKind::from_the_start}));
  // Turned by 180 degrees, it touches zero at 1/2 and is positive before and after.
  after = {Vec3{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  EXPECT_EQ(flattening_of(after).safe_time, 0.5 - inversion_resolution);
  // Inverted at once: only the start is safe.
  const Corners low = {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 0x1p-50}};
  after = unit;
  after[3] = {0.25, 0.25, -1};
  EXPECT_EQ(find_inversion(low, after), (SimplexInversion{0.0, InversionKind::vertex_face, 0b1000, 0b0111}));
}

TEST(SimplexInversion, OfWhatIsOutOfRangeIsUndecidable) {
  const double infinity = std::numeric_limits<double>::infinity();
  const SimplexInversion undecidable{0.0, InversionKind::undecidable};
  for (const double bad : {std::nan(""), infinity, -infinity, 0x1p+400}) {
    for (unsigned place = 0; place < 24; ++place) {
      Motion m{unit, unit};
      Vec3& p = (place < 12 ? m.before : m.after)[place % 4];
      (place / 4 % 3 == 0 ? p.x : place / 4 % 3 == 1 ? p.y : p.z) = bad;
      EXPECT_EQ(find_inversion(m.before, m.after), undecidable) << "place " << place << ", " << bad;
      EXPECT_EQ(find_inversion(m.before, m.after, 0.25), undecidable);
    }
  }
}

}  // namespace dartcast::flattening_test
