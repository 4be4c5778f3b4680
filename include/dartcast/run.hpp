// Running a scene from its file to its output folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/events.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/ranks.hpp"
#include "dartcast/report.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

// The outcome of a run: summary.json.

/// The statistics of a run in numbers (docs/scene.md).
struct StatisticsSummary {
  StatisticsOptions options;
  double time = 0.0;                          ///< s: of the simulation
  std::uint64_t hit_faces = 0;                ///< wall faces that were hit and that there are at the end
  std::vector<std::uint64_t> hits_by_patch;   ///< by the number of the patch, ended faces included
  std::vector<std::uint64_t> ended_by_patch;  ///< of these, on faces that edits ended
  std::vector<PlaneTotals> planes;            ///< by plane
  std::vector<LeaveTotals> left;              ///< by the number of the patch
  std::vector<LeaveTotals> left_by_class;     ///< likewise, of one class after the other
  ResidenceTimes absorbed_by_edits;
  double seconds = 0.0;  ///< of computing
};

/// The outcome of a run, as in summary.json. Times in s.
struct Summary {
  std::string scene;
  unsigned threads = 1;
  unsigned ranks = 1;  ///< processes that shared the particles
  std::uint64_t steps = 0;
  bool cancelled = false;  ///< the progress callback ended it before its last step
  bool deforms = false;

  std::size_t cells = 0;
  std::size_t free_cells = 0;
  std::size_t vertices = 0;
  std::size_t wall_faces = 0;
  std::size_t bytes = 0;
  Vec3 low, high;               ///< m: of the mesh, before it moves and is edited
  double smallest_edge = 0.0;   ///< m: of its cells
  double mean_edge = 0.0;       ///< m: an edge counts once for each of its cells
  std::uint64_t far_steps = 0;  ///< of particles, over 100 mean edges long; counted in the first step and before frames
  Finding skipped;              ///< bad cells that were left out
  std::vector<Finding> warnings;  ///< LoadedScene::warnings

  bool has_masses = false;  ///< spheres have masses ([collisions]): energies are in J, else in J/kg
  SimulationTotals totals;
  std::uint64_t alive = 0;
  std::uint64_t held = 0;  ///< at the end
  std::uint64_t lost = 0;
  std::vector<std::string> patch_names;
  std::vector<double> patch_areas;  ///< of walls of free cells at the end, in the plane lengths
  double seconds_load = 0.0;
  double seconds_locate = 0.0;
  double seconds_solids = 0.0;          ///< steps of bodies, catheters and solids
  double seconds_write = 0.0;           ///< the steps' thread, with output: copies for it, and waits
  double seconds_writing_thread = 0.0;  ///< the thread that writes files, at the same time as the steps
  double seconds_report = 0.0;          ///< recording for the report, and writing it
  std::optional<ReportSummary> report;  ///< if one was written
  std::optional<EventLog> surgery;      ///< if the scene has events or is remeshed
  std::vector<BodySummary> bodies;
  std::vector<CatheterSummary> catheters;
  std::vector<SolidSummary> solids;
  std::optional<StatisticsSummary> statistics;  ///< if the scene wants any
  std::optional<Audit> audit;
  std::filesystem::path replay;  ///< of the first step that failed the audit; empty: none did, or there is no folder
  std::string state_hash;
};

/// One JSON object. Entries that do not apply to this run are left out. Throws InvalidArgument if there are values for
/// more patches than patch_names has, or for more planes than options.
std::string summary_json(const Summary& summary);

/// The same for people, in a few lines. Throws as summary_json().
std::string summary_text(const Summary& summary);

/// The histogram of orientation tests, a line per number of tests.
std::string histogram_text(const Summary& summary);

/// The library's version, "0.1.0".
std::string version();

// Running a scene from its mesh to its output folder.

/// How a scene is run.
struct RunOptions {
  std::filesystem::path folder;  ///< for the output; empty: none is written
  Threads threads = {};
  std::optional<std::uint64_t> steps;  ///< instead of the scene's
  std::optional<std::uint64_t> seed;   ///< instead of the scene's
  bool audit = false;                  ///< check each particle after each step
  bool skip_bad_cells = false;         ///< as EnvironmentScene::skip_bad_cells, which may be set as well
  /// Go on from the last checkpoint in the folder; from the start if there is none. The outcome is the same as of a
  /// run that was never cut off.
  bool resume = false;
  std::uint64_t max_memory = 0;                               ///< as in ReadOptions, for each file that is read
  std::function<void(std::string_view stage)> on_stage = {};  ///< as in ReadOptions, until the first step
  /// The processes that share the particles (Simulation): all call run_scene() with the same scene and options, and share
  /// the folder. None: one process.
  Ranks* ranks = nullptr;
  /// By cells there are frames of each rank's part of the environment, and no report.
  Partition partition = Partition::particles;
};

/// Called after each step with the number of steps done and of all. Returns whether to go on. If it returns false
/// the run is cancelled: the output folder is complete up to this step, and `resume` can go on from there. If ranks
/// share the run, each calls its own, and one that returns false cancels the run on all.
using Progress = std::function<bool(std::uint64_t done, std::uint64_t all)>;

/// The files that a run will write, about: frames as large as the first one, and a row of stats.csv for each step.
struct ExpectedOutput {
  std::uint64_t every = 0;   ///< steps between two frames; 0: there are no frames
  std::uint64_t frames = 0;  ///< from now on
  std::uint64_t bytes = 0;
};
/// Called once, before the first step; if ranks share the run, by the first alone.
using Announce = std::function<void(const ExpectedOutput&)>;

/// Runs a scene, and reads the files that it names. Throws Error and its kinds if the scene, its mesh or its
/// positions cannot be used, or output cannot be written. Throws RankFailed if another rank has failed. If ranks share
/// the run, the first returns the summary of all.
Summary run_scene(const Scene& scene, const RunOptions& options, const Progress& progress = {},
                  const Announce& announce = {});

// Results for other programs.

/// Writes the particles of a run's frames into an OpenFOAM case, as the cloud of this name. TIME/lagrangian/CLOUD gets
/// positions with their cells, U and origId. OpenFOAM's programs and ParaView read it. Files of an earlier cloud of the
/// same name and time are replaced, and nothing else is changed. Returns the number of frames. Precondition: the run's
/// mesh is that of the case, and was not edited. Throws InvalidArgument if there is no such case, or the name is none;
/// Error if a frame cannot be read or a file cannot be written.
std::size_t write_lagrangian(const std::filesystem::path& run_folder, const std::filesystem::path& openfoam_case,
                             const std::string& cloud = "particles");

/// Writes the source terms of a run's frames as volume fields: TIME/momentum_source (N/m^3) and TIME/energy_source (W/m^3),
/// those of the two that the run has by cell (dartcast/statistics.hpp). Each is of the steps that are summed in the frame
/// (StatisticsOptions::cells_every). Patches get zeroGradient, or their own type where OpenFOAM demands it. Returns the number
/// of frames. Precondition and exceptions: as write_lagrangian(); also Error if the run has no such sums.
std::size_t write_sources(const std::filesystem::path& run_folder, const std::filesystem::path& openfoam_case);

}  // namespace dartcast
