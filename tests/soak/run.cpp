// The steps of a case. Each:
//
//  1. edits, which all follow
//  2. copies, restores, reorders particles
//  3. the vertices move
//  4. every guest takes the step in all its ways
//  5. the ranks take a step of their own on the same mesh
#include "soak/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"
#include "soak/guests.hpp"
#include "soak/movers.hpp"
#include "soak/periodic.hpp"
#include "soak/ranks.hpp"
#include "soak/scene.hpp"
#include "soak/surface.hpp"
#include "support/particle_checks.hpp"

namespace dartcast::soak {

namespace {

// The map and the positions: an edit that is refused, or throws, leaves both as they were, to the last free number.
struct Snapshot {
  explicit Snapshot(const CellComplex& complex)
      : map(complex.map()), positions(complex.positions().begin(), complex.positions().end()) {}
  [[nodiscard]] bool is_of(const CellComplex& complex) const {
    if (map != complex.map()) return false;
    for (std::uint32_t v = 0; v < map.vertex_count(); ++v)
      if (map.is_vertex(Vertex{v}) && test::bits(positions[v]) != test::bits(complex.positions()[v])) return false;
    return true;
  }

  CombinatorialMap map;
  std::vector<Vec3> positions;
};

class Run {
 public:
  Run(const Case& c, Seen& seen)
      : case_(c),
        seen_(seen),
        scene_(make_mesh(c)),
        environment_(std::make_unique<Environment>(scene_.mesh, Threads{1U << c[Knob::threads]})),
        editor_(c, scene_),
        motion_(c, scene_) {
    if (c[Knob::periodic] != 0)
      partners_.emplace(scene_, environment_->map());
    else
      environment_->edit([](ComplexEdit&) {});  // makes what the first edit makes once
    guests_.push_back(make_points(c, scene_, *environment_));
    if (c[Knob::simultaneous] != 0) guests_.push_back(make_simultaneous(c, scene_, *environment_));
    if (c[Knob::spheres] != 0) guests_.push_back(make_spheres(c, scene_, *environment_));
    mover_ = make_mover(c, scene_, *environment_);
    mover_decides_ = mover_->decides([this] { follow(); });
  }

  std::string run() {
    seen_.begin(case_);
    for (std::uint64_t step = 0; step < case_[Knob::steps]; ++step) {
      const std::string wrong = take(step);
      if (!wrong.empty()) return fmt::format("step {}: {}", step, wrong);
    }
    return "";
  }

 private:
  std::string take(std::uint64_t number) {
    std::string wrong = edit(number);
    if (!wrong.empty()) return wrong;
    for (const auto& guest : guests_) {
      wrong = guest->crowd().change_state(*environment_, number);
      if (!wrong.empty()) return guest->name() + ": " + wrong;
    }
    keep_chambers();
    Step step{number, false, environment_->validity(1).valid() && !has_bent_sheets(case_)};
    std::optional<std::vector<Vec3>> next;
    if (!mover_decides_ && !motion_.at_rest()) {
      next = motion_.next(*environment_, number);
      step.moved = true;
      step.valid = step.valid && !environment_->first_inversion(*next);
    }
    if (!step.valid) seen_.note(Mark::invalid_cells);
    note_cells();
    wrong = mover_->move(next, number, seen_);
    if (!wrong.empty()) return case_.name(Knob::mover).data() + (": " + wrong);
    if (mover_decides_) step = {number, environment_->awaits_advance(guests_[0]->crowd().particles), false};
    std::uint64_t particles = 0;
    for (const auto& guest : guests_) {
      particles += guest->crowd().size();
      wrong = guest->step(*environment_, step, seen_);
      if (wrong.empty()) wrong = guest->crowd().check(*environment_, *chambers_);
      if (!wrong.empty()) return guest->name() + ": " + wrong;
    }
    if (case_[Knob::ranks] != 0) {
      wrong = step_on_ranks(case_, scene_, environment_->complex(), number);
      if (!wrong.empty()) return "ranks: " + wrong;
    }
    if (case_[Knob::surface] != 0) {
      wrong = step_on_surface(case_, environment_->complex(), number);
      if (!wrong.empty()) return "surface: " + wrong;
    }
    seen_.end_step(particles);
    return "";
  }

  void keep_chambers() {
    chambers_ = std::make_unique<Chambers>(environment_->map(),
                                           [&](CellFace f) { return partners_ ? partners_->of(f) : CellFace{}; });
    for (const auto& guest : guests_) guest->crowd().keep_chambers(*chambers_);
  }
  void follow() {
    for (const auto& guest : guests_) {
      const std::size_t before = guest->crowd().size();
      guest->crowd().follow(*environment_);
      if (guest->crowd().size() < before) seen_.note(Mark::left);
    }
    keep_chambers();
  }

