// The fields of [motion]: their keys, and the files that they name.
#pragma once

#include <filesystem>
#include <string_view>

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// Reads the keys `field`, `force` and `integrator`, and those that belong to them, after all others of [motion]. Throws
/// Error, with file, line and key.
void read_fields(TomlTable& motion, const std::filesystem::path& folder, MotionScene& scene);

/// Makes samples of the field's files, and reads the first one. The others are read when they are needed; that they
/// exist is checked here. `environment`: with the names of its files. `mesh`: of the scene, loaded. Throws Error and
/// its kinds, naming the file.
void load_field(FieldScene& field, const EnvironmentScene& environment, const MeshData& mesh,
                const ReadOptions& options);

}  // namespace dartcast
