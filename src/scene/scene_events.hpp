// The [[event]] tables of a scene.
#pragma once

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// Reads one. Throws Error, with file, line and key.
EventScene read_event(TomlTable& t);

}  // namespace dartcast
