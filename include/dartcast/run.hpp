// Running a scene from its mesh to its output folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "base/parallel.hpp"
#include "dartcast/scene.hpp"
#include "output/summary.hpp"

namespace dartcast {

struct RunOptions {
  std::filesystem::path folder;  ///< for the output; empty: none is written
  Threads threads = {};
  std::optional<std::uint64_t> steps;  ///< instead of the scene's
  std::optional<std::uint64_t> seed;   ///< instead of the scene's
  bool audit = false;                  ///< check each particle after each step
  bool skip_bad_cells = false;         ///< as EnvironmentScene::skip_bad_cells, which may be set as well
  /// Go on from the last checkpoint in the folder; from the start where there is none. The outcome is that of a run
  /// that was never cut off.
  bool resume = false;
  std::uint64_t max_memory = 0;  ///< as of ReadOptions, for each file that is read
};

/// Called after each step with the number of steps done and of all.
using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// Runs a scene. Throws Error and its kinds where the scene, its mesh or its positions cannot be used, or output cannot
/// be written.
Summary run_scene(const Scene& scene, const RunOptions& options, const Progress& progress = {});

}  // namespace dartcast
