// Four stages of a Runge-Kutta step, each reached by a walk from the particle.
#include "simulation/runge_kutta.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "complex/simplex.hpp"
#include "tracking/carry.hpp"
#include "tracking/periodic_passage.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

namespace {

// N: the number of a simplex's corners.
template <std::size_t N>
class RungeKuttaStages {
 public:
  RungeKuttaStages(const RungeKuttaStep& step, const ParticleState& particle)
      : step_(step),
        particle_(particle),
        weights_(detail::barycentric(corners(particle.at(), 0.0), particle.position)) {}

  [[nodiscard]] Vec3 mean_velocity() const {
    const Vec3& p = particle_.position;
    const double half = 0.5 * step_.dt;
    const Vec3 k1 = velocity_at_particle(0.0, 0);
    const Vec3 k2 = velocity_towards(p + k1 * half, 0.5, 1);
    const Vec3 k3 = velocity_towards(p + k2 * half, 0.5, 1);
    const Vec3 k4 = velocity_towards(p + k3 * step_.dt, 1.0, 2);
    return (k1 + (k2 + k3) * 2.0 + k4) * (1.0 / 6.0);
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

  [[nodiscard]] Vec3 velocity_at(SimplexId at, const Vec3& x, double s, std::size_t moment) const {
    const Corners v = corners(at, s);
    return velocity(at, detail::barycentric(v, x), v, moment);
  }

  // Where the mesh has carried the particle.
  [[nodiscard]] Vec3 velocity_at_particle(double s, std::size_t moment) const {
    return velocity(particle_.at(), weights_, corners(particle_.at(), s), moment);
  }

  // The velocity at x, or at the contact before it.
  [[nodiscard]] Vec3 velocity_towards(const Vec3& x, double s, std::size_t moment) const {
    if (!is_finite(x) || !in_exact_range(x)) return velocity_at_particle(s, moment);
    const auto space = space_between<N>(step_.complex, way(s));
    SimplexPlacement start = {particle_.at(), particle_.position};
    if (step_.moving) {
      if (volume_sign(space.corners(start.simplex)) != Sign::positive) return velocity_at_particle(s, moment);
      start = detail::carried(space, start.simplex, weights_);
    }
    Vec3 end = flushed(x);
    std::vector<const detail::PeriodicPartner*> passed;
    while (end != start.position) {
      TestCounts uncounted;
      Walk w = walk(space, start.simplex, start.position, end, uncounted);
      if (w.end == WalkEnd::wall && passes_periodic(space, w, start, end, passed)) continue;
      if (w.end == WalkEnd::invalid_cell) return velocity_at_particle(s, moment);
      if (w.end == WalkEnd::arrived) return turned_back(passed, velocity_at(w.simplex, end, s, moment));
      return turned_back(passed, velocity_at(w.wall_simplex, contact(space, w, start.position, end), s, moment));
    }
    return turned_back(passed, velocity_at(start.simplex, end, s, moment));
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

}  // namespace

Vec3 runge_kutta_velocity(const RungeKuttaStep& step, const ParticleState& particle) {
  return step.complex.map().dimension() == 2 ? RungeKuttaStages<3>(step, particle).mean_velocity()
                                             : RungeKuttaStages<4>(step, particle).mean_velocity();
}

}  // namespace dartcast
