// The points of a trajectory, from the traces of a particle.
#include "dartcast/trajectory.hpp"

#include <array>

namespace dartcast {

namespace {

// The crossings and contacts of one step: each crossing knows how many contacts came before it.
void add_events(const Trace& trace, std::size_t step, std::vector<TrajectoryPoint>& points) {
  std::size_t met = 0;
  const auto add_contacts = [&](std::size_t until) {
    for (; met < until; ++met) {
      const Contact& c = trace.contacts.contacts[met];
      points.push_back({TrajectoryMark::contact, step, c.time_of_impact, c.point, c.kind, c.dart.cell, {}});
    }
  };
  for (const Crossing& c : trace.crossings) {
    add_contacts(c.contacts);
    points.push_back({TrajectoryMark::crossing, step, c.time, c.point, c.kind, c.from, c.to});
  }
  add_contacts(trace.contacts.contacts.size());
}

}  // namespace

std::vector<TrajectoryPoint> trajectory_points(std::span<const Trace> traces) {
  std::vector<TrajectoryPoint> points;
  if (traces.empty()) return points;
  const Trace& first = traces.front();
  points.push_back({TrajectoryMark::start, 0, 0.0, first.before.position, first.start.kind, first.before.cell, {}});
  for (std::size_t step = 0; step < traces.size(); ++step) {
    const Trace& trace = traces[step];
    add_events(trace, step, points);
    const TrajectoryMark mark = step + 1 < traces.size() ? TrajectoryMark::target : TrajectoryMark::end;
    points.push_back({mark, step, 1.0, trace.after.position, trace.end.kind, trace.after.cell, {}});
  }
  return points;
}

std::string_view name_of(Kind kind) {
  constexpr std::array<std::string_view, 4> names = {"vertex", "edge", "face", "volume"};
  return names[static_cast<std::size_t>(kind)];
}

std::string_view name_of(TrajectoryMark mark) {
  constexpr std::array<std::string_view, 5> names = {"start", "crossing", "contact", "target", "end"};
  return names[static_cast<std::size_t>(mark)];
}

}  // namespace dartcast
