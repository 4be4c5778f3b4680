// Where particles start, and how: `positions` of a scene's particles.
#pragma once

#include <filesystem>

#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// Reads .csv, with the columns x, y, z and, if the file gives them, vx, vy, vz and radius; or .vtp, with the
/// points' arrays velocity (of 3 components) and radius. Other arrays of a run's frames are skipped: id, cell, kind,
/// contacts, held. Only the option `max_memory` has an effect. Throws Error, with the file, if another column or
/// array is in it, or a value is out of range.
ParticleSeeds read_seeds(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dartcast
