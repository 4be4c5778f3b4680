// Moving pairs against the truth of published queries, against an inclusion search that shares nothing with the code, and
// against themselves where points are named, turned, mirrored in time or scaled in another way.
#include "predicates/moving_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <fstream>
#include <queue>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::test::moving_pair_test {

using detail::exact_touch;
using detail::FilterAnswer;
using detail::filtered_touch;
using detail::first_touch;
using detail::MovingPair;
using detail::PairKind;

constexpr PairKind kinds[] = {PairKind::vertex_face, PairKind::edge_edge};

// The filter proves nothing, or says what integers say, at a time that is not late and at most 2^-20 early. In
// double-doubles it is their very time.
void expect_filter_agrees(const MovingPair& pair, PairKind kind, const std::string& where) {
  const auto exact = exact_touch(pair, kind);
  const auto filtered = filtered_touch(pair, kind);
  const auto either = first_touch(pair, kind);
  ASSERT_EQ(either.has_value(), exact.has_value()) << where;
  ASSERT_EQ(detail::touches(pair, kind), exact.has_value()) << where;
  const auto fine = detail::finely_filtered_touch(pair, kind);
  if (fine.answer != FilterAnswer::undecided) {
    ASSERT_EQ(fine.answer == FilterAnswer::touching, exact.has_value()) << where;
    if (exact) ASSERT_EQ(fine.time, *exact) << where;
  }
  if (filtered.answer == FilterAnswer::undecided) return;
  ASSERT_EQ(filtered.answer == FilterAnswer::touching, exact.has_value()) << where;
  if (!exact) return;
  EXPECT_LE(filtered.time, *exact + 0x1p-40) << where;
  EXPECT_GE(filtered.time, *exact - 0x1p-20) << where;
}

struct Search {
  bool decided = true;
  double time = 2.0;  // of the earliest part that may hold a touch; 2: there is none
};

// A touch is a zero of a function of time and two weights that is linear in each of them. Its values over a box are in the
// hull of those at the corners. Boxes are halved, the earliest first. Coordinates are small integers and boxes dyadic, so
// doubles compute this without rounding.
class Inclusion {
 public:
  Inclusion(const MovingPair& pair, PairKind kind) : pair_(pair), kind_(kind) {}

  [[nodiscard]] Search search() const {
    constexpr int depth = 10;
    constexpr int most_boxes = 30000;
    std::priority_queue<Box, std::vector<Box>, Later> open;
    open.push({});
    for (int boxes = 0; !open.empty(); ++boxes) {
      const Box box = open.top();
      open.pop();
      if (!may_hold_zero(box)) continue;
      if (box.halvings == depth) return {true, box.low[0]};
      if (boxes > most_boxes) return {false, box.low[0]};
      for (unsigned part = 0; part < 8; ++part) {
        Box half{box.low, box.size / 2, box.halvings + 1};
        for (unsigned i = 0; i < 3; ++i) half.low[i] += (part >> i & 1U) != 0 ? half.size : 0.0;
        open.push(half);
      }
    }
    return {};
  }

 private:
  struct Box {
    std::array<double, 3> low{};
    double size = 1.0;
    int halvings = 0;
  };
  struct Later {
    bool operator()(const Box& a, const Box& b) const {
      return std::pair(a.low[0], -a.halvings) > std::pair(b.low[0], -b.halvings);
    }
  };

  [[nodiscard]] Vec3 gap(double t, double u, double v) const {
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = pair_.from[i] * (1 - t) + pair_.to[i] * t;
    if (kind_ == PairKind::edge_edge) return p[0] * (1 - u) + p[1] * u - p[2] * (1 - v) - p[3] * v;
    return p[0] - p[1] * (1 - u - v) - p[2] * u - p[3] * v;
  }

