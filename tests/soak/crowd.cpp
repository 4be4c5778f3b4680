// Places particles, draws their ways, answers their contacts, checks them.
#include "soak/crowd.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "dartcast/predicates.hpp"
#include "soak/periodic.hpp"
#include "support/particle_checks.hpp"

namespace dartcast::soak {

namespace {

WallResponse response_of(const Case& c) {
  const std::string_view name = c.name(Knob::response);
  if (name == "slide") return Slide{};
  if (name == "stick") return Stick{};
  if (name == "absorb") return Absorb{};
  return Reflect{c.seed % 3 == 0 ? 1.0 : 0.6, c.seed % 2 == 0 ? 0.0 : 0.2};
}

// A multiple of 2^-30, of 1/4, or of 1 nearby.
Vec3 on_lattice(const Vec3& x, Random& random) {
  const double unit = std::array{0x1p-30, 0.25, 1.0}[random.below(3)];
  return {std::floor(x.x / unit) * unit, std::floor(x.y / unit) * unit, std::floor(x.z / unit) * unit};
}

// Where a point is in another copy of a mesh with pairs.
Vec3 image_of(const SceneMesh& scene, Vec3 x, Random& random) {
  for (const Placing& pair : scene.pairs)
    for (std::uint32_t i = random.below(4); i > 0; --i) x = (random.below(4) == 0 ? pair.inverse() : pair).point(x);
  return x;
}

}  // namespace

Answers::Answers(const Case& c, std::uint64_t step, std::span<const std::uint64_t> ids, std::span<const Vec3> before,
                 std::span<const ParticleStatus> fates_before)
    : velocities(before.begin(), before.end()),
      statuses(fates_before.begin(), fates_before.end()),
      case_(c),
      step_(step),
      ids_(ids.begin(), ids.end()),
      counts_(ids.size()),
      responses_(response_of(c)) {
  const std::string_view name = c.name(Knob::response);
  if (name != "stop" && name != "any answer" && name != "into the wall")
    library_ = respond_with(responses_, velocities, statuses, 1.0);
}

ContactCallback Answers::one_by_one() {
  if (case_.is(Knob::response, "stop")) return {};
  if (library_) return library_;
  return [this](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
    return answer(c, walls, earlier);
  };
}

RoundCallback Answers::in_rounds() {
  if (case_.is(Knob::response, "stop")) return {};
  return [respond = one_by_one()](const ContactList& list, std::span<AfterContact> after) {
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Contact& c = list.contacts[i];
      after[i] = respond(c, list.walls_of(c), list.earlier_walls_of(c));
    }
  };
}

AfterContact Answers::answer(const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
  const unsigned count = ++counts_[c.particle];
  if (case_.is(Knob::response, "into the wall")) return {c.unused};
  switch (random_for(case_, Use::answer, step_, ids_[c.particle]).below(7)) {
    case 0: return {slid(c.unused, walls, earlier), true};
    case 1: return {};
    case 2: return {c.unused * 0.5};
    case 3: return count < 3 ? AfterContact{reflected(c.unused, walls, 1.0, 0.0), true} : AfterContact{};
    case 4: return {reflected(c.unused, earlier, 0.9, 0.1)};
    case 5: return {c.unused * (count < 3 ? -30.0 : -1.0)};  // not ever longer
    default: break;
  }
  std::vector<WallHit> together(earlier.end() - c.together, earlier.end());
  together.insert(together.end(), walls.begin(), walls.end());
  return {reflected(c.unused, c.last ? walls : together, 1.0, 0.05), true};
}

