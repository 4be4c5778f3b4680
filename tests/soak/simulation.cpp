// Simulations of a case: particles, spheres, bodies, a catheter, solids, a field, events, remeshing, subdivision and
// statistics, each there or not. All that is made alike takes equal steps: with other threads, on ranks, from a checkpoint.
#include "soak/simulation.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "dartcast/validity.hpp"
#include "support/particle_checks.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::soak {

namespace {

constexpr double dt = 0.05;

// The parts of a case's simulation that are there or not.
class Plan {
 public:
  Plan(const Case& c, const SceneMesh& scene)
      : case_(c), scene_(scene), space_(scene.mesh.dimension() == 3), choice_(random_for(c, Use::mover, 77).next()) {}

  [[nodiscard]] SimulationOptions options(Ranks* ranks) const {
    SimulationOptions o;
    o.dt = dt;
    o.seed = case_.seed;
    o.ranks = ranks;
    o.gravity = Vec3{has(0) ? 3.0 : 0.0, has(1) ? -9.81 : 0.0, 0.0} * scene_.edge;
    o.drag = has(2) ? 2.0 : 0.0;
    o.response = response();
    if (has(3)) o.user_data = {"first", "second"};
    if (collides()) o.collisions = CollisionOptions{.restitution = 0.5, .friction = 0.2};
    if (case_[Knob::simultaneous] != 0 && !collides() && !has_spheres())
      o.wall_motion = WallMotion::simultaneous;
    else if (!collides() && !has(14))
      o.substeps = 1 + static_cast<unsigned>(choice_ >> 60U) % 3;
    return o;
  }
  [[nodiscard]] bool collides() const { return has_spheres() && has(4); }

  // Adds all parts. Those that find no place are left out, alike in all that are made so.
  // `particles`: whether there are any; a checkpoint brings them.
  void fill(Simulation& s, bool particles) const {
    if (case_[Knob::motion] != 0) s.set_deformation({deformation(), s.environment().positions()});
    if (has(5)) s.set_statistics(statistics());
    if (case_[Knob::edit] != 0) s.set_events(events());
    if (space_ && has(6)) s.set_remeshing({.every = 2, .options = {}});
    if (space_ && has(7)) s.set_adaptive_subdivision({.every = 2, .options = {.max_particles = 6, .min_particles = 2}});
    const Vec3 velocity = test::random_vector(*in(1), scene_.edge * 20.0);
    if (particles) s.add_random(has(8) ? 60 : 12, space_ ? velocity : Vec3{velocity.x, velocity.y, 0.0});
    if (particles && has_spheres()) s.add_random(10, {}, 0.15 * scene_.edge);
    if (space_ && has(9)) add_body(s);
    if (space_ && has(10)) add_solid(s);
    if (space_ && has(11)) add_catheter(s);
  }

 private:
  [[nodiscard]] bool has(unsigned bit) const { return ((choice_ >> bit) & 1U) != 0; }
  [[nodiscard]] bool has_spheres() const { return case_[Knob::spheres] != 0; }
  [[nodiscard]] std::unique_ptr<Random> in(std::uint64_t part) const {
    return std::make_unique<Random>(random_for(case_, Use::mover, 78, part));
  }
  [[nodiscard]] Vec3 place(Random& random) const {
    return {random.uniform(scene_.low.x, scene_.high.x), random.uniform(scene_.low.y, scene_.high.y),
            random.uniform(scene_.low.z, scene_.high.z)};
  }
  [[nodiscard]] WallResponse response() const {
    const std::string_view name = case_.name(Knob::response);
    if (name == "slide") return Slide{};
    if (name == "stick") return Stick{};
    if (name == "absorb") return Absorb{};
    if (name == "stop") return Escape{};
    return Reflect{0.7, 0.1};
  }

  [[nodiscard]] std::vector<DeformationStep> deformation() const {
    const auto random = in(2);
    DeformationStep d;
    d.centre = (scene_.low + scene_.high) * 0.5;
    d.period = random->uniform(0.2, 2.0);
    d.length = norm(scene_.high - scene_.low);
    const std::string_view kind = case_.name(Knob::motion);
    d.kind = DeformationKind::swing;
    d.amplitude = random->uniform(0.0, 0.5);
    if (kind == "twist" && space_) d.kind = DeformationKind::twist;
    if (kind == "frames") {
      d.kind = DeformationKind::bump;
      d.axis = {1.0, 0.0, 0.0};
      d.amplitude = random->uniform(0.0, 0.3) * scene_.edge;
    }
    const bool strong = kind == "near inversion" || kind == "inversion and back" || kind == "infinite vertices";
    if (kind == "wave" || strong) {
      d.kind = DeformationKind::pulse;
      d.axis = space_ ? Vec3{0.0, 0.0, 1.0} : Vec3{1.0, 0.0, 0.0};
      d.amplitude = strong ? 0.9 : 0.1;
      d.wavelength = strong ? 1.5 * scene_.edge : 0.5 * d.length;
    }
    return {d};
  }