  [[nodiscard]] bool may_hold_zero(const Box& box) const {
    if (kind_ == PairKind::vertex_face && box.low[1] + box.low[2] > 1) return false;
    Vec3 low = gap(box.low[0], box.low[1], box.low[2]);
    Vec3 high = low;
    for (unsigned corner = 1; corner < 8; ++corner) {
      const auto at = [&](unsigned i) { return box.low[i] + ((corner >> i & 1U) != 0 ? box.size : 0.0); };
      const Vec3 g = gap(at(0), at(1), at(2));
      low = {std::min(low.x, g.x), std::min(low.y, g.y), std::min(low.z, g.z)};
      high = {std::max(high.x, g.x), std::max(high.y, g.y), std::max(high.z, g.z)};
    }
    return low.x <= 0 && high.x >= 0 && low.y <= 0 && high.y >= 0 && low.z <= 0 && high.z >= 0;
  }

  const MovingPair& pair_;
  PairKind kind_;
};

// Few integers, so that points coincide, planes stay, edges are parallel or have no length.
MovingPair lattice_pair(std::mt19937_64& random, int range) {
  const auto any = [&] { return static_cast<double>(static_cast<int>(random() % (2 * range + 1)) - range); };
  MovingPair pair;
  const auto mode = random() % 4;
  for (std::size_t i = 0; i < 4; ++i) {
    pair.from[i] = {any(), any(), any()};
    pair.to[i] = {any(), any(), any()};
    if (mode == 1) pair.from[i].z = pair.to[i].z = 0;
    if (mode == 2 && i > 0) pair.to[i] = pair.from[i];
  }
  if (mode == 3) {
    pair.from[3] = pair.from[2];
    pair.to[3] = pair.to[2];
  }
  return pair;
}

template <class Change>
void change_points(MovingPair& pair, Change&& change) {
  for (auto* points : {&pair.from, &pair.to}) change(*points);
}

MovingPair renamed(MovingPair pair, PairKind kind, std::uint64_t bits) {
  change_points(pair, [&](std::array<Vec3, 4>& p) {
    if (kind == PairKind::edge_edge) {
      if ((bits & 1U) != 0) std::swap(p[0], p[1]);
      if ((bits & 2U) != 0) std::swap(p[2], p[3]);
      if ((bits & 4U) != 0) p = {p[2], p[3], p[0], p[1]};
    } else {
      std::swap(p[1 + bits % 3], p[1 + bits / 3 % 3]);
    }
    for (Vec3& v : p) v = {v.y, v.z, v.x};
  });
  return pair;
}

double to_double(const std::string& numerator, const std::string& denominator) {
  using boost::multiprecision::cpp_int;
  return boost::multiprecision::cpp_rational(cpp_int(numerator), cpp_int(denominator)).convert_to<double>();
}

struct Query {
  MovingPair pair;
  bool touches = false;
};

std::vector<Query> read_queries(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::vector<Query> queries;
  Query query;
  std::size_t row = 0;
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::array<std::string, 7> w;
    for (std::string& word : w) words >> word;
    if (w[6].empty()) continue;
    (row < 4 ? query.pair.from : query.pair.to)[row % 4] = {to_double(w[0], w[1]), to_double(w[2], w[3]),
                                                            to_double(w[4], w[5])};
    query.touches = w[6] == "1";
    row = (row + 1) % 8;
    if (row == 0) queries.push_back(query);
  }
  return queries;
}

TEST(MovingPair, AnswersPublishedQueries) {
  NEED_DATA("2,429 queries of a benchmark of collision detection");
  std::size_t count = 0;
  std::size_t touching = 0;
  for (const auto& file : std::filesystem::directory_iterator(data_folder() / "queries")) {
    if (file.path().extension() != ".csv") continue;
    const std::string name = file.path().stem().string();
    const PairKind kind = name.ends_with("edge-edge") ? PairKind::edge_edge : PairKind::vertex_face;
    for (const Query& query : read_queries(file.path())) {
      const std::string where = name + ", query " + std::to_string(++count);
      EXPECT_EQ(exact_touch(query.pair, kind).has_value(), query.touches) << where;
      expect_filter_agrees(query.pair, kind, where);
      touching += query.touches ? 1 : 0;
    }
  }
  EXPECT_EQ(count, 2429U);
  EXPECT_EQ(touching, 216U);
}