Crowd::Crowd(const Case& c, const SceneMesh& scene, Environment& environment, std::uint64_t kind)
    : case_(c), scene_(scene), kind_(kind) {
  std::vector<Vec3> places;
  std::vector<std::uint64_t> numbers;
  const auto positions = environment.positions();
  const std::uint64_t most = kind == spheres ? 60 : kind == simultaneous ? 400 : 20000;  // as long as they take
  const std::uint64_t count = std::min<std::uint64_t>(c[Knob::particles], most);
  for (std::uint64_t id = c[Knob::first]; id < c[Knob::first] + count; ++id) {
    Random random = random_for(c, Use::place, kind, id);
    const bool at_vertex = c.is(Knob::places, "at vertices") || (c.is(Knob::places, "mixed") && id % 2 == 0);
    Vec3 x = {random.uniform(scene.low.x, scene.high.x), random.uniform(scene.low.y, scene.high.y),
              random.uniform(scene.low.z, scene.high.z)};
    if (c[Knob::periodic] != 0 && random.below(3) == 0)
      x = place_on_border(scene, random);
    else if (c[Knob::periodic] != 0 && random.below(2) == 0)
      x = on_lattice(x, random);
    else if (at_vertex)
      x = positions[random.below(static_cast<std::uint32_t>(positions.size()))];
    if (!is_finite(x)) continue;
    places.push_back(x);
    numbers.push_back(id);
  }
  const std::vector<AddResult> added = environment.add(particles, places);
  for (std::size_t i = 0; i < added.size(); ++i)
    if (added[i].location.place == Place::free) ids.push_back(numbers[i]);
  velocities.resize(ids.size());
  statuses.resize(ids.size());
}

void Crowd::head_for(std::span<const Vec3> targets) {
  for (std::size_t i = 0; i < targets.size(); ++i) velocities[i] = targets[i] - particles[i].position;
}

std::unique_ptr<Answers> Crowd::answers(std::uint64_t step, std::size_t first, std::size_t count) const {
  const auto some = [&](const auto& column) { return std::span(column).subspan(first, count); };
  return std::make_unique<Answers>(case_, step, some(ids), some(velocities), some(statuses));
}

void Crowd::answered(const Answers& answers) {
  velocities = answers.velocities;
  statuses = answers.statuses;
}

std::vector<Vec3> Crowd::targets(const Environment& environment, std::uint64_t step) const {
  std::vector<Vec3> targets;
  const bool plane = scene_.low.z == scene_.high.z;
  for (std::size_t i = 0; i < size(); ++i) {
    Random random = random_for(case_, Use::target, step * 8 + kind_, ids[i]);
    const Vec3& from = particles[i].position;
    std::string_view kind = case_.name(Knob::targets);
    if (kind == "mixed") kind = knob_texts()[static_cast<std::size_t>(Knob::targets)].values[random.below(3)];
    std::string_view length = case_.name(Knob::length);
    if (length == "mixed") length = knob_texts()[static_cast<std::size_t>(Knob::length)].values[random.below(3)];
    Vec3 way = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (kind == "lattice") way = {std::round(way.x), std::round(way.y), std::round(way.z)};
    const double far = length == "a cell"        ? std::pow(10.0, random.uniform(-2.0, 0.3))
                       : length == "10^-6 cells" ? std::pow(10.0, random.uniform(-6.0, -3.0))
                                                 : std::pow(10.0, random.uniform(0.3, 2.5));
    const bool periodic = case_[Knob::periodic] != 0;
    const double scale = periodic && random.below(2) == 0 ? std::ldexp(1.0, int(std::log2(far))) : far;
    Vec3 to = from + way * (scale * scene_.edge);
    if (kind == "vertices") {  // through a vertex, or to it
      const auto positions = environment.positions();
      Vec3 v = positions[random.below(static_cast<std::uint32_t>(positions.size()))];
      if (periodic) v = image_of(scene_, v, random);
      to = random.below(2) == 0 ? v : from + (v - from) * scale;
    }
    if (plane) to.z = 0.0;
    const bool stays = statuses[i] != ParticleStatus::alive;
    targets.push_back(stays || !in_exact_range(to) ? from : to);
  }
  return targets;
}

void Crowd::follow(const Environment& environment) {
  constexpr std::array policies = {OrphanPolicy::hold, OrphanPolicy::relocate, OrphanPolicy::absorb};
  const OrphanPolicy policy = policies[case_.seed % 3];
  const UpdateReport report = environment.update_after_edit(particles, policy);
  std::vector<bool> stays(ids.size(), true);
  for (const OrphanedParticle& o : report.orphaned) stays[o.particle] = o.outcome != OrphanPolicy::absorb;
  keep(stays);
}

void Crowd::keep(const std::vector<bool>& stays) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < stays.size(); ++i) {
    if (!stays[i]) continue;
    ids[kept] = ids[i];
    velocities[kept] = velocities[i];
    statuses[kept++] = statuses[i];
  }
  ids.resize(kept);
  velocities.resize(kept);
  statuses.resize(kept);
}

