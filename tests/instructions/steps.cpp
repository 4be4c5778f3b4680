// Fixed small scenes to count instructions in: `steps still`, `steps moving`, `steps lattice`, `steps long` or
// `steps long_moving`, and in the plane `steps plane` or `steps plane_moving`; `steps corner` for particles that rest in a
// vertex. The count is the code that Environment::advance() executes (run.cmake); the number of particle-steps is printed,
// and how many steps were split. And `steps edits EDGE COUNT`:
// edits of a box of EDGE^3 cells, each followed by the particles. `steps cut`: one cut through the wall of a vessel. `steps
// drag`, `steps forces` and `steps brownian`: whole steps of drops in a flow, by a constant drag, by Schiller-Naumann's with
// buoyancy, and by these with Brownian motion. `steps travel`: walks that have met no wall are packed for another rank, and unpacked, 10,000 at a time; it also prints times.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <vector>

#include "base/bytes.hpp"
#include "base/random.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/response.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/seeding.hpp"
#include "tracking/batch/traveller.hpp"

namespace {

using namespace dartcast;

constexpr std::uint32_t edge = 10;
constexpr std::uint32_t plane_edge = 32;
constexpr std::size_t particles = 1000;
constexpr std::size_t steps = 50;

Environment make_plane() {
  RectangleOptions squares;
  squares.cells = {plane_edge, plane_edge};
  squares.size = {plane_edge, plane_edge};
  squares.blocked_share = 0.1;
  return Environment(generate_rectangle(squares), Threads{1});
}

Environment make_environment() {
  BoxOptions box;
  box.cells = {edge, edge, edge};
  box.size = {edge, edge, edge};
  box.blocked_layer = true;
  box.blocked_share = 0.1;
  return Environment(generate_box(box), Threads{1});
}

// A twist of 0.06 cells a step at most.
void twist(std::span<const Vec3> rest, double time, std::span<Vec3> out) {
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double x = rest[i].x - edge / 2.0;
    const double y = rest[i].y - edge / 2.0;
    const double angle = 0.3 * std::sin(2e-2 * std::numbers::pi * time) * rest[i].z / edge;
    out[i] = {x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle), rest[i].z};
  }
}

// In the plane: squares lean over, by 0.06 cells a step at most.
void shear(std::span<const Vec3> rest, double time, std::span<Vec3> out) {
  for (std::size_t i = 0; i < rest.size(); ++i)
    out[i] = rest[i] + Vec3{0.03 * std::sin(2e-2 * std::numbers::pi * time) * rest[i].y, 0, 0};
}

// Any way, or along the lattice's lines, or in the plane.
std::vector<Vec3> random_velocities(Random& random, double cells, bool along_lattice, bool plane) {
  std::vector<Vec3> velocities;
  while (velocities.size() < particles) {
    Vec3 v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (plane) v.z = 0;
    velocities.push_back(along_lattice ? Vec3{v.x < 0 ? -0.125 : 0.125, 0, 0} : v * (cells / norm(v)));
  }
  return velocities;
}

// One cell and its neighbours at a time, far from one another.
int edit(std::uint32_t box_edge, std::uint32_t count) {
  BoxOptions box;
  box.cells = {box_edge, box_edge, box_edge};
  box.size = {double(box_edge), double(box_edge), double(box_edge)};
  Environment environment(generate_box(box), Threads{1});
  KeyedRandom random(7, RandomPurpose::place, 0);
  const VolumeSampler sampler(environment.complex());
  Particles set;
  while (set.size() < particles) {
    const Sample s = *sampler.sample(environment.complex(), random);
    environment.add(set, s.simplex, s.position);
  }
  const std::vector<Cell> cells = environment.map().cells();
  const auto stride = static_cast<std::uint32_t>(cells.size() / count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t at = i * stride;
    while (!environment.map().contains(cells[at])) ++at;
    const Cell c = cells[at];
    environment.edit([&](ComplexEdit& e) { split_edge(e.topology(), {c, static_cast<std::uint16_t>(i % 24)}); });
    environment.update_after_edit(set);
  }
  std::printf("%u edits\n", count);
  return 0;
}

// A disc of 24 sides, as in scenes/surgery.toml.
int cut_vessel() {
  Environment environment(generate_vessel({}), Threads{1});
  Particles set;
  const Vec3 upstream{0, 0, -20e-3};
  environment.add(set, std::span<const Vec3>(&upstream, 1));
  const std::vector<ConvexTool> tools = thicken(Disc{{0, 0, -12e-3}, {0, 0.2, 1}, 6e-3}, 1.2e-3);
  std::size_t opened = 0;
  environment.edit([&](ComplexEdit& e) {
    opened = carve(e, cells_near(environment.complex(), tools), tools, Carving::open).opened.size();
  });
  environment.update_after_edit(set);
  std::printf("%zu cells opened\n", opened);
  return 0;
}

// Under gravity in the vertex of a sharp tetrahedron, off it by rounding at first.
int rest_in_corner() {
  MeshData mesh;
  mesh.points = {{0, 0, -1}, {-0.2, -0.1, 0}, {0.2, -0.1, 0}, {0, 0.25, 0}};
  mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  Environment environment(mesh, Threads{1});
  Particles set;
  const Vec3 at{0, 0, -1 + 1e-12};
  for (std::size_t i = 0; i < particles; ++i) environment.add(set, std::span<const Vec3>(&at, 1));
  const Acceleration gravity{{0, 0, -3}, 0.01};
  const WallResponses responses({WallResponseKind::reflect, 0.5, 0.0});
  std::vector<Vec3> velocities(particles);
  std::vector<ParticleStatus> statuses(particles, ParticleStatus::alive);
  std::vector<Vec3> targets(particles);
  const ContactCallback respond = respond_with(responses, velocities, statuses, gravity.duration, gravity);
  std::uint64_t contacts = 0;
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < particles; ++i) {
      velocities[i] += gravity.value * gravity.duration;
      targets[i] = set[i].position + velocities[i] * gravity.duration;
    }
    contacts += environment.advance(set, targets, respond).contacts.contacts.size();
  }
  std::printf("%zu particle-steps, %llu contacts\n", particles * steps, static_cast<unsigned long long>(contacts));
  return 0;
}

