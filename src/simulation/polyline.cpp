// Joins the reports of the segments of one step.
#include "simulation/polyline.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace dartcast {

void append_segment(StepReport& report, StepReport segment, std::size_t index, std::size_t segments) {
  for (Contact& c : segment.contacts.contacts) {
    c.time_of_impact = (static_cast<double>(index) + c.time_of_impact) / static_cast<double>(segments);
  }
  for (PeriodicCrossing& c : segment.contacts.crossings)
    c.time = (static_cast<double>(index) + c.time) / static_cast<double>(segments);
  const bool sorted = report.contacts.contacts.empty() || segment.contacts.contacts.empty();
  report.contacts.append(segment.contacts);
  if (!sorted) {
    // Walls stay where they are: contacts name them by place.
    std::stable_sort(report.contacts.contacts.begin(), report.contacts.contacts.end(),
                     [](const Contact& a, const Contact& b) { return a.particle < b.particle; });
  }
  std::stable_sort(report.contacts.crossings.begin(), report.contacts.crossings.end(),
                   [](const PeriodicCrossing& a, const PeriodicCrossing& b) { return a.particle < b.particle; });
  std::vector<HeldParticle> held;
  std::set_union(report.held.begin(), report.held.end(), segment.held.begin(), segment.held.end(),
                 std::back_inserter(held),
                 [](const HeldParticle& a, const HeldParticle& b) { return a.particle < b.particle; });
  report.held = std::move(held);
  report.stopped = std::move(segment.stopped);
  report.counters += segment.counters;
}

}  // namespace dartcast
