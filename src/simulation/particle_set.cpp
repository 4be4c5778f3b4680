// What happens to states and rows alike.
#include "simulation/particle_set.hpp"

#include <algorithm>
#include <vector>

#include "base/put_in_order.hpp"

namespace dartcast {

void ParticleSet::complete(std::uint64_t id, const NewParticle& particle) {
  const std::size_t i = table.rows();
  table.append_zeros(1);
  table[table.id][i] = id;
  table[table.velocity][i] = particle.velocity;
  table[table.radius][i] = particle.radius;
  const std::span<double> numbers = table[table.user_data].last(particle.user_data.size());
  std::copy(particle.user_data.begin(), particle.user_data.end(), numbers.begin());
  if (particle.radius > 0.0) ++spheres;
}

void ParticleSet::remove(std::span<const std::uint8_t> marks) {
  states.remove(marks);
  remove_rows(marks);
}

void ParticleSet::remove_rows(std::span<const std::uint8_t> marks) {
  table.remove(marks);
  count_spheres();
}

void ParticleSet::count_spheres() {
  const std::span<const double> radii = table[table.radius];
  spheres = static_cast<std::size_t>(std::count_if(radii.begin(), radii.end(), [](double r) { return r > 0.0; }));
}

void ParticleSet::put_in_order_of_ids() {
  const std::vector<std::uint32_t> order = order_of(table[table.id]);
  if (order.empty()) return;
  states.reorder(order);
  table.reorder(order);
}

}  // namespace dartcast
