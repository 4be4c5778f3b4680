#include "bench/workload.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "simulation/seeding.hpp"
#include "tracking/carry.hpp"

namespace dartcast::bench {

namespace {

constexpr std::uint64_t seed = 1;
constexpr double lattice_step = 0.125;  // a power of two: all coordinates stay exact

Vec3 random_direction(Random& random, unsigned dimension) {
  if (dimension == 2) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec3 lattice_direction(Random& random) {
  const auto component = [&] { return static_cast<double>(random.below(3)) - 1.0; };
  for (;;) {
    const Vec3 d = {component(), component(), component()};
    if (d != Vec3{}) return d;
  }
}

// In the closed unit cube of x: on a face, an edge or a corner of it.
Vec3 on_lattice(const Vec3& x, Random& random) {
  const std::uint32_t first = random.below(3);
  const std::uint32_t flat = 1 + random.below(3);  // so many coordinates are whole numbers
  std::array<double, 3> c = {std::floor(x.x), std::floor(x.y), std::floor(x.z)};
  for (std::uint32_t k = 0; k < 3; ++k) {
    c[(first + k) % 3] += k < flat ? random.below(2) : lattice_step * random.below(9);
  }
  return {c[0], c[1], c[2]};
}

}  // namespace

Workload::Workload(const WorkloadOptions& options) : Workload(options, mesh_of(options)) {}

Workload::Workload(const WorkloadOptions& options, MeshData mesh) : options_(options), environment_(mesh, Threads{}) {
  if (options.scene == Scene::bar) {
    dt_ = 0.01;
    gravity_ = {0.0, 0.0, -9.81};
  } else if (options.scene == Scene::vessel) {
    dt_ = 3e-4;
    cell_size_ = VesselOptions{}.step_length;
    field_.emplace(environment_.complex(), vectors(mesh, "velocity"), FieldFrame::mesh);
  } else if (options.scene != Scene::lattice) {
    speed_ = options.step_length;
    gravity_ = environment_.map().dimension() == 2 ? Vec3{0.0, -0.001 * speed_, 0.0} : Vec3{0.0, 0.0, -0.001 * speed_};
  }
  std::vector<DeformationStep> steps = deformation_of(options, mesh);
  if (!steps.empty()) deformation_.emplace(std::move(steps), environment_.positions());
  mesh = {};
  add_particles();
}

void Workload::add_particles() {
  Random random(seed);
  if (options_.scene == Scene::lattice) {
    add_on_lattice(options_.particles, random);
  } else {
    const VolumeSampler sampler(environment_.complex());
    KeyedRandom places(seed, RandomPurpose::place, 0);
    while (particles_.size() < options_.particles) {
      const Sample sample = *sampler.sample(environment_.complex(), places);
      environment_.add(particles_, sample.simplex, sample.position);
    }
  }
  if (options_.cell_order) sort_by_cell();
  set_velocities(random);
  targets_.resize(particles_.size());
}

void Workload::add_on_lattice(std::size_t count, Random& random) {
  const VolumeSampler sampler(environment_.complex());
  KeyedRandom near(seed, RandomPurpose::place, 0);
  std::vector<Vec3> places(count);
  for (Vec3& place : places) place = on_lattice(sampler.sample(environment_.complex(), near)->position, random);
  environment_.add(particles_, places);
}

void Workload::sort_by_cell() {
  std::vector<std::uint32_t> order(particles_.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto states = particles_.states();
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(states[a].at(), a) < std::pair(states[b].at(), b);
  });
  particles_.reorder(order);
}

void Workload::set_velocities(Random& random) {
  velocities_.resize(particles_.size());
  for (Vec3& v : velocities_) {
    switch (options_.scene) {
      case Scene::lattice: v = lattice_direction(random) * lattice_step; break;
      case Scene::bar: v = {2.0, 3.0, 0.0}; break;
      case Scene::vessel: v = {1.0, 0.0, 0.0}; break;
      case Scene::box:
      case Scene::squares:
      case Scene::tube: v = random_direction(random, environment_.map().dimension()) * speed_; break;
    }
  }
}

void Workload::positions_after(std::uint64_t step, std::span<Vec3> out) const {
  deformation_->positions(static_cast<double>(step) * dt_, out, Threads{1});
}

void Workload::aim() {
  ++step_;
  std::span<const Vec3> next = environment_.complex().positions();
  if (deformation_) {
    const std::span<Vec3> positions = environment_.next_positions();
    positions_after(step_, positions);
    next = positions;
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (field_) {
      targets_[i] = flushed(carried(i, next));
    } else {
      velocities_[i] += gravity_ * dt_;
      targets_[i] = flushed(particles_[i].position + velocities_[i] * dt_);
    }
  }
}

// Along with the mesh, and by the flow in it.
Vec3 Workload::carried(std::size_t particle, std::span<const Vec3> next) const {
  const CellComplex& complex = environment_.complex();
  const ParticleState& state = particles_[particle];
  const Weights weights = detail::barycentric(complex.corners(state.at()), state.position);
  const auto v = complex.vertices(state.at());
  const Corners corners = {next[v[0].value], next[v[1].value], next[v[2].value], next[v[3].value]};
  const Vec3 flow = field_->at(complex, state.at(), weights, corners);
  return detail::combine(corners, weights) + flow * (velocities_[particle].x * dt_);
}

void Workload::update_after_edit(const StepReport& report) {
  for (const Contact& contact : report.contacts.contacts) {
    Vec3& v = velocities_[contact.particle];
    v = field_ ? -v : rebound(v, contact, report.contacts.walls_of(contact));
  }
}

Vec3 Workload::rebound(const Vec3& v, const Contact& contact, std::span<const WallHit> walls) const {
  const Vec3 wall = contact.wall_displacement * (1.0 / dt_);
  const Vec3 relative = reflected(v - wall, walls, 1.0, 0.0);
  // Steps keep their length however walls move and particles fall.
  const double scale = speed_ > 0.0 ? speed_ / norm(relative) : 1.0;
  return relative * scale + wall;
}

}  // namespace dartcast::bench