  [[nodiscard]] StatisticsOptions statistics() const {
    StatisticsOptions o;
    o.hits = true;
    o.residence = true;
    o.planes = {{"middle", (scene_.low + scene_.high) * 0.5, {1.0, 0.5, 0.0}, 0.0}};
    o.pathlines_every = 3;
    return o;
  }

  [[nodiscard]] std::vector<Event> events() const {
    const auto random = in(3);
    std::vector<Event> events;
    for (std::uint32_t i = 0; i < 1 + case_[Knob::edits] / 4; ++i) {
      Event e;
      e.at = dt * random->below(5);
      e.orphaned = std::array{OrphanPolicy::hold, OrphanPolicy::relocate, OrphanPolicy::absorb}[random->below(3)];
      const Vec3 at = place(*random);
      const Vec3 normal = test::random_vector(*random, 1.0);
      std::vector<std::uint32_t> cells;
      for (int k = 0; k < 4; ++k) cells.push_back(random->below(static_cast<std::uint32_t>(scene_.mesh.cell_count())));
      switch (random->below(space_ ? 5 : 1)) {
        case 0: e.what = Ligature{plane_through(at, space_ ? normal : Vec3{normal.x, normal.y, 0.0}), at}; break;
        case 1: e.what = OpenCells{cells}; break;
        case 2: e.what = CloseCells{cells}; break;
        case 3: e.what = Cut{Disc{at, normal, scene_.edge, 6}, 0.2 * scene_.edge}; break;
        default:
          e.what = Carve{capsule_tool(at, at + normal * scene_.edge, 0.3 * scene_.edge), Carving::open, false};
          break;
      }
      events.push_back(e);
    }
    return events;
  }

  void add_body(Simulation& s) const {
    const auto random = in(4);
    for (int tries = 0; tries < 20; ++tries) {
      const double size = scene_.edge * random->uniform(0.1, 0.5);
      const SolidMesh ball = test::moved(test::ball(size), place(*random));
      BodyOptions body;
      body.radius = 0.2 * size;
      body.velocity = test::random_vector(*random, 5.0 * scene_.edge);
      if (random->below(2) == 0) body.surface = ball;
      try {
        if (s.add_body(ball.points, body).body != 0xffffffffU) return;
      } catch (const InvalidArgument&) {  // as with substeps
        return;
      }
    }
  }
  void add_solid(Simulation& s) const {
    const auto random = in(5);
    for (int tries = 0; tries < 20; ++tries) {
      SolidScene solid;
      solid.name = "tool";
      const double size = scene_.edge * random->uniform(0.05, 0.4);
      solid.shape = std::vector<Vec3>{{}, {size, 0.0, 0.0}, {size, size, 0.0}};
      solid.at = place(*random);
      solid.pivot = solid.at;
      solid.moves = {{10.0, test::random_vector(*random, 3.0 * scene_.edge), test::random_vector(*random, 3.0)}};
      solid.catch_up = random->below(2) == 0;
      try {
        return s.add(solid);
      } catch (const Error&) {  // no place there
      }
    }
  }
  void add_catheter(Simulation& s) const {
    const auto random = in(6);
    for (int tries = 0; tries < 20; ++tries) {
      CatheterScene catheter;
      catheter.name = "catheter";
      catheter.options.spacing = 0.2 * scene_.edge;
      catheter.options.length = 2.0 * scene_.edge;
      catheter.options.stiffness = 1e-2 * std::pow(scene_.edge, 4.0);
      catheter.options.entry = place(*random);
      catheter.options.direction = test::random_vector(*random, 1.0);
      catheter.options.edges = random->below(4) != 0;
      catheter.moves = {{10.0, 4.0 * scene_.edge, 1.0}};
      try {
        return s.add(catheter);
      } catch (const Error&) {  // no room there
      }
    }
  }

  const Case& case_;
  const SceneMesh& scene_;
  bool space_;
  std::uint64_t choice_;
};

class SimulationMover : public Mover {
 public:
  SimulationMover(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), plan_(c, scene), mesh_(scene.mesh), environment_(environment) {
    simulation_ = std::make_unique<Simulation>(environment, plan_.options(nullptr));
    plan_.fill(*simulation_, true);
  }

