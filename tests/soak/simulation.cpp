// Simulations of a case: what is made alike takes equal steps, with other threads, on ranks, from a checkpoint.
#include "soak/simulation.hpp"

#include <fmt/format.h>

#include <bit>

#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "dartcast/validity.hpp"
#include "soak/plan.hpp"
#include "support/particle_checks.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::soak {

namespace {

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
    if (simulation_->steps() == 1) flown_ = simulation_->unwrapped();
    if (simulation_->steps() == (case_[Knob::steps] + 1) / 2) saved_ = simulation_->checkpoint();
    note(made, seen);
    std::string wrong = check(made);
    if (wrong.empty() && plan_.flies_freely()) wrong = check_flight();
    if (wrong.empty() && step + 1 == case_[Knob::steps]) wrong = compare_with_twins(seen);
    if (wrong.empty() && step + 1 == case_[Knob::steps] && plan_.has_varying_diffusion()) wrong = diffuse(seen);
    return wrong;
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override { simulation_->edit(make); }

 private:
  // All have gone the same way since the first step.
  [[nodiscard]] std::string check_flight() const {
    const std::vector<Vec3> now = simulation_->unwrapped();
    for (std::size_t i = 1; i < now.size() && now.size() == flown_.size(); ++i) {
      const Vec3 way = now[i] - flown_[i];
      if (norm(way - (now[0] - flown_[0])) > 1e-11 * (1.0 + norm(way)))
        return fmt::format("particle {} has flown another way than the first one", i);
    }
    return "";
  }

  // A scene whose D varies: with other threads, on ranks, from a checkpoint.
  [[nodiscard]] std::string diffuse(Seen& seen) const {
    seen.note(Mark::varying_diffusion);
    const Scene scene = plan_.scene();
    const auto last = [&](Simulation& s) {
      while (s.steps() < 6) s.step();
      return state_of(s);
    };
    Simulation one(scene, Threads{1});
    while (one.steps() < 3) one.step();
    const SimulationCheckpoint saved = one.checkpoint();
    const std::string expected = last(one);
    std::string wrong = test::check_states(one.environment(), one.particles());
    Simulation threaded(scene, Threads{3});
    if (wrong.empty() && last(threaded) != expected) wrong = "with other threads a D that varies leads elsewhere";
    Simulation rest(scene, saved);
    if (wrong.empty() && last(rest) != expected) wrong = "from a checkpoint a D that varies leads elsewhere";
    if (wrong.empty() && plan_.has_linear_diffusion() && case_[Knob::motion] == 0) wrong = compare_ways(scene);
    if (!wrong.empty() || case_[Knob::ranks] == 0) return wrong;
    test::on_ranks(case_[Knob::ranks] + 1, [&](Ranks& ranks) {
      Simulation own(scene, Threads{1}, &ranks);
      const std::string shared = last(own);
      if (ranks.rank() == 0 && shared != expected) wrong = "on ranks a D that varies leads elsewhere";
    });
    return wrong;
  }

  // The first step with a linear D, beside those with one number and with none: the random way is in proportion to the
  // root of D, and there is a drift.
  [[nodiscard]] std::string compare_ways(const Scene& varying) const {
    Scene scene = varying;
    scene.motion.diffusivity.clear();
    Simulation none(scene, Threads{1}), all(varying, Threads{1});
    scene.motion.diffusion = 0.02 * norm(mesh_.points.front() - mesh_.points.back());
    Simulation number(scene, Threads{1});
    std::vector<bool> other(none.particles().size());
    const std::vector<Vec3> from = test::positions_of(none.particles());
    for (Simulation* s : {&none, &number, &all}) {
      const SimulationStep& made = s->step();
      for (const Contact& c : made.contacts())
        if (c.particle < other.size()) other[c.particle] = true;
      if (!made.left.empty() || s->ids().size() < other.size()) return "";
    }
    for (std::size_t i = 0; i < other.size(); ++i) {
      if (other[i] || none.ids()[i] != all.ids()[i] || none.ids()[i] != number.ids()[i]) continue;
      const auto end = [&](const Simulation& s) { return s.unwrapped()[i]; };
      const Vec3 way = (end(number) - end(none)) * std::sqrt(plan_.diffusivity(from[i]) / scene.motion.diffusion);
      const Vec3 expected = end(none) + way + plan_.diffusivity_gradient() * scene.motion.dt;
      if (norm(end(all) - expected) > 1e-9 * norm(mesh_.points.front() - mesh_.points.back()))
        return fmt::format("particle {} diffuses {:g} off", i, norm(end(all) - expected));
    }
    return "";
  }

