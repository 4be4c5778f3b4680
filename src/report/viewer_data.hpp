// The data that the viewer of a report draws: a description in JSON, and blocks of numbers. docs/report.md has the
// format. Not installed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/report.hpp"
#include "report/recorded.hpp"

namespace dartcast {

struct ViewerData {
  std::string description;          ///< one JSON object
  std::vector<std::string> blocks;  ///< each the base64 of a gzip stream
  ReportSummary taken;              ///< numbers of particles and frames
  std::string picture;              ///< SVG of the first frame, for pages that cannot draw it
};

/// The trajectory of one particle as the subject of a page: its frames are the points of the trajectory, and each has
/// an event that describes it. Times are steps.
struct TrajectorySubject {
  std::size_t patch = 0;  ///< of the faces around the cells passed
};

/// The frames that are shown: those that a run writes every so many steps, and the last one. At most `options.frames`
/// and `options.particles`, evenly chosen. Throws Error as RecordedFile.
ViewerData viewer_data(const RecordedFile& file, const ReportOptions& options,
                       std::optional<TrajectorySubject> trajectory = {});

}  // namespace dartcast
