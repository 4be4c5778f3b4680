// Elements at free places of a scene, and their first touches by the search against those of all walls.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "support/element_checks.hpp"

namespace dartcast::test {

/// An element that touches no wall at the start, and the cell of its first corner.
struct PlacedElement {
  MovingElement element;
  Cell cell;
};

/// Elements of half a cell to five cells at free places, some of them without extent. `size`: of a cell, about.
inline std::vector<PlacedElement> place_elements(Environment& environment, double size, std::size_t count,
                                                 Random& random) {
  const auto walls = all_walls(environment.complex(), false);
  Vec3 low = environment.positions()[0];
  Vec3 high = low;
  for (const Vec3& p : environment.positions()) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  constexpr std::array<double, 6> sizes = {0.5, 1.0, 2.0, 5.0, 1e-9, 0.0};
  std::vector<PlacedElement> placed;
  while (placed.size() < count) {
    const Vec3 at = {random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)};
    const Location location = environment.locate(at);
    if (location.place != Place::free) continue;
    const auto kind = static_cast<unsigned>(placed.size());
    const MovingElement e = element_at(random, at, 1 + kind % 3, size * sizes[kind / 3 % sizes.size()]);
    if (!meets_at_start(e, walls)) placed.push_back({e, location.simplex.cell});
  }
  return placed;
}

struct ElementOutcome {
  std::array<int, 4> touched{};  // by the number of corners
  int unlike = 0;
};

/// Moves elements, by themselves or while the walls make a wave, and compares their first touches.
inline void compare_elements(Environment& environment, double size, std::size_t count, bool moving, std::uint64_t seed,
                             ElementOutcome& outcome) {
  Random random(seed);
  const auto placed = place_elements(environment, size, count, random);
  if (moving) environment.move(waved(environment.positions(), 0.1 * size, size));
  const CellComplex& complex = environment.complex();
  const auto walls = all_walls(complex, moving);
  const VertexMotion motion = {moving ? complex.previous_positions() : complex.positions(), complex.positions()};
  NearWalls near;
  std::vector<MovingTriangle> found;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    MovingElement e = placed[i].element;
    const Vec3 way = random_vector(random, (i % 4 == 0 ? 1.5 : 0.15) * size);
    for (unsigned c = 0; c < e.count; ++c) e.to[c] += way + random_vector(random, (i % 4 == 1 ? 0.5 : 0.02) * size);
    found.clear();
    for (const NearWall& w : near.search(complex, placed[i].cell, e, motion)) found.push_back(w.corners);
    const auto time = first_touch_of(e, found);
    outcome.unlike += time != first_touch_of(e, walls) ? 1 : 0;
    outcome.touched[e.count] += time ? 1 : 0;
  }
}

}  // namespace dartcast::test
