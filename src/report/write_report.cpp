// Makes report.html.
//
// Phases: the viewer's data from report.bin; charts and tables from the run's other files; the page. If the page is
// too large the first phase is done again with fewer particles, then with fewer frames.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>

#include "dartcast/error.hpp"
#include "dartcast/report.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_write.hpp"
#include "report/grouped.hpp"
#include "report/run_charts.hpp"
#include "report/run_results.hpp"
#include "report/summary_file.hpp"
#include "report/viewer_page.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_frames = 65535;  // 16 bits number them

void add_notes(ReportSummary& taken) {
  if (taken.particles < taken.particles_of_run)
    taken.notes.push_back(fmt::format("The report has {} of {} particles, evenly chosen.", grouped(taken.particles),
                                      grouped(taken.particles_of_run)));
  if (taken.frames < taken.frames_recorded)
    taken.notes.push_back(fmt::format("The report has {} of {} frames, evenly chosen.", grouped(taken.frames),
                                      grouped(taken.frames_recorded)));
}

std::string grid_of(const std::string& charts, const char* label) {
  return charts.empty() ? charts
                        : fmt::format("<section class=\"charts\" aria-label=\"{}\">\n{}</section>\n", label, charts);
}

// Results first; how they were computed is folded away.
std::string body_of(const fs::path& folder) {
  const std::string method = grid_of(method_charts(folder), "Charts of the method");
  std::string body = run_results(folder) + grid_of(run_charts(folder), "Charts");
  if (!method.empty()) body += "<details><summary>Method</summary>\n" + method + "</details>\n";
  return body + run_origin(folder);
}

// A folder may have no scene that can be read, as that of a program: then nothing is down.
Vec3 gravity_of(const fs::path& folder) {
  try {
    return parse_scene(run_text(folder / "scene.toml"), folder / "scene.toml").motion.gravity;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

fs::path report_file(const fs::path& run_folder) { return run_folder / "report.html"; }

ReportSummary write_report(const fs::path& run_folder, const ReportOptions& options) {
  if (options.particles == 0 || options.frames == 0 || options.bytes == 0)
    throw InvalidArgument("report: give at least one particle, one frame and one byte");
  if (options.frames > most_frames)
    throw InvalidArgument(fmt::format("report: {} frames; give at most {}", options.frames, most_frames));
  const RecordedFile file(run_folder / "report.bin");
  const ViewerPage around = {scene_name(run_folder), run_caption(run_folder), body_of(run_folder)};
  const Vec3 gravity = gravity_of(run_folder);
  ReportOptions now = options;
  for (bool reduced = false;; reduced = true) {
    ViewerData data = viewer_data(file, now, gravity);
    if (reduced)
      data.taken.notes.push_back(fmt::format("With {} particles and {} frames, the report would have more than {} MB.",
                                             grouped(options.particles), grouped(options.frames),
                                             static_cast<double>(options.bytes) / 1e6));
    add_notes(data.taken);
    const std::string page = viewer_page(around, data);
    const bool can_shrink = data.taken.particles > 500 || data.taken.frames > 2;
    if (page.size() > options.bytes && can_shrink) {
      std::uint64_t& which = data.taken.particles > 500 ? data.taken.particles : data.taken.frames;
      (data.taken.particles > 500 ? now.particles : now.frames) = static_cast<std::size_t>(which / 2);
      continue;
    }
    ReportSummary summary = std::move(data.taken);
    summary.file = report_file(run_folder);
    summary.bytes = page.size();
    const std::string_view whole = page;
    replace_file(summary.file, {&whole, 1});
    return summary;
  }
}

}  // namespace dartcast
