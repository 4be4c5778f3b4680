// The files of a run's statistics. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "output/recorder.hpp"

namespace dartcast {

/// Writes the files that the scene wants. Walls are in walls.pvd, with a .vtp per frame. A row of planes.csv is a plane
/// and an interval between frames, one of crossings.csv a crossing. Points are added to pathlines.bin; from it comes
/// pathlines.vtp at the end.
class StatisticsRecording final : public Recorder {
 public:
  StatisticsRecording(const RunFolder& run, const Scene& scene, std::uint64_t every);

  void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) override;
  void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) override;
  void save(FilesProgress& progress) override;
  /// Adds the rows of a last, shorter interval, and makes pathlines.vtp.
  void finish(const Simulation& simulation) override;

 private:
  void add_crossings(const Simulation& simulation);
  void end_interval(const Simulation& simulation);

  std::uint64_t every_;
  Compression compression_;
  StatisticsScene scene_;
  RunTable planes_;
  RunTable crossings_;
  RunTable pathlines_;
  double interval_begin_ = 0.0;
  std::vector<FilesProgress::Plane> at_begin_;
};

}  // namespace dartcast
