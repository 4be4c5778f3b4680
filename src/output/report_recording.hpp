// Records what a report shows, while a run goes on: report.bin. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "output/run_files.hpp"
#include "report/recorded.hpp"

namespace dartcast {

/// How far it has come: enough to go on.
struct ReportProgress {
  std::uint64_t bytes = 0;
};

/// Which particles a frame shows, and how points are kept.
struct ReportView {
  RecordedHeader header;
  std::uint64_t stride = 1;
};

/// The particles of a view, of all ranks. Collective; the view is the first rank's.
RecordedFrame reported_particles(const Simulation& simulation, const ReportView& view);

/// Records particles whose id is a multiple of a stride: the smallest power of two with which at most 20,000 are left.
/// It grows with the number of ids. Cost: some 30 bytes for each of these particles in each frame, 32 for each contact.
class ReportRecording {
 public:
  /// A new file. The simulation outlives it.
  ReportRecording(WritingThread& writing, const std::filesystem::path& folder, const Scene& scene,
                  const Simulation& simulation);
  /// Goes on with the file of an earlier run. `simulation`: as above, in the state of the checkpoint. `goes_on`: it has
  /// steps to do.
  ReportRecording(WritingThread& writing, const std::filesystem::path& folder, const Simulation& simulation,
                  const ReportProgress& progress, bool goes_on);

  /// After each edit of the environment.
  void update_after_edit(const Environment& environment);
  /// After each step.
  void add_step(const Simulation& simulation, const SimulationStep& step);
  /// Which particles the next frame shows.
  [[nodiscard]] ReportView next_view(const Simulation& simulation);
  /// `frame`: with the particles of that view.
  void add_frame(const Simulation& simulation, RecordedFrame frame);
  ReportProgress progress();

 private:
  void add_arrivals(const Simulation& simulation, double time);
  void add_walls(const Simulation& simulation);
  [[nodiscard]] std::vector<RecordedPoint> wall_points(const Environment& environment) const;
  [[nodiscard]] const WallHits& hits(const Simulation& simulation) const;
  void restore(const std::filesystem::path& path, const Simulation& simulation, bool goes_on);
  void restore_hits(const Simulation& simulation, const RecordedFrame& frame);
  void count_hits();

  WritingThread& writing_;
  const Simulation& simulation_;
  RunTable file_;
  RecordedHeader header_;
  std::uint64_t stride_ = 1;
  WallHits own_hits_;  // where the simulation keeps none
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
