// Adding particles, at given positions and at random. Where ranks share the particles, each goes through all, and adds its
// own.
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "simulation/inlets.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

std::vector<AddResult> ParticleSystem::add(std::span<const Vec3> positions, const NewParticle& particle) {
  check(particle, environment_, options_, "a particle's");
  const std::vector<Vec3> velocities(positions.size(), particle.velocity);
  return add(positions, velocities, std::vector<double>(positions.size(), particle.radius), particle.user_data,
             {&particle.material, 1});
}

std::vector<AddResult> ParticleSystem::add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                           std::span<const double> radii, std::span<const double> user_data,
                                           std::span<const Material> materials) {
  if (velocities.size() != positions.size() || radii.size() != positions.size())
    throw InvalidArgument(fmt::format("simulation: {} velocities and {} radii for {} positions", velocities.size(),
                                      radii.size(), positions.size()));
  if (materials.size() > 1 && materials.size() != positions.size())
    throw InvalidArgument(fmt::format("simulation: {} materials for {} positions", materials.size(), positions.size()));
  const auto material = [&](std::size_t i) {
    return materials.empty() ? Material{} : materials[materials.size() == 1 ? 0 : i];
  };
  for (std::size_t i = 0; i < positions.size(); ++i)
    check({velocities[i], radii[i], user_data, material(i)}, environment_, options_, "particle {}'s", i);
  std::vector<AddResult> added;
  set_.enlarge([&] {
    added = add_own(positions);
    for (std::size_t i = 0; i < added.size(); ++i) {
      if (added[i].location.place != Place::free) continue;
      const std::uint64_t id = set_.next_id++;
      const bool mine = added[i].particle != AddResult().particle;
      if (mine) set_.complete(id, {velocities[i], radii[i], user_data, material(i)});
    }
  });
  totals_.start = set_.next_id - totals_.injected;
  return added;
}

// Adds those of this rank to the environment, and says of all where they are.
std::vector<AddResult> ParticleSystem::add_own(std::span<const Vec3> positions) {
  const ParticleShare share(options_.ranks);
  if (share.has_all()) return environment_.add(set_.states, positions);
  if (part_ != nullptr) return part_->add(set_.states, positions);
  const std::vector<Location> locations = environment_.locate(positions);
  std::vector<AddResult> added(positions.size());
  std::vector<Vec3> own;
  std::vector<std::size_t> which;
  std::uint64_t id = set_.next_id;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    added[i].location = locations[i];
    if (locations[i].place != Place::free || !share.holds(id++)) continue;
    own.push_back(positions[i]);
    which.push_back(i);
  }
  const std::vector<AddResult> results = environment_.add(set_.states, own);
  for (std::size_t k = 0; k < which.size(); ++k) added[which[k]].particle = results[k].particle;
  return added;
}

template <class Sampler>
void ParticleSystem::add_sampled(const Sampler& sampler, std::uint64_t count, const NewParticle& particle) {
  constexpr std::uint64_t at_once = std::uint64_t{1} << 20U;
  const Placing placing = {environment_, share(), sampled_part(), options_.seed};
  set_.enlarge([&] {
    for (const std::uint64_t end = set_.next_id + count; set_.next_id < end;) {
      const std::uint64_t some = std::min(end - set_.next_id, at_once);
      const auto placed = place(placing, set_.states, sampler, set_.next_id, some);
      for (const std::uint64_t id : placed) set_.complete(id, particle);
      set_.next_id += some;
      if (!std::is_sorted(placed.begin(), placed.end())) set_.put_in_order_of_ids();
    }
  });
}

void ParticleSystem::send_out(const InletCone& cone, std::size_t first) {
  for (std::size_t i = first; i < set_.states.size(); ++i) {
    KeyedRandom random(options_.seed, RandomPurpose::direction, set_.ids()[i]);
    set_.velocities()[i] = direction_in(cone, environment_.map().dimension(), random) * cone.speed;
  }
}

void ParticleSystem::add_random(std::size_t count, const NewParticle& particle) {
  check_count(count);
  check(particle, environment_, options_, "a particle's");
  if (count > 0)
    add_sampled(VolumeSampler(environment_.complex(), environment_.threads(), sampled_part()), count, particle);
  totals_.start = set_.next_id - totals_.injected;
}

void ParticleSystem::inject(Inlets& inlets) {
  last_ = {};
  last_.duration = options_.dt;
  last_.absorbed = std::exchange(edited_.since_step, 0);
  const ScopeTimer timer(totals_.seconds_respond);
  inlets.inject(sampled_part(), [this](const Injection& in) {
    const std::size_t first = set_.states.size();  // ids increase: the new ones stand behind all others
    std::visit([&](const auto* sampler) { add_sampled(*sampler, in.count, in.particle); }, in.sampler);
    if (in.cone != nullptr) send_out(*in.cone, first);
    if (in.with_field) aiming_.start_with_field(set_, first, motion_.time());
    last_.injected += in.count;
  });
  totals_.injected += last_.injected;
  if (aiming_.eddies().act() || sampled_.integrate() || !options_.diffusivity.empty())
    take_samples();  // of new ones, and after an edit
}

}  // namespace dartcast
