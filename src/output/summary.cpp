// Checks a summary, and has the library's version.
#include "output/summary.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

std::string version() { return DARTCAST_VERSION; }

std::vector<Deposition> depositions(const Summary& s) {
  const SimulationTotals& t = s.totals;
  std::vector<Deposition> all;
  for (std::size_t i = 0; i < t.deposited_by_patch.size(); ++i) {
    const std::uint64_t escaped = i < t.escaped_by_patch.size() ? t.escaped_by_patch[i] : 0;
    Deposition d{s.patch_names[i], t.deposited_by_patch[i], escaped};
    if (i == 0 && d.deposited + escaped == 0) continue;
    if (t.start + t.injected > 0)
      d.fraction = static_cast<double>(d.deposited) / static_cast<double>(t.start + t.injected);
    if (i < s.patch_areas.size()) d.area = s.patch_areas[i];
    if (d.area > 0.0) d.per_area = static_cast<double>(d.deposited) / d.area;
    all.push_back(std::move(d));
  }
  return all;
}

std::string deposition_csv(const Summary& s) {
  std::string text = "patch,deposited,escaped,fraction,area,deposited_per_area\n";
  for (const Deposition& d : depositions(s)) {
    text += fmt::format("{},{},{},{}", d.patch, d.deposited, d.escaped, d.fraction);
    text += d.area > 0.0 ? fmt::format(",{},{}\n", d.area, d.per_area) : ",,\n";
  }
  return text;
}

void check_summary(const Summary& s) {
  std::size_t patches = std::max({s.totals.contacts_by_patch.size(), s.totals.deposited_by_patch.size()});
  if (s.statistics) {
    const StatisticsSummary& all = *s.statistics;
    patches = std::max({patches, all.hits_by_patch.size(), all.left.size()});
    if (all.planes.size() > all.options.planes.size()) {
      throw InvalidArgument(
          fmt::format("summary: {} planes, but options for {}", all.planes.size(), all.options.planes.size()));
    }
  }
  if (patches > s.patch_names.size())
    throw InvalidArgument(fmt::format("summary: values for {} patches, but {} names", patches, s.patch_names.size()));
}

}  // namespace dartcast
