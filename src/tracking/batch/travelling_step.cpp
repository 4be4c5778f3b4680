// Steps that leave a part of an environment, and that come to it. The driver decides where a step leaves, and writes down
// all that it needs to go on.
//
// The phases of a walk here: Go to the wall or to the target's simplex. If that is another rank's, and its surroundings
// matter, leave. Otherwise end the walk as tracking/walk.hpp does.
#include "tracking/batch/travelling_step.hpp"

#include "tracking/step_run.hpp"

namespace dartcast {

namespace {

const ContactCallback no_response;

Vec3 place_of(const Stored&, const CarriedWall& wall, unsigned i) { return wall.now[i]; }
Vec3 place_of(const Between& positions, const CarriedWall& wall, unsigned i) {
  if (positions.s == 1.0) return wall.now[i];
  return wall.before[i] + (wall.now[i] - wall.before[i]) * positions.s;
}

// Whether this rank has its cell, and those of the walls that it touches.
bool is_known(const ParticleState& s) {
  const auto touching = std::span(s.touching).first(s.touching_count);
  return s.cell.valid() &&
         std::all_of(touching.begin(), touching.end(), [](const CellFace& f) { return f.cell.valid(); });
}

class TravelDriver : public detail::NoRecords<true> {
 public:
  static constexpr bool travels = true;

  TravelDriver(const CellComplex& complex, const PartCells& cells, Traveller& traveller)
      : complex_(complex), cells_(cells), t_(traveller) {}

  /// Whether no walk or carry may start there.
  [[nodiscard]] bool leaves(const ParticleState& state) {
    left_ = !state.cell.valid() || !cells_.is_own(state.cell);
    return left_;
  }

  /// The step's walk to q, up to its end. `w`: that of a batch, where it has begun it. Returns false where it leaves.
  template <class Positions>
  bool walk(const Space<Positions, 4>& space, StepState& step, const ParticleState& state, const Vec3& q, Walk& w) {
    const Vec3 p = state.position;
    NoVisitor none;
    if (step.stage == StepStage::on_way) {
      w = take_up(space, p, q, step);
    } else {
      if (step.stage == StepStage::walk && leaves(state)) return false;
      note_start(space, state.at(), p, false);
      if (step.stage == StepStage::walk) w = detail::walk_to_wall(space, state.at(), p, q, step.tests, none);
    }
    w = detail::end_walk(space, w, t_.restarted, p, q, step.tests, none, [&](const Walk& walk, const SimplexId* start) {
      if (start != nullptr) note_start(space, *start, p, true);
      left_ = needs_others(walk);
      return left_;
    });
    if (!left_) return true;
    step.stage = StepStage::on_way;
    step.walk = w;
    return false;
  }

  /// The plane of a wall that the particle has met on another rank.
  template <class Positions>
  WallPlane carried_plane(const Space<Positions, 4>& space, std::size_t number) const {
    Corners v{};  // the facet's corners, where facet 0 has them
    for (unsigned i = 0; i < 3; ++i) v[facet_corner<4>(0, i)] = place_of(space.positions, t_.walls[number], i);
    return facet_plane(v, 0);
  }

  /// After a call: all that the step needs elsewhere, where it leaves.
  void pack_up(const SteppedParticle& particle) {
    if (!left_) return;
    StepState& step = t_.step;
    if (is_known(particle.state)) {  // else it is what it was when it came here
      t_.state = whole_state(cells_, particle.state);
      t_.home = cells_.owner(particle.state.cell);
    }
    t_.to = t_.home;
    if (step.stage == StepStage::on_way) {
      t_.to = cells_.owner(step.walk.simplex.cell);
      step.walk.simplex = step.walk.wall_simplex = cells_.whole(step.walk.simplex);
    }
    step.result.invalid_cell = cells_.whole(step.result.invalid_cell);
    const auto walls = std::span(particle.contacts.walls).subspan(step.first_wall);
    for (std::size_t i = t_.walls.size(); i < walls.size(); ++i) t_.walls.push_back(carried(walls[i]));
    step.first_here -= step.first_wall;
    step.first_wall = 0;
  }

