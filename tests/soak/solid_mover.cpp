// Solids as those who move the vertices. They may meet each other, and have twins that step with other threads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/solids.hpp"
#include "soak/movers.hpp"
#include "support/dyadic.hpp"
#include "support/particle_checks.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::soak {

namespace {

using test::exact_sign;
using Triangle = std::array<Vec3, 3>;

// Whether the segment passes through the inside of the triangle.
bool pierces(const Vec3& a, const Vec3& b, const Triangle& v) {
  if (exact_sign(v[0], v[1], v[2], a) * exact_sign(v[0], v[1], v[2], b) >= 0) return false;
  const int first = exact_sign(a, b, v[0], v[1]);
  return first != 0 && first == exact_sign(a, b, v[1], v[2]) && first == exact_sign(a, b, v[2], v[0]);
}

bool are_apart(const Triangle& a, const Triangle& b) {
  const auto apart = [&](double Vec3::*x) {
    const auto [low, high] = std::minmax({a[0].*x, a[1].*x, a[2].*x});
    const auto [other_low, other_high] = std::minmax({b[0].*x, b[1].*x, b[2].*x});
    return high < other_low || other_high < low;
  };
  return apart(&Vec3::x) || apart(&Vec3::y) || apart(&Vec3::z);
}

// A set of solids, and what its making needs to be repeated.
class Solids {
 public:
  Solids(const Case& c, const SceneMesh& scene, Environment& environment) : set_(environment) {
    Random random = random_for(c, Use::mover);
    Random of_meetings = random_for(c, Use::mover, 0, 1);
    const bool meet = c[Knob::meets] != 0;
    const bool all = of_meetings.below(2) == 0;
    const std::size_t most = meet ? 6 : 3;
    for (int tries = 0; tries < 40 && set_.size() < most; ++tries) {
      const double size = scene.edge * random.uniform(0.05, 0.7);
      const SolidMesh mesh =
          test::moved(random.below(3) == 0 ? test::rod(3, size) : test::ball(size), place_in(scene, random));
      std::vector<std::uint32_t> met;
      for (std::uint32_t s = 0; meet && s < set_.size(); ++s)
        if (all || of_meetings.below(2) == 0) met.push_back(s);
      if (set_.add(mesh, met).refusal != SolidRefusal::none) continue;
      meshes_.push_back(mesh);
      meets_.push_back(met);
    }
  }

  [[nodiscard]] SolidSet& set() { return set_; }
  [[nodiscard]] bool meet(std::uint32_t solid, std::uint32_t earlier) const {
    return earlier < solid && std::count(meets_[solid].begin(), meets_[solid].end(), earlier) > 0;
  }

  // Two solids that meet, of which a side of one passes through a triangle of the other.
  [[nodiscard]] std::string pierced() const {
    for (std::uint32_t a = 0; a < meshes_.size(); ++a)
      for (std::uint32_t b = 0; b < a; ++b)
        if (meet(a, b) && (passes(a, b) || passes(b, a))) return fmt::format("solids {} and {} cross", a, b);
    return "";
  }

  // The sides of one through the triangles of the other.
  [[nodiscard]] bool passes(std::uint32_t one, std::uint32_t other) const {
    std::vector<std::array<std::uint32_t, 2>> sides = meshes_[one].edges;
    for (const auto& t : meshes_[one].triangles)
      for (unsigned k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3]) sides.push_back({t[k], t[(k + 1) % 3]});
    const auto at = [&](std::uint32_t solid, std::uint32_t v) {
      return set_.positions()[set_.first_vertices()[solid] + v];
    };
    for (const auto& t : meshes_[other].triangles) {
      const Triangle v = {at(other, t[0]), at(other, t[1]), at(other, t[2])};
      for (const auto& side : sides) {
        const Vec3 a = at(one, side[0]), b = at(one, side[1]);
        if (!are_apart({a, b, b}, v) && pierces(a, b, v)) return true;
      }
    }
    return false;
  }

