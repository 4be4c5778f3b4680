// The verbs report and view: make a run's report again, and open it.
#include "dartcast/report.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "dartcast/error.hpp"
#include "limits.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string run;
  std::uint64_t particles = ReportOptions{}.particles;
  std::uint64_t frames = ReportOptions{}.frames;
  bool json = false;
};

std::string report_json(const ReportSummary& s) {
  const nlohmann::ordered_json json = {
      {"file", s.file.string()},
      {"bytes", s.bytes},
      {"particles", {{"shown", s.particles}, {"recorded", s.particles_recorded}, {"of_run", s.particles_of_run}}},
      {"frames", {{"shown", s.frames}, {"recorded", s.frames_recorded}}},
      {"notes", s.notes}};
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int report(const ReportArguments& a) {
  const ReportSummary summary =
      write_report(a.run, {static_cast<std::size_t>(a.particles), static_cast<std::size_t>(a.frames)});
  if (a.json) {
    fmt::print("{}\n", report_json(summary));
    return done;
  }
  for (const std::string& note : summary.notes) fmt::print("{}\n", note);
  fmt::print("{}: {:.1f} MB, {} particles, {} frames\n", summary.file.string(),
             static_cast<double>(summary.bytes) / 1e6, summary.particles, summary.frames);
  return done;
}

// Whether the desktop's program for opening files took it. No shell sees the path.
bool is_opened(const std::string& path) {
  std::string program = "xdg-open";
  std::string file = path;
  std::array<char*, 3> words = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, words.data(), environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int view(const std::string& run) {
  const fs::path file = report_file(run);
  const fs::path recording = fs::path(run) / "report.bin";
  const bool is_current =
      fs::exists(file) && (!fs::exists(recording) || fs::last_write_time(file) >= fs::last_write_time(recording));
  if (!is_current) write_report(run);
  const std::string path = fs::absolute(file).lexically_normal().string();
  const bool has_display = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
  if (!has_display || !is_opened(path)) fmt::print("{}\n", path);
  return done;
}

}  // namespace

void add_report(CLI::App& app, int& status) {
  const auto a = std::make_shared<ReportArguments>();
  CLI::App* verb =
      app.add_subcommand("report", "Make a run's report.html again, with more or fewer particles and frames.");
  verb->add_option("RUN", a->run, "the output folder of a run")->required()->type_name("FOLDER");
  verb->add_option("--particles", a->particles, "show at most so many particles (10000)")
      ->type_name("N")
      ->transform(whole_number(1, std::numeric_limits<std::uint32_t>::max()));
  verb->add_option("--frames", a->frames, "show at most so many frames, 1 to 65535 (100)")
      ->type_name("N")
      ->transform(whole_number(1, 65535));
  verb->add_flag("--json", a->json, "print what was made as one JSON object, and nothing else");
  verb->callback([a, &status] { status = report(*a); });
}

void add_view(CLI::App& app, int& status) {
  const auto run = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("view", "Open a run's report; where there is no display, print its path.");
  verb->add_option("RUN", *run, "the output folder of a run")->required()->type_name("FOLDER");
  verb->callback([run, &status] { status = view(*run); });
}

}  // namespace dartcast::app
