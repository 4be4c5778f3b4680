// A trajectory as a table.
#include <fmt/format.h>

#include "dartcast/trajectory.hpp"

namespace dartcast {

std::string trajectory_csv(const CombinatorialMap& map, std::span<const Trace> traces) {
  std::string table = "step,time,event,kind,x,y,z,cell,next\n";
  for (const TrajectoryPoint& p : trajectory_points(traces)) {
    const std::string next = p.next.valid() ? fmt::format("{}", map.source(p.next)) : std::string();
    table += fmt::format("{},{},{},{},{},{},{},{},{}\n", p.step + 1, p.time, name_of(p.mark), name_of(p.kind),
                         p.point.x, p.point.y, p.point.z, map.source(p.cell), next);
  }
  return table;
}

}  // namespace dartcast