  [[nodiscard]] std::string check(const SolidStep& step) const {
    for (std::size_t i = 0; i < step.meetings.size(); ++i) {
      const SolidMeeting& m = step.meetings[i];
      if (!meet(m.solid, m.other)) return fmt::format("meeting {} is of solids {} and {}", i, m.solid, m.other);
      if (i > 0 && std::pair(step.meetings[i - 1].solid, step.meetings[i - 1].other) >= std::pair(m.solid, m.other))
        return fmt::format("meeting {} is out of order, or there twice", i);
      const auto one = [](const auto& w) { return std::abs(std::accumulate(w.begin(), w.end(), 0.0) - 1.0) < 1e-12; };
      if (!one(m.weights) || !one(m.other_weights)) return fmt::format("meeting {} has weights that are not 1", i);
      if (std::abs(norm(m.normal) - 1.0) > 1e-12) return fmt::format("meeting {} has a normal that is no unit", i);
      if (!(m.time_of_impact >= 0.0 && m.time_of_impact <= 1.0)) return fmt::format("meeting {} is out of the step", i);
      if (norm(place(m.solid, m.vertices, m.weights, m.count) - m.point) > 1e-9 * (1.0 + norm(m.point)) ||
          norm(place(m.other, m.other_vertices, m.other_weights, 4U - m.count) - m.other_point) >
              1e-9 * (1.0 + norm(m.point)))
        return fmt::format("meeting {} has points that are not those of its vertices", i);
      if (std::abs(dot(m.point - m.other_point, m.normal) - m.gap) > 1e-9 * (1.0 + norm(m.point)))
        return fmt::format("meeting {} has another gap", i);
    }
    return "";
  }

 private:
  [[nodiscard]] Vec3 place(std::uint32_t solid, const std::array<std::uint32_t, 3>& vertices,
                           const std::array<double, 3>& weights, unsigned count) const {
    Vec3 x;
    for (unsigned i = 0; i < count; ++i) x += set_.positions()[set_.first_vertices()[solid] + vertices[i]] * weights[i];
    return x;
  }

  SolidSet set_;
  std::vector<SolidMesh> meshes_;
  std::vector<std::vector<std::uint32_t>> meets_;
};

bool same_bits(std::span<const Vec3> a, std::span<const Vec3> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Vec3& x, const Vec3& y) { return test::bits(x) == test::bits(y); });
}

class SolidsMover : public Mover {
 public:
  SolidsMover(const Case& c, const SceneMesh& scene, Environment& environment)
      : case_(c), scene_(scene), environment_(environment), solids_(c, scene, environment) {
    if (c[Knob::meets] == 0) return;
    twins_ = std::make_unique<Environment>(scene.mesh, Threads{3});
    twin_ = std::make_unique<Solids>(c, scene, *twins_);
  }
  [[nodiscard]] bool empty() { return solids_.set().size() == 0; }

  std::string move(const std::optional<std::vector<Vec3>>& next, std::uint64_t step, Seen& seen) override {
    Random random = random_for(case_, Use::mover, step + 1);
    const std::vector<Vec3> to = targets(random);
    const SolidStepOptions options{.rounds = random.below(3) == 0 ? 0U : 6U};
    std::string wrong = throw_first(next, to, options, seen);
    if (!wrong.empty()) return wrong;
    if (case_.is(Knob::state, "restored")) solids_.set().restore(solids_.set().checkpoint());
    const SolidStep& made = take(solids_.set(), next, to, options);
    for (const SolidContact& c : made.contacts)
      if (std::abs(norm(c.normal) - 1.0) > 1e-12) return "a contact has a normal that is no unit";
    if (!made.contacts.empty()) seen.note(Mark::solid_contact);
    if (made.walls_made < 1.0) seen.note(Mark::walls_stopped);
    if (!made.meetings.empty()) seen.note(Mark::meeting);
    if (!solids_.set().stuck().empty()) seen.note(Mark::stuck);
    was_stuck_ = was_stuck_ || !solids_.set().stuck().empty();  // cells may carry it through others
    wrong = solids_.check(made);
    if (wrong.empty() && !was_stuck_) wrong = solids_.pierced();
    if (wrong.empty()) wrong = check_audit(case_, environment_, solids_.set().audit());
    if (!wrong.empty()) return wrong;
    if (twin_) {
      const SolidStep& again = take(twin_->set(), next, to, options);
      if (!same_bits(solids_.set().positions(), twin_->set().positions())) return "other threads have other places";
      if (again.meetings.size() != made.meetings.size() || again.made != made.made)
        return "other threads have another report";
    }
    wrong = test::check_states(environment_, solids_.set().particles());
    return wrong.empty() ? "" : "a vertex: " + wrong;
  }
  void edit(const std::function<void(ComplexEdit&)>& make) override {
    environment_.edit(make);
    solids_.set().update_after_edit();
    twin_.reset();
  }