TEST(MovingPair, AgreesWithInclusionOnLattices) {
  std::mt19937_64 random(7);
  int decided = 0;
  int open = 0;
  for (const PairKind kind : kinds) {
    for (int i = 0; i < scaled(1500, 20000); ++i) {
      const MovingPair pair = lattice_pair(random, 1 + i % 4);
      const auto exact = exact_touch(pair, kind);
      const Search found = Inclusion(pair, kind).search();
      const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + ", pair " + std::to_string(i);
      if (exact) {
        ASSERT_LE(found.time, *exact + 0x1p-40) << where << ": no box holds the touch";
      }
      if (!found.decided) continue;
      ++decided;
      // Boxes have sides of 2^-10: near misses look like touches, and touches begin some boxes early.
      const double exact_time = exact.value_or(2.0);
      if (found.time < exact_time - 0.02) ++open;
    }
  }
  EXPECT_GT(decided, scaled(2700, 36000));
  EXPECT_LT(open, decided / 100);
}

TEST(MovingPair, KeepsItsAnswerUnderSymmetries) {
  std::mt19937_64 random(11);
  int touching = 0;
  for (const PairKind kind : kinds) {
    for (int i = 0; i < scaled(6000, 60000); ++i) {
      const MovingPair pair = lattice_pair(random, 1 + i % 4);
      const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + ", pair " + std::to_string(i);
      const auto exact = exact_touch(pair, kind);
      touching += exact ? 1 : 0;
      expect_filter_agrees(pair, kind, where);

      MovingPair other = renamed(pair, kind, random());
      ASSERT_EQ(exact_touch(other, kind), exact) << where;
      std::swap(other.from, other.to);
      ASSERT_EQ(exact_touch(other, kind).has_value(), exact.has_value()) << where;

      other = pair;
      change_points(other, [](std::array<Vec3, 4>& p) {
        for (Vec3& v : p) v = {v.x * 0x1p-500, v.y * 0x1p+400, v.z};
      });
      ASSERT_EQ(exact_touch(other, kind), exact) << where;
      ASSERT_EQ(first_touch(other, kind).has_value(), exact.has_value()) << where;
    }
  }
  EXPECT_GT(touching, scaled(2000, 20000));
}

enum class Motion : std::uint8_t {
  generic,
  near_plane,              // points near one plane throughout
  far_away,                // the same far from the origin, where differences lose digits
  tiny,                    // the same, so small that products of three coordinates underflow
  large_face_turns_round,  // the vertex stays over the face, whose plane it meets up to three times
  at_rest                  // the vertex stays on the face, but for rounding
};

MovingPair random_pair(std::mt19937_64& random, Motion motion) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  MovingPair pair;
  for (std::size_t i = 0; i < 4; ++i) {
    pair.from[i] = {any(random), any(random), any(random)};
    pair.to[i] = pair.from[i] + 0.3 * Vec3{any(random), any(random), any(random)};
    if (motion == Motion::large_face_turns_round) pair.to[i] = {any(random), any(random), any(random)};
  }
  if (motion == Motion::at_rest) {
    const auto on_face = [&](const std::array<Vec3, 4>& p) {
      const Vec3 off = Vec3{any(random), any(random), any(random)} * 0x1p-52;
      return p[1] * 0.3125 + p[2] * 0.25 + p[3] * 0.4375 + off;
    };
    pair.from[0] = on_face(pair.from);
    pair.to[0] = on_face(pair.to);
    return pair;
  }
  change_points(pair, [motion](std::array<Vec3, 4>& p) {
    for (Vec3& v : p) {
      if (motion == Motion::generic) continue;
      if (motion == Motion::large_face_turns_round) {
        v.z *= 10;
        continue;
      }
      v.z = 0.5 * v.x + 0.25 * v.y;
      if (motion == Motion::far_away) v += Vec3{1000, 0, 1000};
      if (motion == Motion::tiny) v *= 0x1p-350;
    }
    if (motion != Motion::large_face_turns_round) return;
    p[0] = {0.1 * p[0].x, 0.1 * p[0].y, 0.1 * p[0].z};
    p[1] += Vec3{-2, -2, 0};
    p[2] += Vec3{2, -2, 0};
    p[3] += Vec3{0, 2, 0};
  });
  return pair;
}

