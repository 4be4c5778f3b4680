// Four stages of a Runge-Kutta step, each reached by a walk from the particle.
//
// For many particles a stage has two phases: the batch walks copies of their states, then the field is evaluated where
// these have arrived, four at a time. A walk that the batch does not take to its end is left to the stage of one particle.
#include "simulation/runge_kutta.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "complex/simplex.hpp"
#include "tracking/batch/batch_plane.hpp"
#include "tracking/carry.hpp"
#include "tracking/periodic_passage.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

namespace {

// A stage is at this share of the step's time, and at this of the field's times.
struct Stage {
  double share;
  std::size_t moment;
};
constexpr Stage at_start = {0.0, 0};
constexpr Stage in_middle = {0.5, 1};
constexpr Stage at_end = {1.0, 2};

// One particle. N: the number of a simplex's corners.
template <std::size_t N>
class RungeKuttaStages {
 public:
  RungeKuttaStages(const RungeKuttaStep& step, const ParticleState& particle)
      : step_(step),
        particle_(particle),
        weights_(detail::barycentric(corners(particle.at(), 0.0), particle.position)) {}

  [[nodiscard]] Vec3 mean_velocity() const {
    const Vec3& p = particle_.position;
    const Vec3 k1 = velocity_at_particle(at_start);
    const Vec3 k2 = velocity_towards(p + k1 * (0.5 * step_.dt), in_middle);
    const Vec3 k3 = velocity_towards(p + k2 * (0.5 * step_.dt), in_middle);
    const Vec3 k4 = velocity_towards(p + k3 * step_.dt, at_end);
    return (k1 + (k2 + k3) * 2.0 + k4) * (1.0 / 6.0);
  }

  // Where the mesh has carried the particle.
  [[nodiscard]] Vec3 velocity_at_particle(const Stage& stage) const {
    return velocity(particle_.at(), weights_, corners(particle_.at(), stage.share), stage.moment);
  }

  // The velocity at x in a simplex.
  [[nodiscard]] Vec3 velocity_at(SimplexId at, const Vec3& x, const Stage& stage) const {
    const Corners v = corners(at, stage.share);
    return velocity(at, detail::barycentric(v, x), v, stage.moment);
  }

  // The velocity at x, or at the contact before it.
  [[nodiscard]] Vec3 velocity_towards(const Vec3& x, const Stage& stage) const {
    if (!is_finite(x) || !in_exact_range(x)) return velocity_at_particle(stage);
    const auto space = space_between<N>(step_.complex, way(stage.share));
    SimplexPlacement start = {particle_.at(), particle_.position};
    if (step_.moving) {
      if (volume_sign(space.corners(start.simplex)) != Sign::positive) return velocity_at_particle(stage);
      start = detail::carried(space, start.simplex, weights_);
    }
    Vec3 end = flushed(x);
    std::vector<const detail::PeriodicPartner*> passed;
    while (end != start.position) {
      TestCounts uncounted;
      Walk w = walk(space, start.simplex, start.position, end, uncounted);
      if (w.end == WalkEnd::wall && passes_periodic(space, w, start, end, passed)) continue;
      if (w.end == WalkEnd::invalid_cell) return velocity_at_particle(stage);
      if (w.end == WalkEnd::arrived) return turned_back(passed, velocity_at(w.simplex, end, stage));
      return turned_back(passed, velocity_at(w.wall_simplex, contact(space, w, start.position, end), stage));
    }
    return turned_back(passed, velocity_at(start.simplex, end, stage));
  }

 private:
  // The share of the vertices' way at the share s of the step.
  [[nodiscard]] double way(double s) const { return step_.moving ? s : 1.0; }

  [[nodiscard]] Corners corners(SimplexId at, double s) const {
    const Corners now = step_.complex.corners(at);
    if (way(s) == 1.0) return now;
    const Corners before = step_.complex.previous_corners(at);
    Corners between;
    for (unsigned i = 0; i < 4; ++i) between[i] = before[i] + (now[i] - before[i]) * s;
    return between;
  }

