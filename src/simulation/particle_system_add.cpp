// Adding particles: at given positions, at random, and at inlets. Where ranks share the particles, each goes through all,
// and adds its own.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

namespace {

constexpr auto max_injected = static_cast<double>(most_at_once);  // by an inlet in a step

bool leaves_plane(const Environment& environment, const Vec3& v) {
  return environment.map().dimension() == 2 && v.z != 0.0;
}

void check_plane(const Environment& environment, const Vec3& v, std::string_view what) {
  if (leaves_plane(environment, v))
    throw InvalidArgument(
        fmt::format("simulation: {} is ({}, {}, {}): in the plane its z must be 0", what, v.x, v.y, v.z));
}

}  // namespace

void ParticleSystem::check_motion(const Vec3& velocity, double radius, std::string_view whose) const {
  if (!is_finite(velocity)) throw InvalidArgument(fmt::format("simulation: {} velocity must be finite", whose));
  check_plane(environment_, velocity, fmt::format("{} velocity", whose));
  if (!is_radius(radius))
    throw InvalidArgument(fmt::format("simulation: {} radius is {}: it must be between 0 and 2^100", whose, radius));
  if (radius > 0.0 && options_.wall_motion == WallMotion::simultaneous)
    throw InvalidArgument(fmt::format(
        "simulation: {} radius is {}: points alone move at the same time as the walls: leave it out, or take "
        "the wall motion carried",
        whose, radius));
}

void ParticleSystem::check_user_data(std::span<const double> values) const {
  if (!values.empty() && values.size() != width())
    throw InvalidArgument(
        fmt::format("simulation: {} numbers of user data for a particle; the options name {}", values.size(), width()));
}

void ParticleSystem::add_inlet(Patch patch, double rate, const Vec3& velocity, double radius,
                               std::span<const double> user_data) {
  if (!(rate >= 0.0 && rate * options_.dt <= max_injected))
    throw InvalidArgument(fmt::format(
        "simulation: an inlet's rate is {}: it must not be negative, and at most {} a second with steps of {} s "
        "(2^31 particles a step)",
        rate, max_injected / options_.dt, options_.dt));
  check_motion(velocity, radius, "an inlet's");
  check_user_data(user_data);
  inlets_.push_back({patch,
                     PatchSampler(environment_.complex(), patch, sampled_part()),
                     rate,
                     velocity,
                     radius,
                     {user_data.begin(), user_data.end()}});
}

std::vector<AddResult> ParticleSystem::add(std::span<const Vec3> positions, const Vec3& velocity, double radius,
                                           std::span<const double> user_data) {
  check_motion(velocity, radius, "a particle's");
  check_user_data(user_data);
  SetAddition addition(set_);
  std::vector<AddResult> added = add_own(positions);
  for (const AddResult& a : added) complete_next(a, velocity, radius, user_data);
  addition.keep();
  totals_.start = set_.next_id - totals_.injected;
  return added;
}

std::vector<AddResult> ParticleSystem::add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                           std::span<const double> radii, std::span<const double> user_data) {
  if (velocities.size() != positions.size() || radii.size() != positions.size())
    throw InvalidArgument(fmt::format("simulation: {} velocities and {} radii for {} positions", velocities.size(),
                                      radii.size(), positions.size()));
  check_user_data(user_data);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool good = is_finite(velocities[i]) && !leaves_plane(environment_, velocities[i]) && is_radius(radii[i]);
    if (!good) check_motion(velocities[i], radii[i], fmt::format("particle {}'s", i));
  }
  SetAddition addition(set_);
  std::vector<AddResult> added = add_own(positions);
  for (std::size_t i = 0; i < added.size(); ++i) complete_next(added[i], velocities[i], radii[i], user_data);
  addition.keep();
  totals_.start = set_.next_id - totals_.injected;
  return added;
}

