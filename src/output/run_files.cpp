// Names and tables of the files in a run's folder.
#include "output/run_files.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

// The start and the end of the names of a series of frames; whether the name of a body or catheter stands between.
struct Series {
  std::string_view start;
  std::string_view end;
  bool named;
};
constexpr std::array<Series, 6> all_series = {{{"particles_", ".vtp", false},
                                               {"environment_", ".vtu", false},
                                               {"body_", ".vtp", true},
                                               {"surface_", ".vtp", true},
                                               {"catheter_", ".vtp", true},
                                               {"camera_", ".vtp", true}}};

bool is_step(std::string_view text) {
  return text.size() >= 6 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// The digits of the step in the name of a frame's file of the series; empty where it is none.
std::string_view step_digits(std::string_view name, const Series& series) {
  if (!name.starts_with(series.start) || !name.ends_with(series.end)) return {};
  if (name.size() < series.start.size() + series.end.size()) return {};
  std::string_view digits = name.substr(series.start.size(), name.size() - series.start.size() - series.end.size());
  if (series.named) {
    const std::size_t last = digits.rfind('_');
    if (last == std::string_view::npos || last == 0) return {};
    digits = digits.substr(last + 1);
  }
  return is_step(digits) ? digits : std::string_view{};
}

// The list of a series with a name: body_NAME.pvd.
bool is_list(std::string_view name) {
  return name.ends_with(".pvd") && std::any_of(all_series.begin(), all_series.end(), [&](const Series& s) {
           return s.named && name.starts_with(s.start) && name.size() > s.start.size() + 4;
         });
}

}  // namespace

bool is_run_file(const std::string& name) {
  static constexpr std::array<std::string_view, 10> fixed = {
      "summary.json", "stats.csv",  "particles.pvd",  "environment.pvd", "environment.vtu",
      "contacts.csv", "scene.toml", "checkpoint.bin", "bodies.csv",      "catheters.csv"};
  if (std::find(fixed.begin(), fixed.end(), name) != fixed.end()) return true;
  return is_list(name) || frame_step(name);
}

std::optional<std::uint64_t> frame_step(std::string_view name) {
  for (const Series& series : all_series) {
    const std::string_view digits = step_digits(name, series);
    std::uint64_t step = 0;
    if (!digits.empty() && std::from_chars(digits.data(), digits.data() + digits.size(), step).ec == std::errc())
      return step;
  }
  return {};
}

std::string frame_name(std::string_view series, std::uint64_t step, std::string_view ending) {
  return fmt::format("{}_{:06}{}", series, step, ending);
}

void write_pvd(const fs::path& path, std::span<const RecordingFrame> frames,
               const std::function<std::string(std::uint64_t step)>& name) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n <Collection>\n";
  for (const RecordingFrame& frame : frames) {
    text += fmt::format("  <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", frame.time, name(frame.step));
  }
  write_bytes(path, text + " </Collection>\n</VTKFile>\n");
}

RunTable::RunTable(fs::path path, std::string_view header) : path_(std::move(path)), file_(path_, std::ios::binary) {
  fmt::print(file_, "{}\n", header);
  file_.flush();  // by it the folder is known as a run's, wherever that is cut off
  if (!file_)
    throw Error(fmt::format("{}: the file cannot be written; check the folder and its permissions", path_.string()));
}

RunTable::RunTable(fs::path path, std::uint64_t bytes) : path_(std::move(path)) {
  std::error_code error;
  if (fs::file_size(path_, error) < bytes || error)
    throw Error(
        fmt::format("{}: the file is shorter than when the checkpoint was made; run without --resume", path_.string()));
  fs::resize_file(path_, bytes, error);
  file_.open(path_, std::ios::binary | std::ios::app);
  if (error || !file_)
    throw Error(fmt::format("{}: the file cannot be written; check the folder and its permissions", path_.string()));
}

void RunTable::check() {
  if (!file_) throw Error(fmt::format("{}: the table cannot be written; check the disk's space", path_.string()));
}

std::uint64_t RunTable::written() { return file_.is_open() ? static_cast<std::uint64_t>(file_.flush().tellp()) : 0; }

void RunTable::close() {
  if (!file_.is_open()) return;
  file_.close();
  if (!file_)
    throw Error(fmt::format("{}: the file could not be written to the end; check the disk's space", path_.string()));
}

}  // namespace dartcast
