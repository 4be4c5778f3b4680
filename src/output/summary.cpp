// Checks a summary, and has the library's version.
#include "output/summary.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

std::string version() { return DARTCAST_VERSION; }

void check_summary(const Summary& s) {
  std::size_t patches = s.totals.contacts_by_patch.size();
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
