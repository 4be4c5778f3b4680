// Movers with solids, bodies and catheters in them.
#include "soak/movers.hpp"

#include <fmt/format.h>

#include <cmath>

#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"
#include "soak/simulation.hpp"
#include "support/particle_checks.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::soak {

namespace {

class EnvironmentAlone : public Mover {
 public:
  explicit EnvironmentAlone(Environment& environment) : environment_(environment) {}
  std::string move(const std::optional<std::vector<Vec3>>& next, std::uint64_t, Seen&) override {
    if (next) environment_.move(*next);
    return "";
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override { environment_.edit(make); }

 private:
  Environment& environment_;
};

class BodiesMover : public Mover {
 public:
  BodiesMover(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), environment_(environment), bodies_(environment, options(c, scene)) {
    Random random = random_for(c, Use::mover);
    for (int tries = 0; tries < 40 && bodies_.size() < 2; ++tries) {
      const double size = scene.edge * random.uniform(0.1, 0.6);
      const SolidMesh ball = test::moved(test::ball(size), place_in(scene, random));
      BodyOptions body;
      body.radius = 0.2 * size;
      body.velocity = test::random_vector(random, 1.0) * (3.0 * scene.edge);
      body.angular_velocity = test::random_vector(random, 1.0) * 5.0;
      body.stiffness = random.below(2) == 0 ? 0.0 : 1000.0;
      if (random.below(2) == 0) body.surface = ball;
      bodies_.add(ball.points, body);
    }
  }
  [[nodiscard]] bool empty() const { return bodies_.size() == 0; }

  std::string move(const std::optional<std::vector<Vec3>>& next, std::uint64_t, Seen& seen) override {
    if (next && bodies_.move_with(*next) < 1.0) seen.note(Mark::walls_stopped);
    double before = 0.0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) before += bodies_.energy(b).total();
    const BodiesStep& step = bodies_.step();
    if (!step.edges.empty()) seen.note(Mark::edge_of_body);
    if (!step.stuck.empty()) seen.note(Mark::stuck);
    if (!step.gone.empty()) seen.note(Mark::left);
    double after = 0.0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) after += bodies_.energy(b).total();
    if (!next && after > (before + step.input) * (1.0 + energy_slack) + 1e-300)
      return fmt::format("bodies have {} J after {} J and {} J of input", after, before, step.input);
    std::string wrong = check_audit(case_, environment_, bodies_.audit());
    if (!wrong.empty()) return wrong;
    wrong = test::check_states(environment_, bodies_.particles());
    return wrong.empty() ? "" : "a body's " + wrong;
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override {
    environment_.edit(make);
    bodies_.update_after_edit();
  }

 private:
  static BodiesOptions options(const Case& c, const SceneMesh& scene) {
    BodiesOptions o;
    o.dt = 0.02;
    o.gravity = {0.0, 0.0, -9.81 * scene.edge};
    if (c.seed % 2 == 0) o.collisions = BodyCollisionOptions{};
    return o;
  }

  const Case& case_;
  Environment& environment_;
  Bodies bodies_;
};

class CatheterMover : public Mover {
 public:
  CatheterMover(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), spacing_(0.2 * scene.edge), environment_(environment), catheter_(make(c, scene, environment)) {}
  [[nodiscard]] bool empty() const { return catheter_ == nullptr; }

  std::string move(const std::optional<std::vector<Vec3>>& next, std::uint64_t step, Seen& seen) override {
    Random random = random_for(case_, Use::mover, step + 1);
    if (next && catheter_->move_with(*next) < 1.0) seen.note(Mark::walls_stopped);
    CatheterInput input;
    input.push = spacing_ * random.uniform(-0.5, 2.0);
    input.turn = random.uniform(-0.5, 0.5);
    input.load = test::random_vector(random, 1.0) * (0.05 * spacing_);
    const CatheterStep made = catheter_->step(input);
    if (made.pushed != 0.0) seen.note(Mark::pushed_catheter);
    if (made.stuck) seen.note(Mark::stuck);
    std::string wrong = check_audit(case_, environment_, catheter_->audit());
    if (!wrong.empty()) return wrong;
    wrong = test::check_states(environment_, catheter_->particles());
    return wrong.empty() ? "" : "the catheter's " + wrong;
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override {
    environment_.edit(make);
    catheter_->update_after_edit();
  }

 private:
  static std::unique_ptr<Catheter> make(const Case& c, const SceneMesh& scene, Environment& environment) {
    Random random = random_for(c, Use::mover);
    for (int tries = 0; tries < 20; ++tries) {
      CatheterOptions o;
      o.spacing = 0.2 * scene.edge;
      o.length = 12 * o.spacing;
      o.stiffness = 1e-2 * std::pow(scene.edge, 4.0);
      o.tip_length = 3 * o.spacing;
      o.tip_curvature = 0.5 / scene.edge;
      o.edges = c.seed % 4 != 0;
      o.entry = place_in(scene, random);
      o.direction = test::random_vector(random, 1.0);
      try {
        return std::make_unique<Catheter>(environment, o);
      } catch (const InvalidArgument&) {  // no room there
      }
    }
    return nullptr;
  }

  const Case& case_;
  double spacing_;
  Environment& environment_;
  std::unique_ptr<Catheter> catheter_;
};

template <class M>
std::unique_ptr<Mover> unless_empty(const Case& c, const SceneMesh& scene, Environment& environment) {
  auto mover = std::make_unique<M>(c, scene, environment);
  if (mover->empty()) return nullptr;
  return mover;
}

}  // namespace

Vec3 place_in(const SceneMesh& scene, Random& random) {
  return {random.uniform(scene.low.x, scene.high.x), random.uniform(scene.low.y, scene.high.y),
          random.uniform(scene.low.z, scene.high.z)};
}

// Walls of inverted cells may lie over cells that are valid: only a scene without them has one truth in space.
std::string check_audit(const Case& c, const Environment& environment, const SolidAudit& audit) {
  return audit.failed > 0 && !has_bent_sheets(c) && environment.validity(1).valid() ? audit.first : "";
}

std::unique_ptr<Mover> make_mover(const Case& c, const SceneMesh& scene, Environment& environment) {
  std::unique_ptr<Mover> mover;
  const bool space = environment.map().dimension() == 3;
  if (space && c.is(Knob::mover, "solids")) mover = make_solids_mover(c, scene, environment);
  if (space && c.is(Knob::mover, "bodies")) mover = unless_empty<BodiesMover>(c, scene, environment);
  if (space && c.is(Knob::mover, "catheter")) mover = unless_empty<CatheterMover>(c, scene, environment);
  if (c.is(Knob::mover, "simulation")) mover = make_simulation_mover(c, scene, environment);
  if (!mover) mover = std::make_unique<EnvironmentAlone>(environment);
  return mover;
}

}  // namespace dartcast::soak