std::string Crowd::change_state(const Environment& environment, std::uint64_t step) {
  const std::string_view kind = case_.name(Knob::state);
  if (environment.awaits_advance(particles)) return "";
  if (kind == "copied") particles = Particles(particles);
  if (kind == "restored") {
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < size(); ++i)
      weights.push_back(particles[i].held ? particles.held_weights(i) : Weights{});
    Particles again = environment.restored(particles.states(), weights);
    if (!test::same_bits(test::copy_of(particles), again)) return "restored particles have other bits";
    particles = std::move(again);
  }
  if (kind == "removed and reordered" && size() > 2) {
    Random random = random_for(case_, Use::state, step, kind_);
    std::vector<std::uint32_t> order(size());
    std::iota(order.begin(), order.end(), 0U);
    for (std::size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
    particles.reorder(order);
    const auto reordered = [&](auto& column) {
      auto old = column;
      for (std::size_t i = 0; i < order.size(); ++i) column[i] = old[order[i]];
    };
    reordered(ids);
    reordered(velocities);
    reordered(statuses);
    if (random.below(4) == 0) {
      std::vector<std::uint8_t> marks(size());
      marks.back() = 1;
      particles.remove(marks);
      ids.pop_back();
      velocities.pop_back();
      statuses.pop_back();
    }
  }
  return particles.size() == ids.size() ? "" : "a particle is lost";
}

void Crowd::keep_chambers(const Chambers& chambers) {
  chambers_.clear();
  for (const ParticleState& s : particles.states()) chambers_.push_back(chambers.of(s.cell));
}

std::string Crowd::check(const Environment& environment, const Chambers& chambers) const {
  if (particles.size() != ids.size()) return "a particle is lost";
  std::string wrong = test::check_states(environment, particles);
  for (std::size_t i = 0; i < size() && wrong.empty(); ++i) {
    const ParticleState& s = particles[i];
    if (!is_finite(s.position)) wrong = fmt::format("particle {} is nowhere", i);
    if (chambers_.size() == size() && chambers.of(s.cell) != chambers_[i])
      wrong = fmt::format("particle {} passed a wall", i);
    if (environment.map().dimension() == 2 && s.position.z != 0.0) wrong = fmt::format("particle {} left the plane", i);
  }
  return wrong;
}

void Crowd::add_again(Environment& environment) {
  const std::vector<Vec3> places = test::positions_of(particles);
  particles = {};
  std::vector<bool> stays;
  for (const AddResult& a : environment.add(particles, places)) stays.push_back(a.location.place == Place::free);
  keep(stays);
}

std::string check_report(const StepReport& report, std::size_t particles) {
  const auto& contacts = report.contacts.contacts;
  std::array<std::uint64_t, 3> kinds{};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (c.particle >= particles || c.kind == Kind::volume || c.wall_count == 0)
      return fmt::format("contact {} names no particle, no place or no wall", i);
    if (!(c.time_of_impact >= 0.0 && c.time_of_impact <= 1.0)) return fmt::format("contact {} is out of the step", i);
    if (!is_finite(c.point) || !is_finite(c.displacement) || !is_finite(c.unused) || !is_finite(c.wall_displacement))
      return fmt::format("contact {} has a vector that is not finite", i);
    if (i > 0 && (c.particle < contacts[i - 1].particle ||
                  (c.particle == contacts[i - 1].particle && c.time_of_impact < contacts[i - 1].time_of_impact)))
      return fmt::format("contact {} is out of order", i);
    for (const WallHit& w : report.contacts.walls_of(c))
      if (std::abs(norm(w.normal) - 1.0) > 1e-12) return fmt::format("contact {} has a normal that is no unit", i);
    ++kinds[static_cast<std::size_t>(c.kind)];
  }
  const Counters& n = report.counters;
  if (kinds != n.contacts) return "contacts are not as counted";
  if (n.particle_steps > particles || n.particle_steps + report.held.size() < particles)
    return fmt::format("{} steps and {} held for {} particles", n.particle_steps, report.held.size(), particles);
  if (std::accumulate(n.histogram.begin(), n.histogram.end(), std::uint64_t{0}) != n.particle_steps)
    return "the histogram is not of all steps";
  return "";
}

}  // namespace dartcast::soak
