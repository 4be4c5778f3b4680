// The files of a run's statistics. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "output/run_files.hpp"
#include "output/writing_thread.hpp"

namespace dartcast {

/// How far it has come: enough to go on with its files.
struct StatisticsProgress {
  /// A plane's crossings up to the start of an interval.
  struct Plane {
    std::uint64_t forward = 0;
    std::uint64_t backward = 0;
    double ages = 0.0;  ///< s: the sum of residence times at forward crossings
  };

  std::uint64_t planes_bytes = 0;
  std::uint64_t crossings_bytes = 0;
  std::uint64_t pathlines_bytes = 0;
  double interval_begin = 0.0;  ///< s
  std::vector<Plane> at_begin;
};

/// Writes what the scene wants: walls.pvd with a .vtp per frame; planes.csv, a row per plane and interval between
/// frames; crossings.csv, a row per crossing; pathlines.bin, to which points are added, and from it pathlines.vtp at the
/// end. A thread writes what is added, in that order. Its errors are thrown by what adds next. The thread outlives this.
class StatisticsRecording {
 public:
  /// The folder is there, and belongs to the run.
  StatisticsRecording(WritingThread& writing, std::filesystem::path folder, const Scene& scene);
  /// Goes on with the files of an earlier run. Throws Error where one is shorter than it was.
  StatisticsRecording(WritingThread& writing, std::filesystem::path folder, const Scene& scene,
                      const StatisticsProgress& progress);

  void add_step(const Simulation& simulation);
  /// `frames`: of the run, this one the last of them.
  void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames);
  /// Adds the rows of the interval that ends now.
  void end_interval(const Simulation& simulation);
  /// Leaves what there is to the thread, and says how far it will have come then.
  StatisticsProgress progress();
  /// Adds the rows of a last, shorter interval, and makes pathlines.vtp. A run that goes on takes both back.
  void finish(const Simulation& simulation);

 private:
  void add_crossings(const Simulation& simulation);

  WritingThread& writing_;
  std::filesystem::path folder_;
  Compression compression_;
  StatisticsScene scene_;
  RunTable planes_;
  RunTable crossings_;
  RunTable pathlines_;
  double interval_begin_ = 0.0;
  std::vector<StatisticsProgress::Plane> at_begin_;
};

}  // namespace dartcast