// Adds those of this rank to the environment, and says of all where they are.
std::vector<AddResult> ParticleSystem::add_own(std::span<const Vec3> positions) {
  if (share_.has_all()) return environment_.add(set_.states, positions);
  if (part_ != nullptr) return part_->add(set_.states, positions);
  const std::vector<Location> locations = environment_.locate(positions);
  std::vector<AddResult> added(positions.size());
  std::vector<Vec3> own;
  std::vector<std::size_t> which;
  std::uint64_t id = set_.next_id;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    added[i].location = locations[i];
    if (locations[i].place != Place::free || !share_.holds(id++)) continue;
    own.push_back(positions[i]);
    which.push_back(i);
  }
  const std::vector<AddResult> results = environment_.add(set_.states, own);
  for (std::size_t k = 0; k < which.size(); ++k) added[which[k]].particle = results[k].particle;
  return added;
}

// Gives the next id to a particle that is in the scene; where it is this rank's, completes it.
void ParticleSystem::complete_next(const AddResult& added, const Vec3& velocity, double radius,
                                   std::span<const double> user_data) {
  if (added.location.place != Place::free) return;
  const std::uint64_t id = set_.next_id++;
  if (added.particle != AddResult().particle) set_.complete(id, {velocity, radius, user_data});
}

// Sampled points are rounded: one that fell out of its simplex is drawn again, with the next numbers of the same id.
template <class Sampler>
void ParticleSystem::add_sampled(const Sampler& sampler, std::size_t count, const Vec3& velocity, double radius,
                                 std::span<const double> user_data) {
  constexpr std::size_t at_once = std::size_t{1} << 20U;
  SetAddition addition(set_);
  while (count > 0) {
    const std::size_t some = std::min(count, at_once);
    const auto placed =
        part_ != nullptr ? place_in_part(sampler, set_.next_id, some) : place(sampler, set_.next_id, some);
    for (const std::uint64_t id : placed) set_.complete(id, {velocity, radius, user_data});
    set_.next_id += some;
    count -= some;
  }
  if (part_ != nullptr) set_.put_in_order_of_ids();
  addition.keep();
}

// Puts the particles of these ids that are this rank's at random places; returns their ids.
template <class Sampler>
std::vector<std::uint64_t> ParticleSystem::place(const Sampler& sampler, std::uint64_t first, std::uint64_t count) {
  constexpr int max_tries = 1000;
  std::vector<std::uint64_t> placed;
  for (std::uint64_t id = first; id < first + count; ++id) {
    if (!share_.holds(id)) continue;
    placed.push_back(id);
    KeyedRandom random(options_.seed, RandomPurpose::place, id);
    int tries = 0;
    while (true) {
      const std::optional<Sample> s = sampler.sample(environment_.complex(), random);
      if (s && environment_.add(set_.states, s->simplex, flushed(s->position))) break;
      if (++tries == max_tries)
        throw InvalidArgument(
            "simulation: random points fall outside the free cells again and again: their cells are too thin or not "
            "valid");
    }
  }
  return placed;
}

void ParticleSystem::add_random(std::size_t count, const Vec3& velocity, double radius,
                                std::span<const double> user_data) {
  check_count(count);
  check_motion(velocity, radius, "a particle's");
  check_user_data(user_data);
  if (count > 0)
    add_sampled(VolumeSampler(environment_.complex(), environment_.threads(), sampled_part()), count, velocity, radius,
                user_data);
  totals_.start = set_.next_id - totals_.injected;
}

void ParticleSystem::inject() {
  const ScopeTimer timer(totals_.seconds_respond);
  for (Inlet& inlet : inlets_) {
    const auto up_to = [&](std::uint64_t steps) {
      return std::floor(inlet.rate * options_.dt * static_cast<double>(steps));
    };
    const auto count = static_cast<std::uint64_t>(up_to(motion_.steps() + 1) - up_to(motion_.steps()));
    if (count == 0 || inlet.sampler.empty()) continue;
    if (motion_.deforms()) inlet.sampler.update(environment_.complex());
    add_sampled(inlet.sampler, count, inlet.velocity, inlet.radius, inlet.user_data);
    last_.injected += count;
  }
  totals_.injected += last_.injected;
}

}  // namespace dartcast