  bool decides(const std::function<void()>& follow) override {
    simulation_->set_after_edit([follow](const Environment&) { follow(); });
    return true;
  }

  std::string move(const std::optional<std::vector<Vec3>>&, std::uint64_t step, Seen& seen) override {
    if (ended_) return "";
    const SimulationStep* done = nullptr;
    try {
      done = &simulation_->step();
    } catch (const Error& e) {  // where other events have closed all cells
      ended_ = std::string_view(e.what()).find("the ligature crosses no free cell") != std::string_view::npos;
      if (ended_) return "";
      throw;
    }
    const SimulationStep& made = *done;
    if (simulation_->steps() == (case_[Knob::steps] + 1) / 2) saved_ = simulation_->checkpoint();
    note(made, seen);
    std::string wrong = check(made);
    if (wrong.empty() && step + 1 == case_[Knob::steps]) wrong = compare_with_twins();
    return wrong;
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override { simulation_->edit(make); }

 private:
  void note(const SimulationStep& made, Seen& seen) const {
    if (!made.left.empty()) seen.note(Mark::left);
    if (!made.overlaps.empty()) seen.note(Mark::overlap);
    if (simulation_->solids() != nullptr && !simulation_->solids_step().contacts.empty())
      seen.note(Mark::solid_contact);
    if (simulation_->bodies() != nullptr && !simulation_->bodies_step().edges.empty()) seen.note(Mark::edge_of_body);
    for (std::size_t i = 0; i < simulation_->catheter_count(); ++i)
      if (simulation_->catheter_step(i).pushed != 0.0) seen.note(Mark::pushed_catheter);
    if (!simulation_->event_log().changes.empty()) seen.note(Mark::after_edit);
  }

  [[nodiscard]] std::string check(const SimulationStep& made) const {
    std::string wrong = test::check_states(environment_, simulation_->particles());
    // Walls of inverted cells may lie over cells that are valid.
    if (wrong.empty() && environment_.validity(1).valid()) wrong = simulation_->audit().first;
    for (const Contact& c : made.contacts())
      if (wrong.empty() && !(is_finite(c.point) && is_finite(c.unused))) wrong = "a contact that is not finite";
    for (const Vec3& v : simulation_->velocities())
      if (wrong.empty() && !is_finite(v)) wrong = "a velocity that is not finite";
    const SimulationTotals& t = simulation_->totals();
    if (wrong.empty() && simulation_->particles().size() != t.start + t.injected - t.absorbed - t.escaped)
      wrong = "particles are not as counted";
    if (wrong.empty() && simulation_->statistics_options().hits) {
      std::uint64_t hits = 0;
      for (const std::uint64_t n : simulation_->statistics().hits.by_patch(environment_)) hits += n;
      std::uint64_t contacts = 0;
      for (const std::uint64_t n : t.contacts_by_patch) contacts += n;
      if (hits != contacts) wrong = fmt::format("{} hits of walls for {} contacts", hits, contacts);
    }
    return wrong;
  }

  // Simulations that are made alike, up to the same step.
  [[nodiscard]] std::string compare_with_twins() const {
    const std::string hash = simulation_->state_hash().hex();
    if (run_twin(nullptr, 3, nullptr) != hash) return "other threads reach another state";
    if (saved_ && run_twin(nullptr, 1, &*saved_) != hash) return "a checkpoint leads to another state";
    if (plan_.collides() || case_[Knob::ranks] == 0) return "";
    std::string wrong;
    test::on_ranks(case_[Knob::ranks] + 1, [&](Ranks& ranks) {
      const std::string shared = run_twin(&ranks, 1, nullptr);
      if (ranks.rank() == 0 && shared != hash) wrong = "ranks reach another state";
    });
    return wrong;
  }
  [[nodiscard]] std::string run_twin(Ranks* ranks, unsigned threads, const SimulationCheckpoint* from) const {
    Environment environment(mesh_, Threads{threads});
    Simulation twin(environment, plan_.options(ranks));
    plan_.fill(twin, from == nullptr);
    if (from != nullptr) twin.restore(*from);
    while (twin.steps() < simulation_->steps()) twin.step();
    return twin.state_hash().hex();
  }

  const Case& case_;
  Plan plan_;
  const MeshData& mesh_;
  Environment& environment_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<SimulationCheckpoint> saved_;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Mover> make_simulation_mover(const Case& c, const SceneMesh& scene, Environment& environment) {
  return std::make_unique<SimulationMover>(c, scene, environment);
}

}  // namespace dartcast::soak
