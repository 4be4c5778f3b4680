// Scenes in TOML.
#pragma once

#include <filesystem>
#include <string>

#include "dartcast/scene.hpp"

namespace dartcast {

/// Reads a scene. Keys, units and defaults: docs/scene.md. Relative paths in it are taken from the scene's folder.
/// Throws Error with file, line, key and remedy: what is not TOML, an unknown key, a wrong type, a number out of range.
Scene read_scene(const std::filesystem::path& path);

/// The same from text; `path` is for messages and relative paths.
Scene parse_scene(const std::string& text, const std::filesystem::path& path);

}  // namespace dartcast
