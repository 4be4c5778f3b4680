// Names and tables of the files in a run's folder.
#include "output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

// The start and the end of the names of a series of frames; whether the name of a body or catheter stands between.
struct Series {
  std::string_view start;
  std::string_view end;
  bool named;
};
constexpr std::array<Series, 10> all_series = {{{"particles_", ".vtp", false},
                                                {"particles_", ".pvtp", false},
                                                {"environment_", ".vtu", false},
                                                {"environment_", ".pvtu", false},
                                                {"walls_", ".vtp", false},
                                                {"body_", ".vtp", true},
                                                {"surface_", ".vtp", true},
                                                {"catheter_", ".vtp", true},
                                                {"camera_", ".vtp", true},
                                                {"solid_", ".vtp", true}}};

bool is_step(std::string_view text) {
  return text.size() >= 6 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// The digits of the step in the name of a frame's file of the series; empty if it is none.
std::string_view step_digits(std::string_view name, const Series& series) {
  if (!name.starts_with(series.start) || !name.ends_with(series.end)) return {};
  if (name.size() < series.start.size() + series.end.size()) return {};
  std::string_view digits = name.substr(series.start.size(), name.size() - series.start.size() - series.end.size());
  if (series.named) {
    const std::size_t last = digits.rfind('_');
    if (last == std::string_view::npos || last == 0) return {};
    digits = digits.substr(last + 1);
  }
  if (const std::size_t dot = digits.find('.'); dot != std::string_view::npos) {
    const std::string_view rank = digits.substr(dot + 1);  // of a piece
    if (rank.empty() || rank.find_first_not_of("0123456789") != std::string_view::npos) return {};
    digits = digits.substr(0, dot);
  }
  return is_step(digits) ? digits : std::string_view{};
}

std::optional<std::uint64_t> step_of(std::string_view digits) {
  std::uint64_t step = 0;
  if (digits.empty() || std::from_chars(digits.data(), digits.data() + digits.size(), step).ec != std::errc())
    return {};
  return step;
}

constexpr Series checkpoint_parts = {"checkpoint_", ".bin", false};

// The list of a series with a name: body_NAME.pvd.
bool is_list(std::string_view name) {
  return name.ends_with(".pvd") && std::any_of(all_series.begin(), all_series.end(), [&](const Series& s) {
           return s.named && name.starts_with(s.start) && name.size() > s.start.size() + 4;
         });
}

}  // namespace

bool is_run_file(std::string_view name) {
  if (is_part_of_run_file(name)) return true;
  static constexpr std::array<std::string_view, 23> fixed = {
      "summary.json",  "stats.csv",          "particles.pvd",  "environment.pvd", "environment.vtu", "contacts.csv",
      "scene.toml",    "checkpoint.bin",     "bodies.csv",     "catheters.csv",   "walls.pvd",       "planes.csv",
      "crossings.csv", "pathlines.bin",      "pathlines.vtp",  "report.bin",      "report.html",     kept_mesh_name,
      "solids.csv",    "solid_contacts.csv", "deposition.csv", "cells.csv",       replay_name};
  if (std::find(fixed.begin(), fixed.end(), name) != fixed.end()) return true;
  return is_list(name) || frame_step(name) || checkpoint_part_step(name);
}

std::string checkpoint_part_name(std::uint64_t step, unsigned rank) {
  return frame_name("checkpoint", step, fmt::format(".{}.bin", rank));
}

std::optional<std::uint64_t> checkpoint_part_step(std::string_view name) {
  return step_of(step_digits(name, checkpoint_parts));
}

bool is_part_of_run_file(std::string_view name) {
  return name.ends_with(part_ending) && is_run_file(name.substr(0, name.size() - part_ending.size()));
}

std::optional<std::uint64_t> frame_step(std::string_view name) {
  for (const Series& series : all_series) {
    if (const auto step = step_of(step_digits(name, series))) return step;
  }
  return {};
}

std::string piece_name(std::string_view series, std::uint64_t step, unsigned piece, std::string_view ending) {
  return frame_name(series, step, fmt::format(".{}{}", piece, ending));
}

std::string frame_name(std::string_view series, std::uint64_t step, std::string_view ending) {
  return fmt::format("{}_{:06}{}", series, step, ending);
}

void write_pvd(const fs::path& path, std::span<const RecordingFrame> frames,
               const std::function<std::string(const RecordingFrame&)>& name) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n <Collection>\n";
  for (const RecordingFrame& frame : frames) {
    text += fmt::format("  <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", frame.time, name(frame));
  }
  text += " </Collection>\n</VTKFile>\n";
  const std::string_view whole = text;
  replace_file(path, {&whole, 1});
}

void keep_in_pvd(const fs::path& path, const std::set<std::uint64_t>& kept) {
  static constexpr std::string_view start = "file=\"";
  const std::string before = read_bytes(path);
  std::string after;
  for (std::size_t at = 0; at < before.size();) {
    const std::size_t end = std::min(before.find('\n', at), before.size() - 1) + 1;
    const std::string_view line = std::string_view(before).substr(at, end - at);
    const std::size_t name = line.find(start);
    const auto step = name == std::string_view::npos
                          ? std::nullopt
                          : frame_step(line.substr(name + start.size(), line.rfind('"') - name - start.size()));
    if (!step || kept.contains(*step)) after += line;
    at = end;
  }
  const std::string_view whole = after;
  if (after != before) replace_file(path, {&whole, 1});
}

RunTable::RunTable(fs::path path, std::string_view header) : path_(std::move(path)), bytes_(header.size() + 1) {
  const std::array<std::string_view, 2> line = {header, "\n"};
  replace_file(path_, line);  // by it the folder is known as a run's, wherever that is cut off
}

RunTable::RunTable(fs::path path, std::uint64_t bytes) : path_(std::move(path)), bytes_(bytes) {
  std::error_code error;
  if (fs::file_size(path_, error) < bytes || error)
    throw Error(
        fmt::format("{}: the file is shorter than when the checkpoint was made; run without --resume", path_.string()));
  fs::resize_file(path_, bytes, error);
  if (error)
    throw Error(fmt::format("{}: the file cannot be written; check the folder and its permissions", path_.string()));
}

std::uint64_t RunTable::send(WritingThread& writing) {
  if (rows_.empty()) return bytes_;
  bytes_ += rows_.size();
  const std::size_t size = rows_.size();
  writing.add(size, [path = path_, rows = std::exchange(rows_, {})] { append_bytes(path, rows); });
  return bytes_;
}

void RunTable::send_many(WritingThread& writing) {
  static constexpr std::size_t many = 65536;
  if (rows_.size() >= many) send(writing);
}

}  // namespace dartcast
