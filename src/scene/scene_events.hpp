// The [[event]] tables of a scene.
#pragma once

#include "scene/toml_table.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// Reads one. Throws Error, with file, line and key.
EventScene read_event(TomlTable& t);

}  // namespace dartcast
