// The choice of frames and particles for a report. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "dartcast/report.hpp"
#include "report/recorded.hpp"

namespace dartcast {

struct ReportSelection {
  struct Frame {
    std::size_t chunk = 0;  ///< of the file
    std::size_t walls = 0;  ///< chunk of the walls that hold then
    std::uint64_t step = 0;
    double time = 0.0;
  };

  std::vector<Frame> frames;
  std::vector<RecordedFrame> recorded;                    ///< of each frame
  std::vector<std::uint64_t> ids;                         ///< of the slots, ascending
  std::unordered_map<std::uint64_t, std::uint32_t> slot;  ///< by id
  std::uint64_t recorded_frames = 0;
  std::uint64_t recorded_ids = 0;
  std::uint64_t all_ids = 0;  ///< of the run
};

/// Throws Error if there is no frame, or one has other walls than were recorded.
ReportSelection select(const RecordedFile& file, const ReportOptions& options);

}  // namespace dartcast