 private:
  static const SolidStep& take(SolidSet& set, const std::optional<std::vector<Vec3>>& next, std::span<const Vec3> to,
                               const SolidStepOptions& options) {
    return next ? set.move_with(to, *next, options) : set.advance(to, options);
  }

  // All together with some noise; those that meet each by itself, and turned.
  [[nodiscard]] std::vector<Vec3> targets(Random& random) {
    std::vector<Vec3> to(solids_.set().positions().begin(), solids_.set().positions().end());
    const double size = scene_.edge * (random.below(4) == 0 ? 3.0 : 0.3);
    const Vec3 way = test::random_vector(random, 1.0) * size;
    if (case_[Knob::meets] == 0) {
      for (Vec3& x : to) x += way + test::random_vector(random, 1.0) * (0.1 * size);
      return to;
    }
    const Vec3 middle = (scene_.low + scene_.high) * 0.5;
    for (std::size_t s = 0; s < solids_.set().size(); ++s) {
      const std::uint32_t first = solids_.set().first_vertices()[s], end = solids_.set().first_vertices()[s + 1];
      const Vec3 pivot = to[first];
      const bool inwards = random.below(2) == 0;  // so that they meet
      const Vec3 by = inwards ? (middle - pivot) * random.uniform(0.0, 1.5) : test::random_vector(random, 1.0) * size;
      const double angle = random.below(2) == 0 ? 0.0 : random.uniform(-1.5, 1.5);
      for (std::uint32_t v = first; v < end; ++v) {
        const Vec3 d = to[v] - pivot;
        const double cosine = std::cos(angle), sine = std::sin(angle);
        to[v] = pivot + by + Vec3{cosine * d.x - sine * d.y, sine * d.x + cosine * d.y, d.z};
      }
    }
    return to;
  }

  std::string throw_first(const std::optional<std::vector<Vec3>>& next, const std::vector<Vec3>& to,
                          const SolidStepOptions& options, Seen& seen) {
    if (case_[Knob::throws] == 0) return "";
    const std::vector<Vec3> before(solids_.set().positions().begin(), solids_.set().positions().end());
    std::vector<Vec3> bad = to;
    bad.back().x = NAN;
    try {
      take(solids_.set(), next, bad, options);
      return "targets that are no numbers are taken";
    } catch (const InvalidArgument&) {
      seen.note(Mark::thrown);
    }
    return same_bits(before, solids_.set().positions()) ? "" : "a step that threw has moved a solid";
  }

  const Case& case_;
  const SceneMesh& scene_;
  Environment& environment_;
  Solids solids_;
  std::unique_ptr<Environment> twins_;
  std::unique_ptr<Solids> twin_;  // null after an edit
  bool was_stuck_ = false;
};

}  // namespace

std::unique_ptr<Mover> make_solids_mover(const Case& c, const SceneMesh& scene, Environment& environment) {
  auto mover = std::make_unique<SolidsMover>(c, scene, environment);
  if (mover->empty()) return nullptr;
  return mover;
}

}  // namespace dartcast::soak
