// The same steps of particles by an environment of the whole mesh, and by ranks with a part of it each.
#include "soak/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/shared_environment.hpp"
#include "soak/crowd.hpp"
#include "support/particle_checks.hpp"
#include "support/report_words.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::soak {

namespace {

struct Result {
  std::array<std::uint64_t, 3> place{};
  Cell cell;
  std::vector<double> times;  // of all contacts: step and time
  bool operator==(const Result&) const = default;
};
using Results = std::map<std::uint64_t, Result>;

// The ways of particles and the answers of walls depend on ids and the step alone.
class Script {
 public:
  Script(const Case& c, const SceneMesh& scene, std::vector<Vec3> points, std::uint64_t step)
      : case_(c), scene_(scene), points_(std::move(points)), step_(step) {
    for (std::uint64_t id = 0; id < 40; ++id) {
      Random random = random_for(c, Use::place, 7 + step, id);
      starts.push_back({random.uniform(scene.low.x, scene.high.x), random.uniform(scene.low.y, scene.high.y),
                        random.uniform(scene.low.z, scene.high.z)});
    }
  }
  [[nodiscard]] Vec3 way(std::uint64_t id, std::uint64_t k) const {
    Random random = random_for(case_, Use::target, 100 + step_ * 8 + k, id);
    const double far = scene_.edge * std::pow(10.0, random.uniform(-3.0, 1.0));
    return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * far;
  }
  // The place of a point of the whole mesh. The first step is one at rest.
  [[nodiscard]] Vec3 moved(std::uint32_t point, std::uint64_t k) const {
    if (case_[Knob::motion] == 0 || k == 0) return points_[point];
    Random random = random_for(case_, Use::motion, 1000 + step_ * 8 + k, point);
    const double far = 0.1 * scene_.edge;
    return points_[point] + Vec3{random.uniform(0, far), random.uniform(0, far), random.uniform(0, far)};
  }
  [[nodiscard]] AfterContact answer(std::uint64_t id, const Contact& c, std::span<const WallHit> walls,
                                    std::span<const WallHit> earlier) const {
    switch (id % 4) {
      case 0: return {slid(c.unused, walls, earlier), true};
      case 1: return {};
      case 2: return {reflected(c.unused, walls, 0.8, 0.1), true};
      default: return {-0.5 * c.unused, false};
    }
  }

  static constexpr std::uint64_t steps = 3;
  std::vector<Vec3> starts;

 private:
  const Case& case_;
  const SceneMesh& scene_;
  std::vector<Vec3> points_;
  std::uint64_t step_;
};

Results step_alone(const Script& script, const MeshData& mesh) {
  Environment environment(mesh, Threads{1});
  Particles particles;
  environment.add(particles, script.starts);
  Results results;
  for (std::uint64_t k = 0; k < Script::steps; ++k) {
    std::vector<Vec3> next;
    for (std::uint32_t v = 0; v < mesh.points.size(); ++v) next.push_back(script.moved(v, k));
    environment.move(next);
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + script.way(i, k));
    const StepReport report = environment.advance(particles, targets, [&](const Contact& c, auto walls, auto earlier) {
      return script.answer(c.particle, c, walls, earlier);
    });
    for (const Contact& c : report.contacts.contacts) results[c.particle].times.push_back(double(k) + c.time_of_impact);
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    results[i].place = test::bits(particles[i].position);
    results[i].cell = particles[i].cell;
  }
  return results;
}

Results step_shared(const Script& script, const MeshData& mesh, unsigned count) {
  Results results;
  std::mutex mutex;
  const std::vector<std::uint32_t> owners = partition(mesh, count);
  test::on_ranks(count, [&](Ranks& ranks) {
    SharedEnvironment environment(mesh_part(mesh, owners, count, ranks.rank()), ranks, Threads{1});
    SharedParticles particles;
    environment.add(particles, script.starts);
    for (std::uint64_t k = 0; k < Script::steps; ++k) {
      std::vector<Vec3> next;
      for (const std::uint32_t v : environment.part().points) next.push_back(script.moved(v, k));
      environment.move(next);
      const std::vector<std::uint64_t> ids(particles.ids().begin(), particles.ids().end());
      std::vector<Vec3> targets;
      for (std::size_t i = 0; i < particles.size(); ++i)
        targets.push_back(particles.particles()[i].position + script.way(particles.ids()[i], k));
      const SharedStep step = environment.advance(particles, targets, [&](const Contact& c, auto walls, auto earlier) {
        return script.answer(particles.ids()[c.particle], c, walls, earlier);
      });
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < step.contact_ids.size(); ++i)
        results[step.contact_ids[i]].times.push_back(double(k) + step.report.contacts.contacts[i].time_of_impact);
    }
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      results[particles.ids()[i]].place = test::bits(particles.particles()[i].position);
      results[particles.ids()[i]].cell = environment.whole(particles.particles()[i].cell);
    }
  });
  // A particle's contacts of one step may be on several ranks.
  for (auto& [id, result] : results) std::sort(result.times.begin(), result.times.end());
  return results;
}

}  // namespace

std::string step_on_ranks(const Case& c, const SceneMesh& scene, const CellComplex& complex, std::uint64_t step) {
  // Where free cells overlap, a place is in two cells, and it is open which of them holds a particle.
  if (complex.map().dimension() == 2 || has_bent_sheets(c)) return "";
  MeshData mesh = to_mesh(complex);
  mesh.source.clear();
  const auto far = [](const Vec3& p) { return !in_exact_range(p); };
  if (mesh.cell_count() < c[Knob::ranks] + 1 || std::any_of(mesh.points.begin(), mesh.points.end(), far)) return "";
  const Script script(c, scene, mesh.points, step);
  try {
    const Environment whole(mesh, Threads{1});
    if (whole.complex().steiner_point_count() > 0) return "";  // ranks refuse these
  } catch (const InvalidMesh&) {
    return "";  // cells that are not positive now
  }
  const Results alone = step_alone(script, mesh);
  const Results shared = step_shared(script, mesh, c[Knob::ranks] + 1);
  if (alone.size() != shared.size()) return "other particles";
  for (const auto& [id, result] : alone) {
    if (result.place != shared.at(id).place) return fmt::format("particle {} is at another place", id);
    if (result.cell != shared.at(id).cell) return fmt::format("particle {} is in another cell", id);
    if (result.times != shared.at(id).times) return fmt::format("particle {} has other contacts", id);
  }
  return "";
}

}  // namespace dartcast::soak
