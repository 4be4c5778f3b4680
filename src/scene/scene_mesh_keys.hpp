// The table [environment] of a scene.
#pragma once

#include <filesystem>

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// Reads [environment]: a mesh file or a generator with its parameters, free cells, patches. Throws as TomlTable.
EnvironmentScene read_environment(TomlTable table, const std::filesystem::path& folder);

}  // namespace dartcast
