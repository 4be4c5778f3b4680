// The interface of all that write a run's files step by step. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/simulation.hpp"
#include "output/run_files.hpp"
#include "output/writing_thread.hpp"

namespace dartcast {

/// How far the files of a run have come: enough to go on with them. A file that the run has not got has no bytes.
struct FilesProgress {
  /// A plane's crossings up to the start of an interval.
  struct Plane {
    std::uint64_t forward = 0;
    std::uint64_t backward = 0;
    double ages = 0.0;  ///< s: the sum of residence times at forward crossings
  };

  std::vector<RecordingFrame> frames;
  std::uint64_t stats_bytes = 0;
  std::uint64_t contacts_bytes = 0;
  std::uint64_t bodies_bytes = 0;
  std::uint64_t catheters_bytes = 0;
  std::uint64_t solids_bytes = 0;
  std::uint64_t solid_contacts_bytes = 0;
  std::uint64_t planes_bytes = 0;
  std::uint64_t crossings_bytes = 0;
  std::uint64_t pathlines_bytes = 0;
  double interval_begin = 0.0;  ///< s
  std::vector<Plane> at_begin;
  std::uint64_t report_bytes = 0;
};

/// Sums over all ranks, after a step.
struct StepSums {
  std::uint64_t alive = 0;
  SimulationEnergy energy;
};

/// The folder that a recorder starts in.
struct RunFolder {
  WritingThread& writing;
  std::filesystem::path path;
  const FilesProgress* before = nullptr;  ///< none: the run starts anew

  /// A new table, or the one of the run before. Throws Error if that is shorter than it was.
  [[nodiscard]] RunTable table(std::string_view name, std::string_view header,
                               std::uint64_t FilesProgress::*bytes) const {
    return before != nullptr ? RunTable(path / name, before->*bytes) : RunTable(path / name, header);
  }
};

/// The first rank has them. The thread writes what they add, in that order; they throw its errors. It outlives them.
class Recorder {
 public:
  explicit Recorder(const RunFolder& run) : writing_(run.writing), folder_(run.path) {}
  virtual ~Recorder() = default;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// After each edit of the environment.
  virtual void update_after_edit(const Environment& /*environment*/) {}
  /// After each step, before its frame.
  virtual void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) = 0;
  /// `frames`: of the run, this one the last of them.
  virtual void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) = 0;
  /// Leaves the rows of its tables to the thread, and says how far they will have come then.
  virtual void save(FilesProgress& progress) = 0;
  /// After the last step. A run that goes on takes back what this adds.
  virtual void finish(const Simulation& /*simulation*/) {}

 protected:
  WritingThread& writing_;
  std::filesystem::path folder_;
};

}  // namespace dartcast
