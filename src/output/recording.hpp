// The output folder of a run: frames for ParaView, tables, the scene as run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "output/environment_record.hpp"
#include "output/run_files.hpp"

namespace dartcast {

/// How far a recording has come: enough to go on with its files.
struct RecordingProgress {
  std::uint64_t stats_bytes = 0;
  std::uint64_t contacts_bytes = 0;
  std::vector<RecordingFrame> frames;
};

/// Sums over all ranks, after a step.
struct StepSums {
  std::uint64_t alive = 0;
  SimulationEnergy energy;
};

/// Writes particles.pvd with a .vtp per frame, environment.pvd with a .vtu per frame (one where nothing changes),
/// stats.csv, contacts.csv on request, and scene.toml. Where ranks share the particles, it is the first rank's, and a frame
/// is made of the pieces that all have written. A thread writes what is added, in that order. Its errors are thrown
/// by what adds next. The thread outlives this.
class Recording {
 public:
  struct Options {
    std::filesystem::path folder;
    bool changes = false;  ///< the environment: a frame of it at each time
    bool surgery = false;  ///< the table has a column for particles in opened cells
    bool contacts = false;
    Compression compression = Compression::none;
    std::uint32_t pieces = 1;              ///< of a frame of particles: one for each rank
    std::uint32_t environment_pieces = 1;  ///< of a frame of the environment, where ranks have parts of it
  };

  /// Makes the folder, or takes over one that is empty or holds an earlier run, whose files are removed. Throws Error,
  /// nothing changed, where the folder holds anything else. `record`: of the environment at rest.
  Recording(WritingThread& writing, Options options, EnvironmentRecord record, const std::string& scene_text);

  /// Goes on with the files of an earlier run: what was written to them after `progress` is taken back. Throws Error
  /// where a file is shorter than that. `record`: has followed the edits so far.
  Recording(WritingThread& writing, Options options, EnvironmentRecord record, const RecordingProgress& progress);

  /// Adds the particles, and the environment where it deforms, as they are now.
  void add_frame(const Simulation& simulation);
  /// Where ranks have parts of the environment: `record` is of other cells now.
  void set_environment(EnvironmentRecord record);
  /// To be called after each edit of the environment.
  void update_after_edit(const Environment& environment);
  /// Adds a step's row to stats.csv, and its contacts.
  void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums);
  [[nodiscard]] std::span<const RecordingFrame> frames() const { return frames_; }
  /// Leaves the rows of the tables to the thread, and says how far all will have come then.
  RecordingProgress progress();

 private:
  void write_lists() const;
  void write_contacts(const Simulation& simulation, const SimulationStep& step);

  WritingThread& writing_;
  Options options_;
  std::optional<EnvironmentRecord> environment_;  // where frames show it
  RunTable stats_;
  RunTable contacts_;
  std::vector<RecordingFrame> frames_;
};

/// Whether a frame has the environment: one that stands still and is in pieces is in the first.
bool shows_environment(const Recording::Options& options, const RecordingFrame& frame);

/// Leaves a frame of the environment to the thread, or a rank's piece of it; as write_particles().
XmlDataSet write_environment(WritingThread& writing, const std::filesystem::path& folder, const Simulation& simulation,
                             EnvironmentRecord& record, const RecordingFrame& frame, unsigned piece,
                             Compression compression);

/// Whether a run may write to this folder: it does not exist, is empty, or holds an earlier run. Throws Error that says
/// why not.
void check_output_folder(const std::filesystem::path& folder);

/// Makes it where it does not exist. Throws Error where that fails.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace dartcast
