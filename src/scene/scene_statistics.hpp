// Reads the statistics that a scene wants. Not installed.
#pragma once

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// The table [statistics]. Throws Error as TomlTable's functions.
StatisticsScene read_statistics(TomlTable t);

}  // namespace dartcast
