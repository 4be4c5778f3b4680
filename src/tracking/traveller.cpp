// Travellers as bytes. Fields that a step does not have are left out: most steps travel with no walls and no ties.
#include "tracking/traveller.hpp"

#include "base/bytes.hpp"

namespace dartcast {

namespace {

constexpr std::uint8_t has_result = 1;
constexpr std::uint8_t has_left_behind = 2;
constexpr std::uint8_t has_restarted = 4;
constexpr std::uint8_t is_held = 8;
constexpr std::uint8_t has_parts = 16;

// Writer and reader go through the same list, below.
class TravellerWriter {
 public:
  explicit TravellerWriter(ByteWriter& out) : out_(out) {}
  template <class T>
  void value(T& v) {
    out_.put(v);
  }

 private:
  ByteWriter& out_;
};

class TravellerReader {
 public:
  explicit TravellerReader(ByteReader& in) : in_(in) {}
  template <class T>
  void value(T& v) {
    v = in_.take<T>();
  }

 private:
  ByteReader& in_;
};

template <class Archive>
void result_fields(Archive& a, StepResult& r) {
  a.value(r.held);
  a.value(r.invalid_cell.value);
  a.value(r.stopped);
  a.value(r.unused);
}

template <class Archive>
void state_fields(Archive& a, ParticleState& s) {
  a.value(s.position);
  a.value(s.cell.value);
  a.value(s.simplex);
  a.value(s.touching_count);
  for (unsigned i = 0; i < s.touching_count; ++i) {
    a.value(s.touching[i].cell.value);
    a.value(s.touching[i].face);
  }
}

template <class Archive>
void wall_fields(Archive& a, CarriedWall& w) {
  a.value(w.hit.triangle);
  a.value(w.hit.patch.value);
  a.value(w.hit.normal);
  for (Vec3& v : w.before) a.value(v);
  for (Vec3& v : w.now) a.value(v);
}

template <class Archive>
void walk_fields(Archive& a, Traveller& t) {
  a.value(t.walk.end);
  a.value(t.walk.simplex.cell.value);
  a.value(t.walk.simplex.simplex);
  a.value(t.walk.zeros);
  a.value(t.walk.wall_facet);
  a.value(t.ties.count);
  for (unsigned i = 0; i < t.ties.count; ++i) a.value(t.ties.corner[i]);
}

template <class Archive>
void step_fields(Archive& a, Traveller& t, std::uint8_t flags) {
  a.value(t.start.cell.value);
  a.value(t.start.simplex);
  a.value(t.tests);
  a.value(t.contact_count);
  if (t.contact_count > 0) {
    a.value(t.together);
    a.value(t.last_time);
  }
  a.value(t.interval);
  a.value(t.target);
  if ((flags & has_parts) != 0) {
    a.value(t.part);
    a.value(t.parts);
    a.value(t.step_target);
  }
  if (t.stage == TravelStage::on_way) walk_fields(a, t);
}

template <class Archive>
void fields(Archive& a, Traveller& t, std::uint8_t flags, std::uint32_t walls) {
  state_fields(a, t.state);
  for (double& w : t.weights) a.value(w);
  if ((flags & has_result) != 0) result_fields(a, t.result);
  if (t.stage == TravelStage::done) return;
  a.value(t.home);
  step_fields(a, t, flags);
  t.walls.resize(walls);
  for (CarriedWall& w : t.walls) wall_fields(a, w);
}

std::uint8_t flags_of(const Traveller& t) {
  const auto flag = [](bool set, std::uint8_t f) { return set ? f : std::uint8_t{0}; };
  return static_cast<std::uint8_t>(flag(t.result.held || t.result.stopped, has_result) |
                                   flag(t.left_behind, has_left_behind) | flag(t.restarted, has_restarted) |
                                   flag(t.state.held, is_held) | flag(t.parts > 1, has_parts));
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

void pack(const Traveller& traveller, ByteWriter& out) {
  Traveller t = traveller;
  const std::uint8_t flags = flags_of(t);
  const auto walls = static_cast<std::uint32_t>(t.walls.size());
  out.put(t.stage);
  out.put(flags);
  out.put(walls);
  TravellerWriter writer(out);
  fields(writer, t, flags, walls);
}

Traveller unpacked_traveller(ByteReader& in) {
  Traveller t;
  t.stage = in.take<TravelStage>();
  const auto flags = in.take<std::uint8_t>();
  const auto walls = in.take<std::uint32_t>();
  TravellerReader reader(in);
  fields(reader, t, flags, walls);
  t.travelled = t.stage != TravelStage::done;
  t.left_behind = (flags & has_left_behind) != 0;
  t.restarted = (flags & has_restarted) != 0;
  t.state.held = (flags & is_held) != 0;
  t.walk.wall_simplex = t.walk.simplex;
  return t;
}

}  // namespace dartcast