// Drops of many sizes in a swirl, some 0.05 cells a step. The constant drag is about that of the drops.
int drops(bool by_forces, bool thermal) {
  Environment environment = make_environment();
  SimulationOptions options;
  options.dt = 0.01;
  options.gravity = {0, 0, -9.81};
  options.drag = by_forces ? 0.0 : 30.0;
  if (by_forces) {
    options.forces.terms = {Force::schiller_naumann, Force::buoyancy};
    options.forces.fluid = {1.2, 1.8e-5, 0.0, 300.0};
    if (thermal) options.forces.terms.push_back(Force::brownian);
  }
  Simulation simulation(environment, options);
  std::vector<Vec3> flow;
  for (const Vec3& x : environment.positions()) flow.push_back({5.0 - x.y, x.x - 5.0, 0.4});
  simulation.set_field(VelocityField(environment.complex(), flow));
  for (std::size_t i = 0; i < 10; ++i)
    simulation.add_random(particles / 10, {}, 0.0, {}, {1e-4 * (1.0 + 0.1 * double(i)), 1000.0, 0.0});
  for (std::size_t step = 0; step < steps; ++step) simulation.step();
  std::printf("%zu particle-steps\n", particles * steps);
  return 0;
}

int travel() {
  constexpr std::size_t batch = 10'000;
  constexpr std::size_t batches = 21;
  using Clock = std::chrono::steady_clock;
  Traveller walk;
  walk.step.stage = StepStage::on_way;
  walk.step.walk.end = WalkEnd::wall;
  const std::vector<Traveller> leaving(batch, walk);
  std::vector<Traveller> come;
  come.reserve(batch);
  ByteWriter bytes;
  std::vector<double> times;
  for (std::size_t b = 0; b < batches; ++b) {
    bytes.clear();
    come.clear();
    const auto start = Clock::now();
    for (const Traveller& t : leaving) pack(t, bytes);
    for (ByteReader in(bytes.bytes()); !in.at_end();) unpack(in, come.emplace_back());
    times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count() / batch);
  }
  std::sort(times.begin(), times.end());
  std::printf("%zu travellers, %zu bytes each, %.0f ns each\n", batch * batches, bytes.bytes().size() / batch,
              times[batches / 2]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "edits") == 0)
    return edit(static_cast<std::uint32_t>(std::atoi(argv[2])), static_cast<std::uint32_t>(std::atoi(argv[3])));
  const char* kind = argc == 2 ? argv[1] : "";
  if (std::strcmp(kind, "corner") == 0) return rest_in_corner();
  if (std::strcmp(kind, "cut") == 0) return cut_vessel();
  if (std::strcmp(kind, "travel") == 0) return travel();
  const bool thermal = std::strcmp(kind, "brownian") == 0;
  if (thermal || std::strcmp(kind, "drag") == 0 || std::strcmp(kind, "forces") == 0)
    return drops(kind[0] != 'd', thermal);
  const bool plane = std::strncmp(kind, "plane", 5) == 0;
  const bool moving = std::strstr(kind, "moving") != nullptr;
  const bool lattice = std::strcmp(kind, "lattice") == 0;
  Environment environment = plane ? make_plane() : make_environment();
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  Random random(5);
  KeyedRandom places(5, RandomPurpose::place, 0);
  const VolumeSampler sampler(environment.complex());
  Particles set;
  while (set.size() < particles) {
    const Sample s = *sampler.sample(environment.complex(), places);
    const auto nearest = [](double x) { return std::round(8.0 * x) / 8.0; };
    const Vec3 on_lattice{nearest(s.position.x), std::round(s.position.y), std::round(s.position.z)};
    if (lattice) {
      environment.add(set, std::span<const Vec3>(&on_lattice, 1));
    } else {
      environment.add(set, s.simplex, s.position);
    }
  }
  CellTally tally(environment.complex());
  if (std::strstr(kind, "tally") != nullptr) environment.set_tally(&tally);
  const bool far = std::strncmp(kind, "long", 4) == 0;
  const double cells = far ? (moving ? 200.0 : 3.0) : 0.1;  // a step
  std::vector<Vec3> velocities = random_velocities(random, cells, lattice, plane);
  std::vector<Vec3> targets(particles);
  std::uint64_t contacts = 0;
  std::uint64_t split = 0;
  for (std::size_t step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < particles; ++i) targets[i] = set[i].position + velocities[i];
    if (moving) {
      (plane ? shear : twist)(rest, static_cast<double>(step), environment.next_positions());
      environment.move();
    }
    const StepReport report = environment.advance(set, targets);
    contacts += report.contacts.contacts.size();
    split += report.counters.steps_split;
    for (const Contact& c : report.contacts.contacts) {
      Vec3& v = velocities[c.particle];
      if (lattice) {
        v = v * -1.0;
        continue;
      }
      const Vec3 n = report.contacts.walls_of(c).front().normal;
      v -= n * (2.0 * std::min(0.0, dot(v, n)));
    }
  }
  std::printf("%zu particle-steps, %llu contacts, %llu split\n", particles * steps,
              static_cast<unsigned long long>(contacts), static_cast<unsigned long long>(split));
}
