// Walls between two free cells, set and removed while particles are near: nobody passes one, and everybody passes where
// there is none. The truth is a list of squares in a lattice of cubes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <string>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/response.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::inner_walls_test {

constexpr int size = 4;  // cubes along an axis

// The square between two cubes of the lattice: it is behind cube `low` along the axis.
struct Square {
  int axis = 0;
  std::array<int, 3> low{};

  auto operator<=>(const Square&) const = default;
};

using Squares = std::set<Square>;

double at(const Vec3& x, int axis) { return axis == 0 ? x.x : axis == 1 ? x.y : x.z; }

// The time at which a way meets a square; 2 if it does not. Coordinates are multiples of 2^-20, so that the products are
// exact.
double meets(const Square& s, const Vec3& p, const Vec3& q) {
  const double plane = s.low[static_cast<std::size_t>(s.axis)] + 1;
  const double way = at(q, s.axis) - at(p, s.axis);
  const double gap = plane - at(p, s.axis);
  if (way == 0.0 || gap / way < 0.0 || gap / way > 1.0) return 2.0;
  for (int other = 0; other < 3; ++other) {
    if (other == s.axis) continue;
    const double place = at(p, other) * way + (at(q, other) - at(p, other)) * gap;  // times way
    const double low = s.low[static_cast<std::size_t>(other)] * way;
    const double high = low + way;
    if (place < std::min(low, high) || place > std::max(low, high)) return 2.0;
  }
  return gap / way;
}

// Chambers of cubes that no square parts.
std::vector<int> chambers(const Squares& walls) {
  const auto number = [](const std::array<int, 3>& c) { return c[0] + size * (c[1] + size * c[2]); };
  std::vector<int> chamber(size * size * size);
  std::iota(chamber.begin(), chamber.end(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < size * size * size; ++c) {
        const std::array<int, 3> low = {c % size, c / size % size, c / (size * size)};
        auto high = low;
        if (++high[static_cast<std::size_t>(axis)] == size || walls.count({axis, low}) != 0) continue;
        int& a = chamber[static_cast<std::size_t>(number(low))];
        int& b = chamber[static_cast<std::size_t>(number(high))];
        if (a == b) continue;
        a = b = std::min(a, b);
        changed = true;
      }
    }
  }
  return chamber;
}

// The faces at some squares, as one of the cells beside each sees it.
std::vector<CellFace> faces_at(const CombinatorialMap& map, const Squares& squares) {
  std::vector<CellFace> faces;
  for (const Cell c : map.cells()) {
    const auto source = static_cast<int>(map.source(c));
    for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
      if (!map.opposite({c, f}).valid()) continue;
      const int beyond = static_cast<int>(map.source(map.opposite({c, f}).cell));
      if (beyond < source) continue;
      const int axis = beyond - source == 1 ? 0 : beyond - source == size ? 1 : 2;
      if (squares.count({axis, {source % size, source / size % size, source / (size * size)}}) != 0)
        faces.push_back({c, f});
    }
  }
  return faces;
}

Square any_square(Random& random) {
  Square s{static_cast<int>(random.below(3)), {}};
  for (int axis = 0; axis < 3; ++axis)
    s.low[static_cast<std::size_t>(axis)] = static_cast<int>(random.below(axis == s.axis ? size - 1 : size));
  return s;
}

Vec3 any_place(Random& random) {
  const auto coordinate = [&] { return (1.0 + random.below(size * 64 - 1)) / 64.0; };
  return {coordinate(), coordinate(), coordinate()};
}

// A target to which no way meets an edge of the lattice: such a way may pass beside a wall's edge.
Vec3 any_target(Random& random) {
  const auto odd = [&] { return (1.0 + 2.0 * random.below(4000)) * 0x1p-20; };
  return any_place(random) - Vec3{odd(), odd(), odd()};
}

bool is_inside_a_cube(const Vec3& x) {
  return x.x != std::floor(x.x) && x.y != std::floor(x.y) && x.z != std::floor(x.z);
}

class Room {
 public:
  explicit Room(std::uint64_t seed) : random_(seed), environment_(test::unit_box({size, size, size})) {
    std::vector<Vec3> places;
    for (int i = 0; i < 100; ++i) places.push_back(any_place(random_) + Vec3{1, 1, 1} * 0x1p-8);
    environment_.add(particles_, places);
  }

  void change_walls() {
    Squares some;
    if (random_.below(3) != 0 || walls_.empty()) {
      for (int i = 0; i < 30; ++i) {
        const Square s = any_square(random_);
        if (walls_.insert(s).second) some.insert(s);
      }
      environment_.edit([&](ComplexEdit& e) { set_walls(e.topology(), faces_at(e.map(), some), {}); });
    } else {
      // Those of two of the lattice's planes.
      environment_.edit([&](ComplexEdit& e) { remove_walls(e.topology(), some_sides(e, some)); });
      for (const Square& s : some) walls_.erase(s);
    }
    for (Particles* p : {&particles_, &fresh_}) {
      if (p->size() == 0) continue;
      const UpdateReport report = environment_.update_after_edit(*p);
      EXPECT_TRUE(report.orphaned.empty());
    }
    EXPECT_EQ(inner_walls(environment_.map()).size(), 2 * walls_.size());
    EXPECT_TRUE(check_integrity(environment_.map()).empty());
  }

