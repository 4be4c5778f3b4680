// The output folder of a run: frames for ParaView, tables, the scene as run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "dartcast/simulation.hpp"
#include "output/environment_record.hpp"
#include "output/recorder.hpp"

namespace dartcast {

/// Writes particles.pvd with a .vtp per frame, environment.pvd with a .vtu per frame (one if nothing changes),
/// stats.csv, contacts.csv on request, and scene.toml. If ranks share the particles, it is the first rank's, and a frame
/// is made of the pieces that all have written.
class Recording final : public Recorder {
 public:
  struct Options {
    bool changes = false;  ///< the environment: a frame of it at each time
    bool surgery = false;  ///< the table has a column for particles in opened cells
    bool contacts = false;
    std::optional<Compression> compression = {};
    std::uint32_t pieces = 1;              ///< of a frame of particles: one for each rank
    std::uint32_t environment_pieces = 1;  ///< of a frame of the environment, if ranks have parts of it

    [[nodiscard]] Compression of_particles() const { return compression.value_or(Compression::none); }
    [[nodiscard]] Compression of_environment() const { return compression.value_or(Compression::small); }
  };

  /// Makes the folder, or takes over one that is empty or holds an earlier run, whose files are removed. Throws Error,
  /// nothing changed, if the folder holds anything else. `environment`: at rest; if frames show it, its owner lets
  /// it follow edits and cells, and else it is taken.
  ///
  /// A run that goes on takes back what was written after its progress. `environment` has followed the edits so far.
  Recording(const RunFolder& run, Options options, std::optional<EnvironmentRecord>& environment,
            const std::string& scene_text);

  void add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) override;
  void add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) override;
  void save(FilesProgress& progress) override;

 private:
  void write_lists(std::span<const RecordingFrame> frames) const;
  void write_contacts(const Simulation& simulation, const SimulationStep& step);

  Options options_;
  std::optional<EnvironmentRecord>& environment_;
  RunTable stats_;
  RunTable contacts_;
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

/// Makes it if it does not exist. Throws Error if that fails.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace dartcast
