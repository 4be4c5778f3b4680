// The state from which a run can go on: checkpoint.bin in its output folder. If ranks share the particles, each of the
// others has a part, written before it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/ranks.hpp"
#include "output/recorder.hpp"
#include "simulation/simulation_state.hpp"

namespace dartcast {

/// The run that a state belongs to: it can go on only if all of this is the same.
struct RunIdentity {
  std::string version;      ///< of the library: other versions may round elsewhere
  std::uint64_t scene = 0;  ///< digest of the scene's text
  std::uint64_t mesh = 0;   ///< sum of the digests of the cells, with their numbers, corners and free marks
  std::uint64_t seed = 0;
};
RunIdentity run_identity(const std::string& scene_text, const MeshData& mesh, std::uint64_t seed);
/// The same of the whole mesh, whose parts the ranks have. Collective.
RunIdentity run_identity(const std::string& scene_text, const MeshPart& part, Ranks& ranks, std::uint64_t seed);

struct Checkpoint {
  RunIdentity run;
  std::uint64_t every = 0;  ///< steps between two frames
  SimulationState simulation;
  FilesProgress files;
  std::uint64_t held = 0;  ///< in the last step
  std::uint64_t audited = 0;
  std::vector<std::uint64_t> parts;  ///< digests of the files of the other ranks, which hold their particles
};

/// Writes the file beside its place and then puts it there: whenever a run is cut off, a whole checkpoint is left.
/// Throws Error if it cannot be written. `checkpoint`: stays as it is, although the list of its fields, which is one
/// for reading and writing, does not say so.
void write_checkpoint(const std::filesystem::path& path, Checkpoint& checkpoint);

/// Writes what a rank but the first adds to the checkpoint: its particles and their sums. Returns the file's digest.
/// Throws Error if it cannot be written.
std::uint64_t write_checkpoint_part(const std::filesystem::path& path, ParticleSystemState& part);

/// Throws Error if there is no such file, or it is damaged or has another digest.
ParticleSystemState read_checkpoint_part(const std::filesystem::path& path, std::uint64_t digest);

/// None if there is no such file. Throws Error if it is damaged, or of a run that differs from `run`: says in
/// what.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path, const RunIdentity& run);

}  // namespace dartcast