  void note(const SimulationStep& made, Seen& seen) const {
    if (!made.report.contacts.crossings.empty()) seen.note(Mark::passage);
    if (!made.left.empty()) seen.note(Mark::left);
    if (!made.overlaps.empty()) seen.note(Mark::overlap);
    if (simulation_->solids() != nullptr && !simulation_->solids_step().contacts.empty())
      seen.note(Mark::solid_contact);
    if (simulation_->bodies() != nullptr && !simulation_->bodies_step().edges.empty()) seen.note(Mark::edge_of_body);
    for (std::size_t i = 0; i < simulation_->catheter_count(); ++i)
      if (simulation_->catheter_step(i).pushed != 0.0) seen.note(Mark::pushed_catheter);
    if (!simulation_->event_log().changes.empty()) seen.note(Mark::after_edit);
    for (const EventReport& e : simulation_->event_log().events) {
      if (e.refused.empty()) seen.note(Mark::after_edit);
      if (!e.refused.empty()) seen.note(Mark::refused_edit);
    }
    if (simulation_->solids() != nullptr && simulation_->solids_step().walls_made < 1.0) seen.note(Mark::walls_stopped);
    if (simulation_->solids() != nullptr && !simulation_->solids()->stuck().empty()) seen.note(Mark::stuck);
    if (simulation_->bodies() != nullptr && !simulation_->bodies_step().stuck.empty()) seen.note(Mark::stuck);
    if (plan_.has_field()) seen.note(Mark::field);
    if (plan_.has_inlet()) seen.note(Mark::inlet);
    if (simulation_->statistics_options().any()) seen.note(Mark::statistics);
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
      const std::optional<CellTally> tally = simulation_->cell_tally();
      if (tally && !tally->adds_up()) wrong = "sums of cells are not those of particles";
      if (plan_.has_parcels() ? hits < contacts : hits != contacts)
        wrong = fmt::format("{} hits of walls for {} contacts", hits, contacts);
    }
    return wrong;
  }

  // Simulations that are made alike, up to the same step.
  [[nodiscard]] std::string compare_with_twins(Seen& seen) const {
    const std::string hash = state_of(*simulation_);
    if (run_twin(nullptr, 3, nullptr) != hash) return "other threads reach another state";
    if (saved_ && run_twin(nullptr, 1, &*saved_) != hash) return "a checkpoint leads to another state";
    if (plan_.collides() || case_[Knob::ranks] == 0) return "";
    std::string wrong;
    test::on_ranks(case_[Knob::ranks] + 1, [&](Ranks& ranks) {
      const std::string shared = run_twin(&ranks, 1, nullptr);
      if (ranks.rank() == 0 && shared != hash) wrong = "ranks reach another state";
    });
    return wrong.empty() && mesh_.dimension() == 3 ? compare_by_cells(seen) : wrong;
  }

  // The same scene by one process, and by ranks with some of the cells each.
  [[nodiscard]] std::string compare_by_cells(Seen& seen) const {
    if (environment_.complex().steiner_point_count() > 0 || !mesh_.periodic.empty()) return "";  // ranks refuse these
    const unsigned count = case_[Knob::ranks] + 1;
    if (mesh_.cell_count() < count) return "";
    seen.note(Mark::by_cells);
    const Scene scene = plan_.scene();
    const auto run = [&](Simulation& s) {
      while (s.steps() < 6) s.step();
      const SimulationTotals t = s.totals_of_all();
      return fmt::format("{} {} {} {} {}", s.state_hash().hex(), t.injected, t.absorbed, t.escaped,
                         fmt::join(t.contacts_by_patch, " "));
    };
    Simulation whole(scene, Threads{1});
    const std::string expected = run(whole);
    std::string wrong;
    test::on_ranks(count, [&](Ranks& ranks) {
      Simulation own(load_scene_part(scene, ranks).scene, Threads{1}, &ranks, Partition::cells);
      const std::string shared = run(own);
      if (ranks.rank() == 0 && shared != expected)
        wrong = fmt::format("ranks by cells reach {} instead of {}", shared, expected);
    });
    return wrong;
  }
  [[nodiscard]] std::string run_twin(Ranks* ranks, unsigned threads, const SimulationCheckpoint* from) const {
    Environment environment(mesh_, Threads{threads});
    Simulation twin(environment, plan_.options(ranks));
    plan_.fill(twin, from == nullptr);
    if (from != nullptr) twin.restore(*from);
    while (twin.steps() < simulation_->steps()) twin.step();
    return state_of(twin);
  }
  // With the sums of cells and wall faces.
  static std::string state_of(const Simulation& s) {
    std::uint64_t sums = 0;
    const std::optional<CellTally> tally = s.cell_tally();
    if (tally) {
      CellTally carried = *tally;
      carried.set_words(tally->words());
      for (const std::uint64_t word : carried.words()) sums = 31 * sums + word;
    }
    for (const FaceHits& f : s.statistics().hits.faces()) {
      for (const double x : {f.mass, f.energy, static_cast<double>(f.hits)})
        sums = 31 * sums + std::bit_cast<std::uint64_t>(x);
      for (const std::uint64_t n : f.angles) sums = 31 * sums + n;
    }
    return fmt::format("{} {}", s.state_hash().hex(), sums);
  }

  const Case& case_;
  Plan plan_;
  const MeshData& mesh_;
  Environment& environment_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<SimulationCheckpoint> saved_;
  std::vector<Vec3> flown_;  // the unwrapped places after the first step
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Mover> make_simulation_mover(const Case& c, const SceneMesh& scene, Environment& environment) {
  return std::make_unique<SimulationMover>(c, scene, environment);
}

}  // namespace dartcast::soak