  // `v`: the simplex's corners at the share s.
  [[nodiscard]] Vec3 velocity(SimplexId at, const Weights& w, const Corners& v, std::size_t moment) const {
    const CellComplex& complex = step_.complex;
    const Vec3 flow = step_.field.at(complex, at, w, v, moment);
    if (!step_.moving || step_.field.frame() == FieldFrame::space) return flow;
    const Vec3 moved = detail::combine(complex.corners(at), w) - detail::combine(complex.previous_corners(at), w);
    return flow + moved * (1.0 / step_.dt);
  }

  // Whether the walk goes on from the partner of a periodic face. No stage passes more faces than a step may.
  template <class Space>
  bool passes_periodic(const Space& space, Walk& w, SimplexPlacement& start, Vec3& end,
                       std::vector<const detail::PeriodicPartner*>& passed) const {
    const detail::PeriodicFaces* const pairs = step_.complex.periodic();
    if (pairs == nullptr || passed.size() >= StepOptions().max_crossings) return false;
    const auto* const partner = detail::periodic_end(space, *pairs, w, start.position, end);
    if (partner == nullptr) return false;
    const auto entry = detail::periodic_entry(space, *pairs, *partner, w, start.position, end);
    if (volume_sign(entry.corners) != Sign::positive) {
      w.end = WalkEnd::invalid_cell;
      return false;
    }
    start = place_in_simplex(space, entry.simplex, entry.corners, entry.on_plane());
    end = entry.target;
    passed.push_back(partner);
    return true;
  }

  // The velocity at an image, as the particle sees it.
  [[nodiscard]] Vec3 turned_back(const std::vector<const detail::PeriodicPartner*>& passed, Vec3 v) const {
    for (auto p = passed.rbegin(); p != passed.rend(); ++p)
      v = step_.complex.periodic()->motion({{}, (*p)->pair, !(*p)->back}).vector(v);
    return v;
  }

  // Rounded: the point where the way from p to q meets the wall.
  template <class Space>
  [[nodiscard]] static Vec3 contact(const Space& space, const Walk& w, const Vec3& p, const Vec3& q) {
    if (w.at_start) return p;
    if (w.at_end) return q;
    const std::array<Vec3, N> v = space.corners(w.wall_simplex);
    const double before = orient_facet_value(v, w.wall_facet, p);
    const double share = before / (before - orient_facet_value(v, w.wall_facet, q));
    return share >= 0.0 && share <= 1.0 ? p + (q - p) * share : q;
  }

  const RungeKuttaStep& step_;
  const ParticleState& particle_;
  Weights weights_;  // of the particle in its simplex before the step
};

// Many particles.
template <std::size_t N>
class RungeKuttaBatch {
 public:
  RungeKuttaBatch(const RungeKuttaStep& step, const detail::FlowParticles& particles)
      : step_(step),
        particles_(particles),
        size_(particles.states.size()),
        targets_(size_, nowhere),
        status_(size_),
        flow_(size_),
        aimed_(size_ / 4) {
    caches_.resize(size_);
  }

  void run() {
    states_.assign(particles_.states.begin(), particles_.states.end());
    vertices_.assign(particles_.vertices.begin(), particles_.vertices.end());
    std::fill(status_.begin(), status_.end(), detail::step_complete);
    find_flow(at_start);
    const std::vector<Vec3> first = flow_;
    find_flow_after(0.5 * step_.dt, in_middle);
    std::vector<Vec3> sum = flow_;
    find_flow_after(0.5 * step_.dt, in_middle);
    for (std::size_t i = 0; i < size_; ++i) sum[i] = first[i] + (sum[i] + flow_[i]) * 2.0;
    find_flow_after(step_.dt, at_end);
    for (std::size_t i = 0; i < size_; ++i) {
      if (follows(i)) particles_.velocities[i] = (sum[i] + flow_[i]) * (1.0 / 6.0);
    }
  }

 private:
  static constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  static constexpr Vec3 nowhere = {no_number, no_number, no_number};  // a target that the batch leaves alone

  [[nodiscard]] bool follows(std::size_t i) const {
    return particles_.statuses[i] == ParticleStatus::alive && !particles_.states[i].held;
  }

