// The mesh many times over, and the same steps in it.
#include "soak/repeated.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::soak {

namespace {

constexpr std::size_t most_cells = 12000;
constexpr std::size_t most_particles = 200;
constexpr std::int32_t outside_tag = 4712;

// All places of copies up to some periods away, the mesh itself first.
std::vector<Placing> images_of(const SceneMesh& scene, int reach) {
  std::vector<Placing> images = {{}};
  for (const Placing& pair : scene.pairs) {
    const std::vector<Placing> before = images;
    for (int k = pair.quarters != 0 ? 1 : -reach; k <= (pair.quarters != 0 ? 3 : reach); ++k) {
      if (k == 0) continue;
      Placing by;
      for (int i = 0; i < std::abs(k); ++i) by = by * (k > 0 ? pair : pair.inverse());
      for (const Placing& image : before) images.push_back(image * by);
    }
  }
  return images;
}

bool is_of_pair(const MeshData& mesh, std::int32_t tag) {
  return std::any_of(mesh.periodic.begin(), mesh.periodic.end(), [&](const PeriodicPair& p) {
    return mesh.patch_names.at(tag) == p.a || mesh.patch_names.at(tag) == p.b;
  });
}

}  // namespace

std::unique_ptr<PeriodicTruth::Repeated> PeriodicTruth::Repeated::make(const Case& c, const SceneMesh& scene,
                                                                       const Environment& environment) {
  for (const int reach : {2, 1}) {
    std::vector<Placing> images = images_of(scene, reach);
    if (images.size() * scene.mesh.cell_count() <= most_cells)
      return std::unique_ptr<Repeated>(new Repeated(c, scene, environment, std::move(images)));
  }
  return nullptr;
}

PeriodicTruth::Repeated::Repeated(const Case& c, const SceneMesh& scene, const Environment& environment,
                                  std::vector<Placing> images)
    : case_(c), images_(std::move(images)) {
  MeshData all;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  for (std::size_t image = 0; image < images_.size(); ++image) {
    std::vector<std::uint32_t> number;
    for (std::uint32_t v = 0; v < scene.lattice.size(); ++v) {
      const Vec3 x = images_[image].point(scene.lattice[v]);
      const auto [entry, added] = known.try_emplace({x.x + 0.0, x.y + 0.0, x.z + 0.0}, std::uint32_t(points_.size()));
      if (added) points_.emplace_back(image, v);
      number.push_back(entry->second);
    }
    const auto numbered = [&](std::span<const std::uint32_t> corners) {
      std::vector<std::uint32_t> list(corners.begin(), corners.end());
      for (std::uint32_t& v : list) v = number[v];
      return list;
    };
    for (std::size_t cell = 0; cell < scene.mesh.cell_count(); ++cell)
      all.add_cell(scene.mesh.types[cell], numbered(scene.mesh.cell(cell)));
    for (std::size_t f = 0; f < scene.mesh.patch_tags.size(); ++f) {
      const std::int32_t tag = scene.mesh.patch_tags[f];
      const bool baffle = std::count(scene.mesh.baffle_tags.begin(), scene.mesh.baffle_tags.end(), tag) > 0;
      if (baffle || is_of_pair(scene.mesh, tag))
        all.add_patch_face(numbered(scene.mesh.patch_face(f)), baffle ? tag : outside_tag);
    }
    all.free.insert(all.free.end(), scene.mesh.free.begin(), scene.mesh.free.end());
  }
  simplices_ = std::all_of(all.types.begin(), all.types.end(), [](CellType t) { return t == CellType::triangle; });
  all.baffle_tags = scene.mesh.baffle_tags;
  all.patch_names[outside_tag] = "outside";
  for (const std::int32_t tag : all.baffle_tags) all.patch_names[tag] = "baffle";
  all.points = places(environment.positions());
  all_ = std::make_unique<Environment>(std::move(all), Threads{1});
  outside_ = all_->map().patch("outside");
  cells_.resize(scene.mesh.cell_count());
  for (const Cell cell : all_->map().cells())
    if (all_->map().source(cell) < cells_.size()) cells_[all_->map().source(cell)] = cell;
}

std::vector<Vec3> PeriodicTruth::Repeated::places(std::span<const Vec3> of_one) const {
  std::vector<Vec3> all;
  for (const auto& [image, v] : points_) all.push_back(images_[image].point(of_one[v]));
  return all;
}

bool PeriodicTruth::Repeated::put(Particles& particles, Cell cell, const Vec3& at) {
  const auto count = static_cast<std::uint16_t>(all_->map().shape(cell).simplices().size());
  for (std::uint16_t s = 0; s < count; ++s)
    if (all_->add(particles, SimplexId{cell, s}, at)) return true;
  return false;
}

