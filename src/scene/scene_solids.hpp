// The [[body]], [[catheter]] and [[solid]] tables of a scene.
#pragma once

#include <filesystem>

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// Read one each. `number`: its place among its kind, from 1, for a name if none is given. Throw Error, with file,
/// line and key.
BodyScene read_body(TomlTable& t, const std::filesystem::path& folder, std::size_t number, std::uint64_t seed);
CatheterScene read_catheter(TomlTable& t, std::size_t number);
SolidScene read_solid(TomlTable& t, const std::filesystem::path& folder, std::size_t number);

}  // namespace dartcast