  // The flow at the places that the last one leads to in this time.
  void find_flow_after(double time, const Stage& stage) {
    for (std::size_t i = 0; i < size_; ++i) {
      const Vec3 x = particles_.states[i].position + flow_[i] * time;
      targets_[i] = follows(i) && is_finite(x) && in_exact_range(x) ? flushed(x) : nowhere;
    }
    if (knows_starts_) forget_ends();
    states_.assign(particles_.states.begin(), particles_.states.end());
    vertices_.assign(particles_.vertices.begin(), particles_.vertices.end());
    walk_all(stage);
    find_flow(stage);
  }

  [[nodiscard]] const Vec3* positions(const Stage& stage) const {
    if (!step_.moving || stage.share == 1.0) return step_.complex.positions().data();
    return stage.share == 0.0 ? step_.complex.previous_positions().data() : step_.halfway.data();
  }

  // If vertices stand still, the cache of a particle that has stayed in its simplex also serves the next stage.
  void forget_ends() {
    for (std::size_t i = 0; i < size_; ++i) {
      if (status_[i] != detail::step_complete || states_[i].at() != particles_.states[i].at()) caches_.forget(i);
    }
  }

  void walk_all(const Stage& stage) {
    partial_.clear();
    detail::BatchScene scene;
    scene.complex = &step_.complex;
    scene.moved = step_.moving;
    scene.caches_match = knows_starts_;
    scene.walls_match = false;
    scene.options.max_slices = 1;
    scene.positions = positions(stage);
    const detail::BatchSteps steps = {states_, vertices_, caches_.from(0), targets_, status_, partial_};
    Counters uncounted;
    N == 3 ? detail::step_plane(scene, steps, uncounted) : detail::step_batch(scene, steps, uncounted);
    knows_starts_ = !step_.moving;
  }

  void find_flow(const Stage& stage) {
    std::fill(aimed_.begin(), aimed_.end(), std::uint8_t{0});
    if (step_.field.place() == FieldPlace::points)
      detail::find_flow(scene(stage), {states_, vertices_, particles_.statuses, flow_, {}, aimed_});
    for (std::size_t i = 0; i < size_; ++i) {
      const bool walked = status_[i] == detail::step_complete;
      if ((walked && i / 4 < aimed_.size() && (aimed_[i / 4] >> i % 4 & 1U) != 0) || !follows(i)) continue;
      const RungeKuttaStages<N> one(step_, particles_.states[i]);
      flow_[i] = stage.share == 0.0 ? one.velocity_at_particle(stage)
                 : walked           ? one.velocity_at(states_[i].at(), states_[i].position, stage)
                                    : one.velocity_towards(targets_[i], stage);
    }
  }

  [[nodiscard]] detail::FlowScene scene(const Stage& stage) const {
    detail::FlowScene scene;
    scene.now = step_.complex.positions().data();
    scene.before = step_.moving ? step_.complex.previous_positions().data() : scene.now;
    scene.at = positions(stage);
    scene.values = step_.field.values(stage.moment).data();
    scene.rest = step_.field.rest().empty() ? nullptr : step_.field.rest().data();
    scene.planar = N == 3;
    scene.moving = step_.moving;
    scene.per_move = 1.0 / step_.dt;
    return scene;
  }

  const RungeKuttaStep& step_;
  const detail::FlowParticles& particles_;
  std::size_t size_;
  // These are of the last stage.
  std::vector<Vec3> targets_;
  std::vector<ParticleState> states_;
  std::vector<detail::VertexNumbers> vertices_;
  detail::SimplexCache caches_;
  bool knows_starts_ = false;  // the caches are of the particles' simplices, or unknown
  std::vector<detail::StepStatus> status_;
  std::vector<StepState> partial_;
  std::vector<Vec3> flow_;
  std::vector<std::uint8_t> aimed_;
};

}  // namespace

Vec3 runge_kutta_velocity(const RungeKuttaStep& step, const ParticleState& particle) {
  return step.complex.map().dimension() == 2 ? RungeKuttaStages<3>(step, particle).mean_velocity()
                                             : RungeKuttaStages<4>(step, particle).mean_velocity();
}

void runge_kutta_velocities(const RungeKuttaStep& step, const detail::FlowParticles& particles) {
  step.complex.map().dimension() == 2 ? RungeKuttaBatch<3>(step, particles).run()
                                      : RungeKuttaBatch<4>(step, particles).run();
}

}  // namespace dartcast