  // Particles without an answer stop at the first wall of all.
  void expect_first_walls() {
    fresh_ = Particles();
    std::vector<Vec3> places;
    while (places.size() < 100) {
      const Vec3 x = any_place(random_);
      if (is_inside_a_cube(x)) places.push_back(x);
    }
    environment_.add(fresh_, places);
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < places.size(); ++i) targets.push_back(any_target(random_));
    const StepReport report = environment_.advance(fresh_, targets);
    std::vector<double> time(places.size(), 2.0);
    for (const Contact& c : report.contacts.contacts) time[c.particle] = c.time_of_impact;
    for (std::size_t i = 0; i < places.size(); ++i) {
      double first = 2.0;
      for (const Square& s : walls_) first = std::min(first, meets(s, places[i], targets[i]));
      EXPECT_NEAR(time[i], first, 1e-12) << "particle " << i << " goes from " << places[i].x << ' ' << places[i].y
                                         << ' ' << places[i].z << " to " << targets[i].x << ' ' << targets[i].y << ' '
                                         << targets[i].z;
    }
    test::expect_audited(environment_.complex(), fresh_);
  }

  // Those that rebound stay in their chambers.
  void expect_in_chambers() {
    const std::vector<int> chamber = chambers(walls_);
    const auto chamber_of = [&](std::size_t i) { return chamber[environment_.map().source(particles_[i].cell)]; };
    std::vector<int> before;
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      before.push_back(chamber_of(i));
      targets.push_back(particles_[i].position + (any_place(random_) - Vec3{2, 2, 2}));
    }
    const auto reflect = [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
      return AfterContact{reflected(c.unused, walls, 1.0, 0.0)};
    };
    environment_.advance(particles_, targets, reflect);
    for (std::size_t i = 0; i < particles_.size(); ++i) EXPECT_EQ(chamber_of(i), before[i]) << "particle " << i;
    test::expect_audited(environment_.complex(), particles_);
  }

 private:
  // Both sides of the walls in a plane of the lattice.
  std::vector<CellFace> some_sides(const ComplexEdit& e, Squares& some) {
    const CombinatorialMap& map = e.map();
    const int axis = static_cast<int>(random_.below(3));
    const int layer = static_cast<int>(random_.below(size - 1));
    for (const Square& s : walls_) {
      if (s.axis == axis && s.low[static_cast<std::size_t>(axis)] == layer) some.insert(s);
    }
    std::vector<CellFace> sides;
    const std::vector<CellFace> all = inner_walls(map);
    for (std::size_t i = 0; i < all.size(); i += 2) {
      const int a = static_cast<int>(map.source(all[i].cell));
      const int b = static_cast<int>(map.source(all[i + 1].cell));
      const int low = std::min(a, b);
      const int step = std::max(a, b) - low;
      const Square s{step == 1 ? 0 : step == size ? 1 : 2, {low % size, low / size % size, low / (size * size)}};
      if (some.count(s) != 0) sides.insert(sides.end(), {all[i], all[i + 1]});
    }
    return sides;
  }

  Random random_;
  Environment environment_;
  Squares walls_;
  Particles particles_;
  Particles fresh_;
};

TEST(InnerWalls, StopAndLetPassAsAListOfSquaresSays) {
  for (int seed = 1; seed <= test::scaled(8, 200); ++seed) {
    SCOPED_TRACE(seed);
    Room room(static_cast<std::uint64_t>(seed));
    for (int round = 0; round < 12 && !testing::Test::HasFailure(); ++round) {
      room.change_walls();
      room.expect_first_walls();
      room.expect_in_chambers();
    }
  }
}

TEST(InnerWalls, AreRefusedWhereThereAreNone) {
  Environment environment(test::unit_box({2, 1, 1}));
  const auto said = [&](const std::function<void(Transaction&)>& change) {
    return test::refusal([&] { environment.edit([&](ComplexEdit& e) { change(e.topology()); }); });
  };
  const CombinatorialMap& map = environment.map();
  CellFace inner;
  std::vector<CellFace> outer;
  const Cell first = test::cell_at(environment, {0.5, 0.5, 0.5});
  for (std::uint16_t f = 0; f < 6; ++f) {
    if (map.opposite({first, f}).valid())
      inner = {first, f};
    else
      outer.push_back({first, f});
  }
  test::expect_parts(said([&](Transaction& t) { set_walls(t, outer, {}); }), {"refused", "cell 0", "a wall already"});
  test::expect_parts(said([&](Transaction& t) { remove_walls(t, outer); }), {"refused", "cell 0", "both its sides"});
  test::expect_parts(said([&](Transaction& t) { remove_walls(t, {&inner, 1}); }), {"refused", "another cell"});
  EXPECT_TRUE(inner_walls(map).empty());
}

}  // namespace dartcast::inner_walls_test
