// The time of whole runs of a scene, by part, of one version of the command or of two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dartcast::bench {

/// One run of a scene by a command.
struct RunSample {
  std::string version;
  std::string scene;
  unsigned threads = 0;
  std::uint64_t steps = 0;
  std::string state_hash;
  double wall = 0.0;       ///< s, from the start of the process to its end
  double processor = 0.0;  ///< s, of all its threads
  /// The seconds of its summary, in their order, by name; and "other", the rest of the wall time.
  std::vector<std::pair<std::string, double>> parts;

  /// The time of a part, or "wall" or "processor". 0 where the run has no such part.
  [[nodiscard]] double seconds(const std::string& part) const;
};

/// Reads the summary that `dartcast run --json` prints. Throws Error where it is none.
RunSample read_sample(const std::string& summary, double wall, double processor);

/// Runs of one scene: by this command, and in turn with them by the other one, where there is one.
struct RunPairs {
  bool output = true;  ///< whether frames were written
  std::vector<RunSample> own;
  std::vector<RunSample> other;  ///< as many, or none

  [[nodiscard]] std::vector<std::string> parts() const;  ///< of all samples, in their order
};

double median_seconds(std::span<const RunSample> samples, const std::string& part);
/// The median, over pairs, of the other one's time over this one's. None where there is no other, or a time is 0.
std::optional<double> median_ratio(const RunPairs& pairs, const std::string& part);

struct RunPartsOptions {
  std::filesystem::path command;       ///< this one
  std::filesystem::path against;       ///< another one; empty: none
  std::filesystem::path scene;         ///< empty: the demo, scenes/vessel.toml
  std::filesystem::path folder;        ///< for the scenes, and for the runs' output
  std::size_t repeat = 3;              ///< > 0: runs of each
  std::optional<std::uint64_t> steps;  ///< instead of the scene's
  unsigned threads = 0;                ///< 0: all that the machine has
};

/// Runs the scene with output, and without: a copy of it in the folder, `every = 0` in place of its own [output]. (A
/// copied scene that names a file must name it by its absolute path.) Throws Error where a command fails.
std::vector<RunPairs> measure_runs(const RunPartsOptions& options);

/// The text of a scene, with this in place of its table [output].
std::string with_output_table(const std::string& scene, const std::string& table);

std::string runs_text(std::span<const RunPairs> runs);
std::string runs_json(std::span<const RunPairs> runs);
/// A waterfall: each part is a bar that starts where the one before it ends. As SVG.
std::string runs_svg(std::span<const RunPairs> runs);

}  // namespace dartcast::bench