 private:
  // Whether cells around the end of a walk matter that this rank may not know.
  [[nodiscard]] bool needs_others(const Walk& walk) const {
    const bool matters = walk.end == WalkEnd::wall || (walk.end == WalkEnd::arrived && walk.zeros != 0);
    return matters && !cells_.is_own(walk.simplex.cell);
  }

  // Where a walk begins that may leave.
  template <class Positions>
  void note_start(const Space<Positions, 4>& space, SimplexId start, const Vec3& p, bool restarted) {
    t_.restarted = restarted;
    t_.ties.count = 0;
    const Corners v = space.corners(start);
    const unsigned zeros = detail::zeros_of(v, p);
    for (unsigned i = 0; i < 4; ++i) {
      if (t_.ties.count < 3 && ((zeros >> i) & 1U) != 0) t_.ties.corner[t_.ties.count++] = v[i];
    }
  }

  // The traveller's walk as this rank's own cells have it: it leaves its simplex by the facet, or meets a wall there.
  template <class Positions>
  Walk take_up(const Space<Positions, 4>& space, const Vec3& p, const Vec3& q, StepState& step) const {
    Walk walk = step.walk;
    walk.simplex = cells_.here(walk.simplex);
    walk.wall_simplex = walk.simplex;
    if (walk.end == WalkEnd::arrived) return walk;
    const CellView cell = space.map->view(walk.simplex.cell);
    const Across across = cell.shape().simplices()[walk.simplex.simplex].across[walk.wall_facet];
    if (across.outer() && cell.is_wall(across.face())) return walk;
    const Passage next = pass(*space.map, walk.simplex, cell, across);
    detail::Ties<Positions, 4> ties(space, p, q, std::span(t_.ties.corner).first(t_.ties.count));
    NoVisitor none;
    return detail::walk_on(space, next.simplex, 15U & ~(1U << next.facet), 3, p, q, ties, step.tests, none);
  }

  [[nodiscard]] CarriedWall carried(const WallHit& hit) const {
    CarriedWall wall{hit, {}, {}};
    wall.hit.face = {};
    const CellView cell = complex_.map().view(hit.face.cell);
    const Across behind = cell.shape().entry(hit.face.face, hit.triangle);
    const auto vertices = complex_.vertices({hit.face.cell, behind.index});
    for (unsigned i = 0; i < 3; ++i) {
      const std::uint32_t v = vertices[facet_corner<4>(behind.place, i)].value;
      wall.before[i] = complex_.previous_positions()[v];
      wall.now[i] = complex_.positions()[v];
    }
    return wall;
  }

  const CellComplex& complex_;
  const PartCells& cells_;
  Traveller& t_;
  bool left_ = false;
};

}  // namespace

TravellingStepper::TravellingStepper(const CellComplex& complex, const PartCells& cells, bool moved,
                                     const StepOptions& options)
    : setting_{complex, moved, options, no_response}, cells_(cells) {}

void TravellingStepper::run(Traveller& t, const SteppedParticle& particle) const {
  const detail::EarlierWalls earlier(particle.contacts);
  const auto first_wall = static_cast<std::uint32_t>(particle.contacts.walls.size());
  for (const CarriedWall& wall : t.walls) particle.contacts.walls.push_back(wall.hit);
  t.step.first_here += first_wall - t.step.first_wall;
  t.step.first_wall = first_wall;
  t.step.result.invalid_cell = cells_.here(t.step.result.invalid_cell);
  TravelDriver driver(setting_.complex, cells_, t);
  detail::StepRun<4, TravelDriver>(setting_, t.step, particle, driver).run();
  driver.pack_up(particle);
}

void TravellingStepper::answer(const ContactList& met, const Contact& contact, const AfterContact& next, Traveller& t,
                               const SteppedParticle& particle) const {
  const detail::EarlierWalls earlier(particle.contacts);
  TravelDriver driver(setting_.complex, cells_, t);
  detail::StepRun<4, TravelDriver>(setting_, t.step, particle, driver).answer(met, contact, next);
  driver.pack_up(particle);
}

}  // namespace dartcast
