// Advances particles along polylines, segment by segment, as one step.
#include "simulation/polyline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast {

namespace {

void check(const Particles& particles, std::span<const Vec3> targets, std::size_t segments, bool plane) {
  const bool match = particles.size() == 0
                         ? targets.empty()
                         : targets.size() / particles.size() == segments && targets.size() % particles.size() == 0;
  if (segments == 0 || !match) {
    throw InvalidArgument(fmt::format("advance_polyline: {} targets for {} particles of {} segments each",
                                      targets.size(), particles.size(), segments));
  }
  const auto is_good = [plane](const Vec3& x) { return in_exact_range(x) && (!plane || x.z == 0.0); };
  const auto bad = std::find_if_not(targets.begin(), targets.end(), is_good);
  if (bad == targets.end()) return;
  const auto at = static_cast<std::size_t>(bad - targets.begin());
  throw InvalidArgument(fmt::format(
      "advance_polyline: target {} of particle {} is not finite, outside the exact range or not in the plane",
      at % segments, at / segments));
}

StepReport follow_segments(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                           std::size_t segments, const ContactCallback& respond, const StepOptions& options) {
  std::vector<std::uint8_t> ended(particles.size(), 0);
  std::vector<Vec3> aims(particles.size());
  StepReport report;
  for (std::size_t k = 0; k < segments; ++k) {
    for (std::size_t i = 0; i < aims.size(); ++i) {
      aims[i] = ended[i] != 0 ? particles[i].position : targets[i * segments + k];
    }
    StepReport segment = environment.advance(particles, aims, respond, options);
    for (const Contact& c : segment.contacts.contacts) ended[c.particle] = 1;
    for (const HeldParticle& h : segment.held) ended[h.particle] = 1;
    append_segment(report, std::move(segment), k, segments);
  }
  report.stopped.clear();
  for (std::uint32_t i = 0; i < ended.size(); ++i) {
    if (ended[i] == 0) continue;
    report.stopped.push_back({i, targets[(i + 1) * segments - 1] - particles[i].position});
  }
  return report;
}

}  // namespace

void append_segment(StepReport& report, StepReport segment, std::size_t index, std::size_t segments) {
  for (Contact& c : segment.contacts.contacts) {
    c.time_of_impact = (static_cast<double>(index) + c.time_of_impact) / static_cast<double>(segments);
  }
  const bool sorted = report.contacts.contacts.empty() || segment.contacts.contacts.empty();
  report.contacts.append(segment.contacts);
  if (!sorted) {
    // Walls stay where they are: contacts name them by place.
    std::stable_sort(report.contacts.contacts.begin(), report.contacts.contacts.end(),
                     [](const Contact& a, const Contact& b) { return a.particle < b.particle; });
  }
  std::vector<HeldParticle> held;
  std::set_union(report.held.begin(), report.held.end(), segment.held.begin(), segment.held.end(),
                 std::back_inserter(held),
                 [](const HeldParticle& a, const HeldParticle& b) { return a.particle < b.particle; });
  report.held = std::move(held);
  report.stopped = std::move(segment.stopped);
  report.counters += segment.counters;
}

StepReport advance_polyline(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                            std::size_t segments, const ContactCallback& respond, const StepOptions& options) {
  check(particles, targets, segments, environment.map().dimension() == 2);
  if (particles.size() == 0) return environment.advance(particles, {}, respond, options);
  if (!respond) return follow_segments(environment, particles, targets, segments, respond, options);
  const Particles before = particles;  // a response is the caller's code: it may throw
  try {
    return follow_segments(environment, particles, targets, segments, respond, options);
  } catch (...) {
    particles = before;
    throw;
  }
}

}  // namespace dartcast