TEST(MovingPair, FilterAgreesWithIntegers) {
  std::mt19937_64 random(13);
  int unknown = 0;
  int open = 0;  // for integers
  for (const PairKind kind : kinds) {
    for (const Motion motion : {Motion::generic, Motion::near_plane, Motion::far_away, Motion::tiny,
                                Motion::large_face_turns_round, Motion::at_rest}) {
      for (int i = 0; i < scaled(3000, 30000); ++i) {
        const MovingPair pair = random_pair(random, motion);
        expect_filter_agrees(pair, kind,
                             "kind " + std::to_string(static_cast<int>(kind)) + ", motion " +
                                 std::to_string(static_cast<int>(motion)) + ", pair " + std::to_string(i));
        if (motion == Motion::at_rest && kind == PairKind::vertex_face) {
          EXPECT_EQ(filtered_touch(pair, kind).answer, FilterAnswer::undecided);
          open += detail::finely_filtered_touch(pair, kind).answer == FilterAnswer::undecided ? 1 : 0;
        }
        if (motion != Motion::generic) continue;
        unknown += filtered_touch(pair, kind).answer == FilterAnswer::undecided ? 1 : 0;
      }
    }
  }
  EXPECT_LE(unknown, scaled(3, 30)) << "the filter leaves too much to integers";
  EXPECT_LE(open, scaled(3000, 30000) / 2) << "double-doubles leave too much to integers";
}

struct Known {
  const char* what;
  PairKind kind;
  MovingPair pair;
  std::optional<double> time;
};

std::vector<Known> known_pairs() {
  using enum PairKind;
  const Vec3 o{};
  const Vec3 x{1, 0, 0};
  const Vec3 y{0, 1, 0};
  const Vec3 z{0, 0, 1};
  const Vec3 inside{0.25, 0.25, 0};
  return {
      {"through the face", vertex_face, {{inside + z, o, x, y}, {inside - z, o, x, y}}, 0.5},
      {"past the face", vertex_face, {{x + y + z, o, x, y}, {x + y - z, o, x, y}}, {}},
      {"starts on the face", vertex_face, {{inside, o, x, y}, {inside + z, o, x, y}}, 0.0},
      {"ends on the face", vertex_face, {{inside + z, o, x, y}, {inside, o, x, y}}, 1.0},
      {"through a corner", vertex_face, {{x + z, o, x, y}, {x - z, o, x, y}}, 0.5},
      {"in the plane of the face", vertex_face, {{-x, o, x, y}, {x, o, x, y}}, 0.5},
      {"in the plane, past it", vertex_face, {{-x - y, o, x, y}, {x - y, o, x, y}}, {}},
      {"face without area", vertex_face, {{0.5 * x + z, o, x, 0.5 * x}, {0.5 * x - z, o, x, 0.5 * x}}, 0.5},
      {"face that is a point", vertex_face, {{-x, o, o, o}, {3 * x, o, o, o}}, 0.25},
      {"edges that cross", edge_edge, {{z - x, z + x, -y, y}, {-z - x, x - z, -y, y}}, 0.5},
      {"edges that pass", edge_edge, {{z + 2 * x, z + 3 * x, -y, y}, {2 * x - z, 3 * x - z, -y, y}}, {}},
      {"parallel edges", edge_edge, {{z, z + x, o, x}, {-z, x - z, o, x}}, 0.5},
      {"parallel edges, one behind the other", edge_edge, {{2 * x, 3 * x, o, x}, {o, x, o, x}}, 0.5},
      {"edge without length", edge_edge, {{z, z, -x, x}, {-z, -z, -x, x}}, 0.5},
      {"two points", edge_edge, {{-x, -x, o, o}, {x, x, o, o}}, 0.5},
      {"touch by their ends", edge_edge, {{z, z + x, o, -x}, {-z, x - z, o, -x}}, 0.5},
      {"at rest, apart", edge_edge, {{z, z + x, o, y}, {z, z + x, o, y}}, {}},
      {"at rest, touching", edge_edge, {{o, x, o, y}, {o, x, o, y}}, 0.0},
  };
}

