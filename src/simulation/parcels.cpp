// Numbers of particles in parcels, and impacts on walls.
#include "simulation/parcels.hpp"

#include <algorithm>
#include <cmath>

namespace dartcast {

namespace {

constexpr double pi = 3.14159265358979323846;

}  // namespace

Parcels::Parcels(const SimulationOptions& options) : options_(options) {
  const std::vector<std::string>& names = options.user_data;
  const auto found = std::find(names.begin(), names.end(), parcel_number);
  if (found != names.end()) column_ = static_cast<std::size_t>(found - names.begin());
}

std::uint64_t Parcels::number(const ParticleSet& set, std::size_t i) const {
  if (!column_) return 1;
  const double said = set.user_data(i)[*column_];
  if (!(said >= 1.0)) return 1;
  return static_cast<std::uint64_t>(std::min(said, static_cast<double>(most_in_parcel)));
}

std::vector<std::uint64_t> Parcels::numbers(const ParticleSet& set) const {
  std::vector<std::uint64_t> all;
  if (!column_) return all;
  all.reserve(set.table.rows());
  for (std::size_t i = 0; i < set.table.rows(); ++i) all.push_back(number(set, i));
  return all;
}

Parcel Parcels::parcel(const ParticleSet& set, std::size_t i) const {
  const std::uint64_t count = number(set, i);
  const double diameter = set.table[set.table.diameter][i];
  double mass = pi / 6.0 * set.table[set.table.density][i] * diameter * diameter * diameter;
  const double radius = set.radii()[i];
  if (mass == 0.0 && options_.collisions)
    mass = 4.0 / 3.0 * pi * options_.collisions->density * radius * radius * radius;
  return {count, static_cast<double>(count) * mass};
}

// The way that is left at a contact takes the rest of the segment. If a contact is at the end of its segment, none is left.
// Its displacement then began at the particle's last contact, or else where the segment did.
std::vector<Impact> impacts_of(const SimulationStep& step, const SimulationOptions& options) {
  const ContactList& list = step.report.contacts;
  std::vector<Impact> impacts;
  impacts.reserve(list.contacts.size());
  const double segments = options.substeps;
  for (std::size_t i = 0; i < list.contacts.size(); ++i) {
    const Contact& c = list.contacts[i];
    const double segment_end = std::max(1.0, std::ceil(c.time_of_impact * segments)) / segments;
    const bool is_at_end = !(c.time_of_impact < segment_end);
    double begin = is_at_end ? segment_end - 1.0 / segments : c.time_of_impact;
    if (is_at_end && i > 0 && step.contact_ids[i - 1] == step.contact_ids[i])
      begin = std::max(begin, list.contacts[i - 1].time_of_impact);
    const Vec3& way = is_at_end ? c.displacement : c.unused;
    Impact impact = {step.parcels[i].number, step.parcels[i].mass};
    const double length = norm(way);
    if (length > 0.0 && begin < segment_end) {
      const double speed = length / ((segment_end - begin) * options.dt);
      impact.energy = 0.5 * impact.mass * speed * speed;
      impact.sine = std::min(std::abs(dot(way, list.walls_of(c).front().normal)) / length, 1.0);
    }
    impacts.push_back(impact);
  }
  return impacts;
}

}  // namespace dartcast
