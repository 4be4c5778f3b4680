// Observes a run, and writes its output folder: the recording, and checkpoints beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "output/checkpoint.hpp"
#include "output/environment_record.hpp"
#include "output/recorder.hpp"
#include "output/recording.hpp"
#include "output/run_lock.hpp"
#include "output/writing_thread.hpp"
#include "simulation/particle_share.hpp"

namespace dartcast {

/// Without a folder it does nothing. Every function throws Error if a file cannot be read or written. Frames, tables
/// and checkpoints are written by a thread, and the next function throws its errors. The order is that of the calls, and
/// a checkpoint comes after all that it counts on. A run that is cut off anywhere can go on. If ranks share the
/// particles, each has one, and every function is collective.
class RunOutput {
 public:
  /// Takes the folder, if it exists, before anything is read from it. `scene`: with its files loaded. All outlive it.
  RunOutput(const Scene& scene, const RunOptions& options, Summary& summary);

  /// Reads the checkpoint to go on from; none: the run starts anew.
  void find_checkpoint();
  [[nodiscard]] const std::optional<Checkpoint>& found() const { return found_; }

  /// After each edit of the environment.
  void update_after_edit(const Environment& environment);
  /// Makes the folder, or goes on with the one that there is. `mesh`: the scene's. `simulation`: before the next step.
  void open(MeshSource mesh, const Simulation& simulation);
  /// After each step, before add_frame().
  void add_step(const Simulation& simulation, const SimulationStep& step);
  /// Whether the scene wants a frame after this step.
  [[nodiscard]] bool on_schedule(std::uint64_t step) const { return every_ > 0 && step % every_ == 0; }
  /// Before the first step and after each: a frame and a checkpoint if the scene wants one, and for the last step.
  void add_frame(const Simulation& simulation, bool last);
  /// The size of all that the run will write from now on. After the first frame, before the next step; on the first rank.
  [[nodiscard]] ExpectedOutput expected(const Simulation& simulation) const;
  void finish(const Simulation& simulation);

 private:
  struct Clocked {
    double* seconds;  // that it takes
    std::unique_ptr<Recorder> recorder;
  };

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path file() const { return folder() / "checkpoint.bin"; }
  [[nodiscard]] bool wants_report() const {
    return scene_.output.report && every_ > 0 && recording_options_.environment_pieces == 1;
  }
  void meet() const;
  void add_parts(Checkpoint& checkpoint) const;
  void keep_own(ParticleSystemState& state) const;
  void open_files(const Simulation& simulation);
  void follow_balance(const Simulation& simulation);
  [[nodiscard]] RecordingFrame frame_of(const Simulation& simulation) const;
  void write_part(const Simulation& simulation);
  [[nodiscard]] std::vector<std::uint64_t> written_parts() const;
  void write_frame(const Simulation& simulation);
  void record_frame(const Simulation& simulation);
  void write_cells(const Simulation& simulation) const;
  void finish_files(const Simulation& simulation);
  void write_summary() const;
  void write_report_of_run();

  const Scene& scene_;
  std::filesystem::path folder_;
  Recording::Options recording_options_;
  std::uint64_t every_;
  std::uint64_t steps_;
  bool resume_;
  bool goes_on_ = false;  // it was resumed, and has steps to do
  Threads threads_;
  Ranks* ranks_;
  ParticleShare share_;
  Summary& summary_;
  RunIdentity identity_;
  RunLock lock_;
  std::optional<EnvironmentRecord> record_;  // of the cells that this rank has now; none: no later frame shows it
  std::uint64_t balanced_ = 0;               // how often cells had moved to other ranks when it was made
  std::optional<CellTally> cells_;           // of all ranks, at the last frame
  std::vector<RecordingFrame> frames_;       // on the first rank
  std::optional<Checkpoint> found_;
  std::unique_ptr<WritingThread> writing_;  // before what leaves files to it
  std::vector<Clocked> recorders_;          // on the first rank
};

}  // namespace dartcast