std::vector<PeriodicTruth::Repeated::Way> PeriodicTruth::Repeated::take(const Environment& environment,
                                                                        const Crowd& crowd, const PeriodicStep& step,
                                                                        std::vector<Start>& starts, bool any_cell) {
  const CellComplex& complex = environment.complex();
  all_->move(places(step.moved ? complex.previous_positions() : complex.positions()));
  Particles particles;
  std::vector<Start> there;
  std::vector<Vec3> targets, velocities;
  std::vector<std::uint64_t> ids;
  std::vector<ParticleStatus> statuses;
  for (const Start& s : starts) {
    const Cell cell = cells_[environment.map().source(step.before[s.particle].cell)];
    const bool found =
        any_cell ? all_->add(particles, {&s.from, 1})[0].location.place == Place::free : put(particles, cell, s.from);
    if (!found) continue;
    there.push_back(s);
    targets.push_back(s.to);
    ids.push_back(crowd.ids[s.particle]);
    velocities.push_back(crowd.velocities[s.particle]);
    statuses.push_back(crowd.statuses[s.particle]);
  }
  starts = there;
  if (step.moved) all_->move(places(complex.positions()));
  Answers answers(case_, step.number, ids, velocities, statuses);
  const StepReport report = all_->advance(particles, targets, answers.one_by_one(), step.options);
  std::vector<Way> ways(starts.size());
  for (std::size_t i = 0; i < ways.size(); ++i) {
    ways[i].end = particles[i].position;
    ways[i].velocity = answers.velocities[i];
    ways[i].graze = particles[i].held;
  }
  for (const Contact& c : report.contacts.contacts) {
    Way& way = ways[c.particle];
    way.first = std::min(way.first, c.time_of_impact);
    way.graze = way.graze || c.kind != (environment.map().dimension() == 2 ? Kind::edge : Kind::face);
    for (const WallHit& w : report.contacts.walls_of(c)) way.graze = way.graze || w.patch == outside_;
  }
  return ways;
}

// Whether ways beside it are like it.
bool PeriodicTruth::Repeated::is_stable(const Environment& environment, const Crowd& crowd, const PeriodicStep& step,
                                        const Start& start, const Way& way) {
  std::vector<Start> starts;
  Random random = random_for(case_, Use::answer, step.number, 900);
  for (int i = 0; i < 12; ++i) {
    const auto hair = [&] {
      Vec3 v = test::random_vector(random, 1e-7);
      if (environment.map().dimension() == 2) v.z = 0.0;
      return v;
    };
    starts.push_back({start.particle, start.from + hair(), start.to + hair()});
  }
  const std::vector<Way> ways = take(environment, crowd, step, starts, true);
  return ways.size() == 12 && std::all_of(ways.begin(), ways.end(), [&](const Way& w) {
           return !w.graze && std::abs(w.first - way.first) < 1e-3 && norm(w.end - way.end) < 1e-3 &&
                  norm(w.velocity - way.velocity) < 1e-3;
         });
}

std::string PeriodicTruth::Repeated::check(const Environment& environment, const Crowd& crowd,
                                           const PeriodicStep& step) {
  const bool plane = environment.map().dimension() == 2;
  // Cells that are no simplices may be cut in other ways here, and carry particles in other ways.
  if (!step.valid || (plane && step.moved && !simplices_)) return "";
  std::vector<double> first(step.targets.size(), 1.0);
  std::vector<bool> other(step.targets.size());
  for (const Contact& c : step.report.contacts.contacts) {
    first[c.particle] = std::min(first[c.particle], c.time_of_impact);
    if (c.kind != (plane ? Kind::edge : Kind::face) || c.last) other[c.particle] = true;
  }
  // These, and each last answer, ask for the walls met before, which a passage ends.
  const bool asks = case_.is(Knob::response, "slide") || case_.is(Knob::response, "any answer");
  for (const PeriodicCrossing& c : step.report.contacts.crossings)
    if (c.contacts > 0 && asks) other[c.particle] = true;
  std::vector<Start> starts;
  for (std::size_t i = 0; i < step.targets.size() && starts.size() < most_particles; ++i)
    if (!other[i] && !step.before[i].held && !crowd.particles[i].held &&
        step.crossed.count(i) <= std::min(step.options.max_crossings, 8U))
      starts.push_back({i, step.before[i].position, step.targets[i]});
  const std::vector<Way> ways = take(environment, crowd, step, starts, false);
  int doubts = 0;
  for (std::size_t k = 0; k < ways.size() && doubts < 8; ++k) {
    const std::size_t i = starts[k].particle;
    const Way& way = ways[k];
    if (way.graze) continue;
    const double slack = (asks ? 1e-3 : 1e-9) * (1.0 + norm(starts[k].to - starts[k].from));
    const Vec3 end = step.crossed.home(i).point(crowd.particles[i].position);
    const Vec3 velocity = step.crossed.home(i).vector(step.answers.velocities[i]);
    // How often a way along walls touches them again depends on rounding: the first contact and the end count.
    if (std::abs(first[i] - way.first) < 1e-9 && norm(end - way.end) < slack && norm(velocity - way.velocity) < slack)
      continue;
    ++doubts;
    if (!is_stable(environment, crowd, step, starts[k], way)) continue;
    return fmt::format("particle {} ends {:g} from where it does in the repeated mesh; first contacts at {} and {}",
                       crowd.ids[i], norm(end - way.end), first[i], way.first);
  }
  return "";
}

}  // namespace dartcast::soak
