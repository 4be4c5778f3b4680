// The report of a run: one HTML file that shows the scene in 3D, with charts and tables (docs/report.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dartcast/threads.hpp"

namespace dartcast {

/// How much a report shows.
struct ReportOptions {
  std::size_t particles = 10000;     ///< at most; chosen evenly by id
  std::size_t frames = 100;          ///< at most, to 65,535; chosen evenly
  std::uint64_t bytes = 15'000'000;  ///< at most: beyond it, fewer particles and frames are taken
  Threads threads = {};              ///< the page does not depend on them
};

/// The contents of a report, and the parts it leaves out.
struct ReportSummary {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
  std::uint64_t particles = 0;           ///< in the report
  std::uint64_t particles_recorded = 0;  ///< by the run: evenly chosen by id if it had more than 20,000
  std::uint64_t particles_of_run = 0;
  std::uint64_t frames = 0;
  std::uint64_t frames_recorded = 0;
  std::vector<std::string> notes;  ///< what was left out, and why; empty: nothing
};

/// Makes report.html in a run's folder from what the run recorded there (report.bin, stats.csv, summary.json,
/// scene.toml). The page needs no other file and no network. Throws Error if the folder holds no recording, or a file
/// of it is damaged; InvalidArgument if an option is 0, or there are more than 65,535 frames. Cost: linear in the
/// recording.
ReportSummary write_report(const std::filesystem::path& run_folder, const ReportOptions& options = {});

/// Where write_report() writes.
std::filesystem::path report_file(const std::filesystem::path& run_folder);

}  // namespace dartcast
