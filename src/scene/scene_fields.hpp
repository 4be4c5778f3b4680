// The keys of the fields of [motion].
#pragma once

#include <filesystem>

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// Reads the keys `field`, `force` and `integrator`, and those that belong to them, after all others of [motion]. Throws
/// Error, with file, line and key.
void read_fields(TomlTable& motion, const std::filesystem::path& folder, MotionScene& scene);

}  // namespace dartcast
