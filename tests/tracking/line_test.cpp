// Walks along their lines, simplex by simplex: whatever they call decided has its exact sign.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"
#include "tracking/batch/batch_line_walks.inl"

namespace dartcast::test::line_test {

using namespace detail;            // NOLINT(google-build-using-namespace)
using namespace detail::portable;  // NOLINT(google-build-using-namespace)

struct Segment {
  dartcast::Corners v;
  Vec3 p;
  Vec3 q;
};

// A tetrahedron of any shape, at any distance, and a segment that begins about inside. Some pass an edge closely, some
// end near a facet, some are turned inside out.
Segment any_segment(Random& random) {
  const double size = std::exp2(random.uniform(-60.0, 60.0));
  const double flat = std::exp2(-random.uniform(0.0, 1.0) * (random.below(4) == 0 ? 60.0 : 4.0));
  const Vec3 away = random_vector(random) * (random.below(2) == 0 ? 0.0 : size * std::exp2(random.uniform(0.0, 50.0)));
  Segment s;
  for (Vec3& x : s.v) {
    x = random_vector(random) * size;
    (random.below(2) == 0 ? x.x : x.z) *= flat;
    x = x + away;
  }
  if ((volume_sign(s.v) == Sign::negative) != (random.below(16) == 0)) std::swap(s.v[0], s.v[1]);
  const auto inside = [&] {
    Vec3 sum;
    double weights = 0.0;
    for (const Vec3& x : s.v) {
      const double w = random.below(16) == 0 ? 0.0 : random.uniform();
      sum += (x - s.v[0]) * w;
      weights += w;
    }
    return s.v[0] + sum * (1.0 / (weights + 1e-300));
  };
  s.p = inside();
  const double far = std::exp2(random.uniform(-1.0, random.below(2) == 0 ? 2.0 : 12.0));
  const Vec3& a = s.v[random.below(4)];
  const Vec3& b = s.v[random.below(4)];
  const Vec3 through = random.below(4) == 0 ? a + (b - a) * random.uniform() : inside();
  s.q = s.p + (through - s.p) * far + random_vector(random) * (size * std::exp2(-random.uniform(0.0, 60.0)));
  return s;
}

// Whether the line from p to q passes a triangle inside, in the direction that its corners turn around.
bool passes(const Segment& s, const std::array<std::uint8_t, 3>& corners) {
  bool inside = true;
  for (unsigned i = 0; i < 3; ++i)
    inside = inside && orient3d(s.p, s.v[corners[i]], s.v[corners[(i + 1) % 3]], s.q) == Sign::positive;
  return inside;
}

struct Tally {
  int begun = 0;
  int decided = 0;
  int near_end = 0;
  int arrived = 0;
};

// The first mistake of a walk through the simplex of a segment, or nothing.
std::string check(const Segment& s, const LineStarts4& starts, unsigned lane, LineWalks4& walks, Tally& tally) {
  const unsigned facet = facets_entered[static_cast<std::size_t>(starts.turns[lane])];
  if (facet == 4 || starts.in_range[lane] == 0) return "";
  walks.begin(lane, starts, lane, facet);
  if (!walks.is_inside(lane)) return "";
  ++tally.begun;
  if (!passes(s, facet_corners[facet])) return "enters by another facet";
  LineWalks4 passed = walks;
  passed.pass(splat(s.v[facet]));
  if (((passed.undecided >> lane) & 1U) != 0) return "";
  ++tally.decided;
  if (volume_sign(s.v) != Sign::positive) return "passes a simplex that is not positive";
  const LineTurn way = line_turns[4 * facet][static_cast<std::size_t>(passed.slot[lane])];
  const auto corners = exit_corners(way.facet);
  if (!passes(s, corners)) return "leaves by another facet";
  for (unsigned k = 0; k < 3; ++k) {
    const Vec3x4 corner = walks.line.project(splat(s.v[corners[k]]));
    const Vec3x4& kept = passed.corner[(k + way.turn) % 3];
    if (corner.x[lane] != kept.x[lane] || corner.y[lane] != kept.y[lane] || corner.z[lane] != kept.z[lane])
      return "corners in other slots";
    if (!(passed.edge_side[k][lane] > 0.0)) return "an edge that does not turn around the line";
  }
  const Sign side = orient_facet(s.v, way.facet, s.q);
  if (((passed.near_end >> lane) & 1U) == 0) return side == Sign::negative ? "" : "misses the end";
  ++tally.near_end;
  const int said = passed.side_of_target(lane);
  if ((said > 0 && side != Sign::positive) || (said < 0 && side != Sign::negative)) return "the end on another side";
  tally.arrived += said > 0 ? 1 : 0;
  return "";
}

TEST(LineWalks, DecideOnlyWhatIsSo) {
  Random random(20261127);
  Tally tally;
  const int rounds = scaled(100000, 3000000);
  for (int round = 0; round < rounds; ++round) {
    std::array<Segment, 4> s;
    for (Segment& one : s) one = any_segment(random);
    std::array<Vec3, 16> points;
    for (unsigned l = 0; l < 4; ++l) std::copy(s[l].v.begin(), s[l].v.end(), points.begin() + 4 * l);
    const LineStarts4 starts(Corners4(points.data(), {0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}),
                             load_vec3x4(s[0].p, s[1].p, s[2].p, s[3].p), load_vec3x4(s[0].q, s[1].q, s[2].q, s[3].q));
    LineWalks4 walks{};
    for (unsigned l = 0; l < 4; ++l) {
      const std::string wrong = check(s[l], starts, l, walks, tally);
      ASSERT_EQ(wrong, "") << "round " << round << ", lane " << l;
    }
  }
  EXPECT_GT(tally.begun, rounds * 2);
  EXPECT_GT(tally.decided, rounds);
  EXPECT_GT(tally.near_end, rounds / 4);
  EXPECT_GT(tally.arrived, rounds / 16);
}

}  // namespace dartcast::test::line_test
