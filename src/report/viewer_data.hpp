// The data that the viewer of a report draws: a description in JSON, and blocks of numbers. docs/report.md has the
// format. Not installed.
#pragma once

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

/// The frames that are shown: those that a run writes every so many steps, and the last one. At most `options.frames`
/// and `options.particles`, evenly chosen. `gravity`: of the scene (m/s^2), so that the page knows what is down. Throws
/// Error as RecordedFile.
ViewerData viewer_data(const RecordedFile& file, const ReportOptions& options, const Vec3& gravity);

}  // namespace dartcast