  std::string edit(std::uint64_t step) {
    if (mover_decides_ || case_.is(Knob::edit, "none") || motion_.is_out()) return "";
    if (case_.is(Knob::edit, "rebuild")) return rebuild();
    const std::uint32_t count = step == 0 ? case_[Knob::edits] : case_[Knob::edits] / 4;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto make = editor_.draw(*environment_, step, i);
      std::string wrong = throw_in_edit(make, step, i);
      if (!wrong.empty()) return wrong;
      const Snapshot before(environment_->complex());
      try {
        mover_->edit(make);
      } catch (const Error&) {  // EditRefused, or InvalidArgument: there is no such face
        seen_.note(Mark::refused_edit);
        if (!before.is_of(environment_->complex()))
          return fmt::format("edit {} is refused, and has changed something", i);
        continue;
      }
      seen_.note(Mark::after_edit);
      editor_.follow(*environment_);
      follow();
      for (const auto& guest : guests_) {
        if (guest->crowd().size() > 400 && i + 1 < count) continue;  // it takes long
        wrong = guest->crowd().check(*environment_, *chambers_);
        if (!wrong.empty()) return fmt::format("after edit {}: {}: {}", i, guest->name(), wrong);
      }
    }
    return "";
  }

  // An edit that throws in its middle changes nothing.
  std::string throw_in_edit(const std::function<void(ComplexEdit&)>& make, std::uint64_t step, std::uint64_t number) {
    if (case_[Knob::throws] == 0 || random_for(case_, Use::throwing, step, number).below(3) != 0) return "";
    const Snapshot before(environment_->complex());
    try {
      environment_->edit([&](ComplexEdit& e) {
        make(e);
        throw Thrown();
      });
    } catch (const Thrown&) {
      seen_.note(Mark::thrown);
    } catch (const Error&) {
    }
    return before.is_of(environment_->complex()) ? "" : "an edit that threw has changed the map";
  }

  // The cells as they are now become the mesh of another environment.
  std::string rebuild() {
    if (!case_.is(Knob::mover, "environment")) return "";
    MeshData mesh = to_mesh(environment_->complex());
    mesh.source.clear();
    if (!environment_->validity(1).valid()) return "";  // no mesh of an environment
    environment_ = std::make_unique<Environment>(std::move(mesh), Threads{1U << case_[Knob::threads]});
    mover_ = make_mover(case_, scene_, *environment_);
    for (const auto& guest : guests_) guest->crowd().add_again(*environment_);
    seen_.note(Mark::after_edit);
    return "";
  }

  void note_cells() {
    const CombinatorialMap& map = environment_->map();
    if (environment_->complex().steiner_point_count() > 0) seen_.note(Mark::steiner_point);
    for (const Cell c : map.cells())
      if (map.dimension() == 3 && map.shape(c).face_count() >= 9) return seen_.note(Mark::large_polyhedron);
  }

  const Case& case_;
  Seen& seen_;
  SceneMesh scene_;
  std::unique_ptr<Environment> environment_;
  std::optional<Partners> partners_;
  Editor editor_;
  Motion motion_;
  std::vector<std::unique_ptr<Guest>> guests_;
  std::unique_ptr<Mover> mover_;
  bool mover_decides_ = false;
  std::unique_ptr<Chambers> chambers_;  // as the particles' were before the step
};

}  // namespace

std::string run_case(const Case& c, Seen& seen) {
  try {
    const Case all = admitted(c);
    return Run(all, seen).run();
  } catch (const std::exception& e) {
    return fmt::format("threw: {}", e.what());
  }
}

namespace {

// The same words name the same fault, whichever particle it is.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return c >= '0' && c <= '9'; });
  return text;
}

}  // namespace

Case shrunk(const Case& c, const Check& check) {
  Case best = c;
  const std::string kind = without_numbers(check(c));
  const auto fails = [&](const Case& candidate) { return without_numbers(check(candidate)) == kind; };
  if (kind.empty()) return best;  // it does not fail again
  for (bool simpler = true; simpler;) {
    simpler = false;
    for (const KnobText& t : knob_texts()) {
      const std::uint32_t now = best[t.knob];
      std::vector<std::uint32_t> values = {0, now / 2, now - now / 4, now - 1};
      if (t.knob == Knob::steps || t.knob == Knob::particles) values[0] = 1;
      for (const std::uint32_t value : values) {
        if (now == 0 || value >= now) continue;
        Case candidate = best;
        candidate[t.knob] = value;
        if (!fails(candidate)) continue;
        best = candidate;
        simpler = true;
        break;
      }
    }
    // Particles are left out at the front, too.
    for (std::uint32_t part = best[Knob::particles] / 2; part > 0; part /= 2) {
      Case candidate = best;
      if (candidate[Knob::particles] <= part || candidate[Knob::first] + part > 20000) continue;
      candidate[Knob::first] += part;
      candidate[Knob::particles] -= part;
      if (!fails(candidate)) continue;
      best = candidate;
      simpler = true;
    }
  }
  return best;
}

}  // namespace dartcast::soak
