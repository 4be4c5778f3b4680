// Steps through periodic faces: where the straight way leads, and what the mesh many times over says.
//
// All coordinates of these meshes are multiples of 2^-15, and pairs turn by quarters. So all images of walls are exact.
#include "soak/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "dartcast/cell_complex.hpp"
#include "soak/repeated.hpp"

namespace dartcast::soak {

namespace {

// Corners of a face in any order.
std::vector<std::tuple<double, double, double>> places_of(const SceneMesh& scene, const CombinatorialMap& map,
                                                          CellFace f, const Placing& by) {
  std::vector<std::tuple<double, double, double>> places;
  const CellView cell = map.view(f.cell);
  for (const std::uint16_t k : cell.shape().corners(f.face)) {
    const Vec3 x = by.point(scene.lattice[cell.vertex(k).value]);
    places.emplace_back(x.x + 0.0, x.y + 0.0, x.z + 0.0);  // no -0
  }
  std::sort(places.begin(), places.end());
  return places;
}

// Whether all steps with it are exact: a multiple of 2^-30 that is not too large.
bool is_on_lattice(const Vec3& x) {
  const auto fits = [](double a) { return std::abs(a) < 0x1p20 && std::floor(a * 0x1p30) == a * 0x1p30; };
  return fits(x.x) && fits(x.y) && fits(x.z);
}

}  // namespace

Partners::Partners(const SceneMesh& scene, const CombinatorialMap& map) {
  for (std::uint16_t pair = 0; pair < scene.pairs.size(); ++pair) {
    std::map<std::vector<std::tuple<double, double, double>>, CellFace> images;  // faces of b by their corners
    const auto for_each = [&](const std::string& patch, auto&& visit) {
      for (const Cell c : map.cells())
        for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f)
          if (map.view(c).is_wall(f) && map.patch_names()[map.patch({c, f}).value] == patch) visit(CellFace{c, f});
    };
    for_each(scene.mesh.periodic[pair].b, [&](CellFace f) { images[places_of(scene, map, f, {})] = f; });
    for_each(scene.mesh.periodic[pair].a, [&](CellFace f) {
      const CellFace to = images.at(places_of(scene, map, f, scene.pairs[pair]));
      if (!map.is_free(f.cell) || !map.is_free(to.cell)) return;
      partners_[{f.cell.value, f.face}] = {to, pair, false};
      partners_[{to.cell.value, to.face}] = {f, pair, true};
    });
  }
}

CellFace Partners::of(CellFace f) const {
  const auto found = partners_.find({f.cell.value, f.face});
  return found == partners_.end() ? CellFace{} : found->second.face;
}

bool Partners::are(const PeriodicCrossing& c) const {
  const auto found = partners_.find({c.from.cell.value, c.from.face});
  return found != partners_.end() && found->second.face == c.to && found->second.pair == c.pair &&
         found->second.back == c.back;
}

Crossed::Crossed(const SceneMesh& scene, std::vector<Vec3>& velocities)
    : scene_(scene), velocities_(velocities), homes_(velocities.size()), counts_(velocities.size()) {}

CrossingCallback Crossed::callback() {
  return [this](const PeriodicCrossing& c) {
    const Placing& there = scene_.pairs[c.pair];
    Vec3& v = velocities_[c.particle];
    v = {dot(c.turn[0], v), dot(c.turn[1], v), dot(c.turn[2], v)};
    homes_[c.particle] = homes_[c.particle] * (c.back ? there : there.inverse());
    ++counts_[c.particle];
  };
}

PeriodicTruth::PeriodicTruth(const Case& c, const SceneMesh& scene, const Environment& environment)
    : case_(c), scene_(scene), partners_(scene, environment.map()), repeated_(Repeated::make(c, scene, environment)) {}
PeriodicTruth::~PeriodicTruth() = default;

std::string PeriodicTruth::check(const Environment& environment, const Crowd& crowd, const PeriodicStep& step) {
  std::string wrong = check_crossings(step);
  if (wrong.empty()) wrong = check_straight(crowd, step);
  if (wrong.empty() && repeated_) wrong = repeated_->check(environment, crowd, step);
  return wrong;
}

std::string PeriodicTruth::check_crossings(const PeriodicStep& step) const {
  const auto& all = step.report.contacts.crossings;
  std::vector<std::uint32_t> counts(step.targets.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PeriodicCrossing& c = all[i];
    if (c.particle >= counts.size()) return fmt::format("crossing {} names no particle", i);
    ++counts[c.particle];
    if (!partners_.are(c)) return fmt::format("crossing {} leads to no partner", i);
    if (!(c.time >= 0.0 && c.time <= 1.0) || !is_finite(c.point)) return fmt::format("crossing {} is nowhere", i);
    if (i > 0 && all[i - 1].particle == c.particle && (all[i - 1].time > c.time || all[i - 1].contacts > c.contacts))
      return fmt::format("crossing {} is out of order", i);
    if (i > 0 && all[i - 1].particle > c.particle) return fmt::format("crossing {} is of an earlier particle", i);
  }
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] != step.crossed.count(i))
      return fmt::format("particle {} has {} crossings, {} were told", i, counts[i], step.crossed.count(i));
  for (const WallHit& w : step.report.contacts.walls)
    if (partners_.of(w.face).valid()) return "a contact with a face that has a partner";
  return "";
}

// Without a contact the image of the end is the target, and the velocity is that of the start, turned.
std::string PeriodicTruth::check_straight(const Crowd& crowd, const PeriodicStep& step) const {
  std::vector<bool> other(step.targets.size());
  for (const Contact& c : step.report.contacts.contacts) other[c.particle] = true;
  for (const HeldParticle& h : step.report.held) other[h.particle] = true;
  const bool gentle = case_.is(Knob::motion, "rest") || case_.is(Knob::motion, "frames");  // nothing is carried far
  for (const StoppedParticle& s : step.report.stopped) {
    const std::uint32_t crossings = step.crossed.count(s.particle);
    const double way = norm(step.targets[s.particle] - step.before[s.particle].position);  // periods are at least 1/2
    if (gentle && !other[s.particle] && crossings > 40.0 + 4.0 * way)
      return fmt::format("particle {} makes {} crossings on a way of {:g}", crowd.ids[s.particle], crossings, way);
    if (!other[s.particle] && step.crossed.count(s.particle) <= step.options.max_crossings)
      return fmt::format("particle {} has stopped before {} crossings", crowd.ids[s.particle],
                         step.options.max_crossings);
    other[s.particle] = true;
  }
  for (std::size_t i = 0; i < other.size(); ++i) {
    if (other[i] || step.before[i].held) continue;
    const Placing& home = step.crossed.home(i);
    const Vec3& q = step.targets[i];
    const Vec3 off = home.point(crowd.particles[i].position) - q;
    const double size = 1.0 + std::abs(q.x) + std::abs(q.y) + std::abs(q.z);
    const bool exact = !step.moved && is_on_lattice(step.before[i].position) && is_on_lattice(q);
    const double slack = exact ? 0.0 : 1e-14 * size * (4.0 + step.crossed.count(i));
    if (!(norm(off) <= slack))
      return fmt::format("particle {} ends {:g} off its straight way after {} crossings", crowd.ids[i], norm(off),
                         step.crossed.count(i));
    if (home.vector(step.answers.velocities[i]) != crowd.velocities[i])
      return fmt::format("particle {} has another velocity after {} crossings", crowd.ids[i], step.crossed.count(i));
  }
  return "";
}

}  // namespace dartcast::soak
