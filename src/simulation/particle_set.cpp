// Operations on states and rows alike.
#include "simulation/particle_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "simulation/force_step.hpp"
#include "simulation/size_sampler.hpp"

namespace dartcast {

void check(const NewParticle& particle, const Environment& environment, const SimulationOptions& options,
           const char* whose, std::size_t number) {
  const auto fail = [&](const char* what, const auto&... values) {
    throw InvalidArgument(fmt::format("simulation: {} ", fmt::format(fmt::runtime(whose), number)) +
                          fmt::format(fmt::runtime(what), values...));
  };
  const auto& [v, radius, numbers, material, sizes, interception] = particle;
  if (!is_finite(v)) fail("velocity must be finite");
  if (environment.map().dimension() == 2 && v.z != 0.0)
    fail("velocity is ({}, {}, {}): in the plane its z must be 0", v.x, v.y, v.z);
  if (!is_radius(radius)) fail("radius is {}: it must be between 0 and 2^100", radius);
  if (radius > 0.0 && options.wall_motion == WallMotion::simultaneous)
    fail("radius is {}: points alone move at the same time as the walls: leave it out, or take the wall motion carried",
         radius);
  if (radius > 0.0 && environment.complex().periodic() != nullptr)
    fail("radius is {}: in a scene with periodic pairs there are points alone: leave it or the pairs out", radius);
  if (const std::string wrong = wrong_material(material, options.forces); !wrong.empty()) fail("{}", wrong);
  if (knows_drops(options) && (material.diameter == 0.0 || material.density == 0.0))
    fail("diameter is {} and density {}: stick_below_weber of walls needs both", material.diameter, material.density);
  if (!numbers.empty() && numbers.size() != options.user_data.size())
    throw InvalidArgument(fmt::format("simulation: {} numbers of user data for a particle; the options name {}",
                                      numbers.size(), options.user_data.size()));
}

void ParticleSet::complete(std::uint64_t id, const NewParticle& particle) {
  const std::size_t i = table.rows();
  table.append_zeros(1);
  table[table.id][i] = id;
  table[table.velocity][i] = particle.velocity;
  const double diameter = particle.sizes != nullptr ? particle.sizes->diameter(id) : particle.material.diameter;
  const double radius = particle.sizes != nullptr && particle.interception ? 0.5 * diameter : particle.radius;
  table[table.radius][i] = radius;
  table[table.diameter][i] = diameter;
  table[table.density][i] = particle.material.density;
  table[table.charge_per_mass][i] = particle.material.charge_per_mass;
  const std::span<double> numbers = table[table.user_data].last(particle.user_data.size());
  std::copy(particle.user_data.begin(), particle.user_data.end(), numbers.begin());
  if (radius > 0.0) ++spheres;
}

void ParticleSet::remove(std::span<const std::uint8_t> marks) {
  states.remove(marks);
  remove_rows(marks);
}

void ParticleSet::remove_rows(std::span<const std::uint8_t> marks) {
  table.remove(marks);
  if (spheres > 0) count_spheres();
}

void ParticleSet::count_spheres() {
  const std::span<const double> radii = table[table.radius];
  spheres = static_cast<std::size_t>(std::count_if(radii.begin(), radii.end(), [](double r) { return r > 0.0; }));
}

void ParticleSet::put_in_order_of_ids() {
  const std::vector<std::uint32_t> order = table.sort_by(table.id);
  if (!order.empty()) states.reorder(order);
}

}  // namespace dartcast
