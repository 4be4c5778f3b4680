// Reports a walk that does not end, with its replay.
#include "tracking/walk.hpp"

#include <fmt/format.h>

#include <vector>

#include "tracking/cells_around.hpp"

namespace dartcast::detail {

namespace {

[[noreturn]] void throw_with_replay(const CombinatorialMap& map, std::span<const Vec3> places, SimplexId start,
                                    const Vec3& p, const Vec3& q) {
  ParticleState state;
  state.put(start, p);
  throw error_with_replay(
      fmt::format("a walk from ({}, {}, {}) in cell {} to ({}, {}, {}) meets more simplices than there are", p.x, p.y,
                  p.z, map.source(start.cell), q.x, q.y, q.z),
      replay_of(map, {places, places}, state, q, std::array{std::pair{p, q}}));
}

}  // namespace

void throw_overrun(const CombinatorialMap& map, Stored places, SimplexId start, const Vec3& p, const Vec3& q) {
  throw_with_replay(map, {places.at, map.vertex_count()}, start, p, q);
}

void throw_overrun(const CombinatorialMap& map, Between places, SimplexId start, const Vec3& p, const Vec3& q) {
  std::vector<Vec3> at_once;
  for (std::uint32_t v = 0; v < map.vertex_count(); ++v) at_once.push_back(places[Vertex{v}]);
  throw_with_replay(map, at_once, start, p, q);
}

}  // namespace dartcast::detail