TEST(MovingPair, KnownPairs) {
  for (const Known& known : known_pairs()) {
    EXPECT_EQ(exact_touch(known.pair, known.kind), known.time) << known.what;
    expect_filter_agrees(known.pair, known.kind, known.what);
  }
}

// The plane of the face is z = (1 - 2 t) x, and the vertex has x = 2 t - 1: it is (2 t - 1)^2 over the face, and 1 more
// where its own height is 1. So it touches at 1/2 and parts, or it stays away.
TEST(MovingPair, TouchesAtDoubleRoot) {
  const MovingPair pair{{Vec3{-1, 0.25, 1}, Vec3{-4, -4, -4}, Vec3{4, -4, 4}, Vec3{0, 4, 0}},
                        {Vec3{1, 0.25, 1}, Vec3{-4, -4, 4}, Vec3{4, -4, -4}, Vec3{0, 4, 0}}};
  EXPECT_EQ(exact_touch(pair, PairKind::vertex_face), std::nullopt);
  MovingPair lower = pair;
  lower.from[0].z = lower.to[0].z = 0;
  EXPECT_EQ(exact_touch(lower, PairKind::vertex_face), 0.5);
  EXPECT_EQ(filtered_touch(lower, PairKind::vertex_face).answer, FilterAnswer::undecided);
  EXPECT_EQ(first_touch(lower, PairKind::vertex_face), 0.5);
}

// The same face; a vertex of height 0 with x = 4 t - 1 is in its plane at 1/4, outside, and at 1/2, inside.
TEST(MovingPair, TouchesAtTheMiddleOfTwoRoots) {
  const MovingPair pair{{Vec3{-1, -15.75, 0}, Vec3{-4, -4, -4}, Vec3{4, -4, 4}, Vec3{0, 4, 0}},
                        {Vec3{3, 16.25, 0}, Vec3{-4, -4, 4}, Vec3{4, -4, -4}, Vec3{0, 4, 0}}};
  EXPECT_EQ(exact_touch(pair, PairKind::vertex_face), 0.5);
  expect_filter_agrees(pair, PairKind::vertex_face, "roots at 1/4 and 1/2");
}

// A vertex at rest stays over a face that turns, and is in its plane at three times, the roots of
// 399.875 t^3 - 522.625 t^2 + 186.75 t - 19: 0.1796, 0.3330 and 0.7943.
TEST(MovingPair, TouchesAtTheFirstOfThreeRoots) {
  const MovingPair pair{{Vec3{}, Vec3{6, -6, -1.625}, Vec3{8, 8, 1}, Vec3{-3, -2, -0.375}},
                        {Vec3{}, Vec3{8, 5, 0.0625}, Vec3{-5, 6, -1.5}, Vec3{-6, -8, 1.25}}};
  const auto exact = exact_touch(pair, PairKind::vertex_face);
  ASSERT_TRUE(exact);
  EXPECT_NEAR(*exact, 0.1796269751635949, 1e-11);
  EXPECT_EQ(filtered_touch(pair, PairKind::vertex_face).answer, FilterAnswer::touching);
  expect_filter_agrees(pair, PairKind::vertex_face, "three roots");
}

}  // namespace dartcast::test::moving_pair_test
