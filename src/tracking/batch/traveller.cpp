// Travellers as bytes: some plain records one after another. Those that a step does not have are left out: most steps
// travel with no walls, no ties and in one slice.
#include "tracking/batch/traveller.hpp"

#include <type_traits>

#include "base/bytes.hpp"

namespace dartcast {

namespace {

constexpr std::uint8_t has_result = 1;
constexpr std::uint8_t has_restarted = 2;
constexpr std::uint8_t is_held = 4;
constexpr std::uint8_t has_slices = 8;

struct PackedState {
  Vec3 position;
  Cell cell;
  std::uint16_t simplex;
  std::uint8_t touching_count;
  StepStage stage;
  std::array<CellFace, 3> touching;
  std::uint32_t walls;
  std::uint8_t flags;
  std::uint8_t ties;
};

struct PackedStep {
  double last_time;
  TimeInterval interval;
  Vec3 slice_target;
  std::uint32_t home;
  std::uint32_t contact_count;
  std::uint32_t first_here;
};

struct PackedSlices {
  Vec3 target;
  std::uint32_t slice;
  std::uint32_t slices;
};

struct PackedWalk {
  SimplexId simplex;
  WalkEnd end;
  std::uint8_t zeros;
  std::uint8_t wall_facet;
};

std::uint8_t flags_of(const Traveller& t) {
  const auto flag = [](bool set, std::uint8_t f) { return set ? f : std::uint8_t{0}; };
  return static_cast<std::uint8_t>(flag(!t.step.moves_itself(), has_result) | flag(t.restarted, has_restarted) |
                                   flag(t.state.held, is_held) | flag(t.step.slices > 1, has_slices));
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
  const StepState& step = t.step;
  const std::uint8_t flags = flags_of(t);
  const auto walls = static_cast<std::uint32_t>(step.stage == StepStage::done ? 0 : t.walls.size());
  out.put(PackedState{t.state.position, t.state.cell, t.state.simplex, t.state.touching_count, step.stage,
                      t.state.touching, walls, flags, t.ties.count});
  if ((flags & is_held) != 0) out.put(t.weights);
  if ((flags & has_result) != 0) out.put(step.result);
  if (step.stage == StepStage::done) return;
  out.put(PackedStep{step.last_time, step.interval, step.slice_target, t.home, step.contact_count, step.first_here});
  if ((flags & has_slices) != 0) out.put(PackedSlices{step.target, step.slice, step.slices});
  for (const CarriedWall& w : t.walls) out.put(w);
  if (step.stage != StepStage::on_way) return;
  out.put(PackedWalk{step.walk.simplex, step.walk.end, step.walk.zeros, step.walk.wall_facet});
  for (unsigned i = 0; i < t.ties.count; ++i) out.put(t.ties.corner[i]);
}

void unpack(ByteReader& in, Traveller& t) {
  StepState& step = t.step;
  const auto s = in.take<PackedState>();
  step.stage = s.stage;
  t.state.put({s.cell, s.simplex}, s.position);
  t.state.touching_count = s.touching_count;
  t.state.touching = s.touching;
  t.state.held = (s.flags & is_held) != 0;
  t.restarted = (s.flags & has_restarted) != 0;
  if (t.state.held) t.weights = in.take<Weights>();
  if ((s.flags & has_result) != 0) step.result = in.take<StepResult>();
  if (step.stage == StepStage::done) return;
  const auto packed = in.take<PackedStep>();
  step.last_time = packed.last_time;
  step.interval = packed.interval;
  step.slice_target = packed.slice_target;
  t.home = packed.home;
  step.contact_count = packed.contact_count;
  step.first_here = packed.first_here;
  if ((s.flags & has_slices) != 0) {
    const auto slices = in.take<PackedSlices>();
    step.target = slices.target;
    step.slice = slices.slice;
    step.slices = slices.slices;
  }
  for (std::uint32_t i = 0; i < s.walls; ++i) t.walls.push_back(in.take<CarriedWall>());
  if (step.stage != StepStage::on_way) return;
  const auto walk = in.take<PackedWalk>();
  step.walk.simplex = step.walk.wall_simplex = walk.simplex;
  step.walk.end = walk.end;
  step.walk.zeros = walk.zeros;
  step.walk.wall_facet = walk.wall_facet;
  t.ties.count = s.ties;
  for (unsigned i = 0; i < s.ties; ++i) t.ties.corner[i] = in.take<Vec3>();
}

}  // namespace dartcast
