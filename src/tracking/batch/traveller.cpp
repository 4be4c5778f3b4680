// Travellers as bytes: some plain records one after another. Those that a step does not have are left out: most steps
// travel with no walls, no ties and in one part.
#include "tracking/batch/traveller.hpp"

#include <type_traits>

#include "base/bytes.hpp"

namespace dartcast {

namespace {

constexpr std::uint8_t has_result = 1;
constexpr std::uint8_t has_restarted = 2;
constexpr std::uint8_t is_held = 4;
constexpr std::uint8_t has_parts = 8;

struct PackedState {
  Vec3 position;
  Cell cell;
  std::uint16_t simplex;
  std::uint8_t touching_count;
  TravelStage stage;
  std::array<CellFace, 3> touching;
  std::uint32_t walls;
  std::uint8_t flags;
  std::uint8_t ties;
};

struct PackedStep {
  double last_time;
  TimeInterval interval;
  Vec3 target;
  std::uint32_t home;
  std::uint32_t contact_count;
  std::uint32_t together;
};

struct PackedParts {
  Vec3 step_target;
  std::uint32_t part;
  std::uint32_t parts;
};

struct PackedWalk {
  SimplexId simplex;
  WalkEnd end;
  std::uint8_t zeros;
  std::uint8_t wall_facet;
};

std::uint8_t flags_of(const Traveller& t) {
  const auto flag = [](bool set, std::uint8_t f) { return set ? f : std::uint8_t{0}; };
  return static_cast<std::uint8_t>(flag(t.result.held || t.result.stopped, has_result) |
                                   flag(t.restarted, has_restarted) | flag(t.state.held, is_held) |
                                   flag(t.parts > 1, has_parts));
}

}  // namespace

ParticleState whole_state(const PartCells& cells, ParticleState s) {
  s.cell = cells.whole(s.cell);
  for (unsigned i = 0; i < s.touching_count; ++i) s.touching[i].cell = cells.whole(s.touching[i].cell);
  return s;
}

ParticleState state_here(const PartCells& cells, ParticleState s) {
  s.cell = cells.here(s.cell);
  for (unsigned i = 0; i < s.touching_count; ++i) s.touching[i].cell = cells.here(s.touching[i].cell);
  return s;
}

void pack(const Traveller& t, ByteWriter& out) {
  const std::uint8_t flags = flags_of(t);
  const auto walls = static_cast<std::uint32_t>(t.stage == TravelStage::done ? 0 : t.walls.size());
  out.put(PackedState{t.state.position, t.state.cell, t.state.simplex, t.state.touching_count, t.stage,
                      t.state.touching, walls, flags, t.ties.count});
  if ((flags & is_held) != 0) out.put(t.weights);
  if ((flags & has_result) != 0) out.put(t.result);
  if (t.stage == TravelStage::done) return;
  out.put(PackedStep{t.last_time, t.interval, t.target, t.home, t.contact_count, t.together});
  if ((flags & has_parts) != 0) out.put(PackedParts{t.step_target, t.part, t.parts});
  for (const CarriedWall& w : t.walls) out.put(w);
  if (t.stage != TravelStage::on_way) return;
  out.put(PackedWalk{t.walk.simplex, t.walk.end, t.walk.zeros, t.walk.wall_facet});
  for (unsigned i = 0; i < t.ties.count; ++i) out.put(t.ties.corner[i]);
}

void unpack(ByteReader& in, Traveller& t) {
  const auto s = in.take<PackedState>();
  t.stage = s.stage;
  t.state.put({s.cell, s.simplex}, s.position);
  t.state.touching_count = s.touching_count;
  t.state.touching = s.touching;
  t.state.held = (s.flags & is_held) != 0;
  t.restarted = (s.flags & has_restarted) != 0;
  if (t.state.held) t.weights = in.take<Weights>();
  if ((s.flags & has_result) != 0) t.result = in.take<StepResult>();
  if (t.stage == TravelStage::done) return;
  const auto step = in.take<PackedStep>();
  t.last_time = step.last_time;
  t.interval = step.interval;
  t.target = step.target;
  t.home = step.home;
  t.contact_count = step.contact_count;
  t.together = step.together;
  if ((s.flags & has_parts) != 0) {
    const auto parts = in.take<PackedParts>();
    t.step_target = parts.step_target;
    t.part = parts.part;
    t.parts = parts.parts;
  }
  for (std::uint32_t i = 0; i < s.walls; ++i) t.walls.push_back(in.take<CarriedWall>());
  if (t.stage != TravelStage::on_way) return;
  const auto walk = in.take<PackedWalk>();
  t.walk.simplex = t.walk.wall_simplex = walk.simplex;
  t.walk.end = walk.end;
  t.walk.zeros = walk.zeros;
  t.walk.wall_facet = walk.wall_facet;
  t.ties.count = s.ties;
  for (unsigned i = 0; i < s.ties; ++i) t.ties.corner[i] = in.take<Vec3>();
}

}  // namespace dartcast
