// Records what a report shows, while a run goes on: report.bin. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "output/recorder.hpp"
#include "report/recorded.hpp"

namespace dartcast {

/// Which particles a frame shows, and how points are kept.
struct ReportView {
  RecordedHeader header;
  std::uint64_t stride = 1;
};

/// The particles of a view, of all ranks. Collective; the view is the first rank's.
RecordedFrame reported_particles(const Simulation& simulation, const ReportView& view);

/// Records particles whose id is a multiple of a stride: the smallest power of two with which at most 20,000 are left.
/// It grows with the number of ids. Cost: some 30 bytes for each of these particles in each frame, 32 for each contact.
class ReportRecording final : public Recorder {
 public:
  /// The simulation outlives it, and is in the state that the run goes on from. `goes_on`: the run before has not done
  /// all steps.
  ReportRecording(const RunFolder& run, std::uint64_t every, const Simulation& simulation, bool goes_on);

  void update_after_edit(const Environment& environment) override;
  void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) override;
  /// Collective: the other ranks call reported_particles() with any view.
  void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) override;
  void save(FilesProgress& progress) override;

 private:
  [[nodiscard]] ReportView next_view(const Simulation& simulation);
  void add_arrivals(const Simulation& simulation, double time);
  void add_walls(const Simulation& simulation);
  [[nodiscard]] std::vector<RecordedPoint> wall_points(const Environment& environment) const;
  [[nodiscard]] const WallHits& hits(const Simulation& simulation) const;
  void restore(const std::filesystem::path& path, const Simulation& simulation, bool goes_on);
  void restore_hits(const Simulation& simulation, const RecordedFrame& frame);
  void count_hits();

  const Simulation& simulation_;
  RunTable file_;
  RecordedHeader header_;
  std::uint64_t stride_ = 1;
  WallHits own_hits_;  // if the simulation keeps none
  bool counts_hits_;
  std::uint64_t counted_;  // steps whose hits it has
  bool has_walls_ = false;
  std::uint64_t edits_ = 0;      // those that the last walls have
  std::size_t events_ = 0;       // of the log, that the file has
  std::uint64_t ids_ = 0;        // below it particles are known to have come
  std::vector<CellFace> faces_;  // of the last walls
  std::vector<Vertex> wall_vertices_;
  std::vector<RecordedPoint> wall_points_;  // as the file has them with the walls
};

}  // namespace dartcast
