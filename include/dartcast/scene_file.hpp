// Scenes in TOML, and the files that scenes name.
#pragma once

#include <filesystem>
#include <string>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/ranks.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

/// Reads a scene. Keys, units and defaults: docs/scene.md. Relative paths in it are taken from the scene's folder.
/// Throws Error with file, line, key and remedy: what is not TOML, an unknown key, a wrong type, a number out of range.
Scene read_scene(const std::filesystem::path& path);

/// The same from text; `path` is for messages and relative paths.
Scene parse_scene(const std::string& text, const std::filesystem::path& path);

/// A scene with its files read.
struct LoadedScene {
  Scene scene;      ///< names no file but frames to read later: a Simulation can be made of it
  Finding skipped;  ///< bad cells that were left out, if the scene wants that
  /// About walls: faces of cyclic patches (walls here), and of named groups between two free cells (none). About surfaces
  /// of which crossing triangles were replaced, and about frames that stand still beside an array of displacements.
  std::vector<Finding> warnings;
};

/// Reads the files that a scene names: its mesh, positions, surfaces of bodies. It reads the first of the deformation's
/// frames and of a field's files, and checks that the others exist. They are read when they are needed. The mesh has
/// its scale, free cells and patches as the scene says, also if it comes from a generator. Only the options
/// `max_memory` and `kept_mesh` have an effect. Throws Error and its kinds, naming the file and its place in the scene.
LoadedScene load_scene_files(Scene scene, const ReadOptions& options = {}, Threads threads = {});

/// The same for ranks that share the scene by cells (Partition::cells). Each gets its part of the mesh, and no rank but
/// the first ever has the whole. A box is made in parts (has_parts()), and a .pvtu file is read in parts
/// (read_mesh_part()): then the first does not have it, either. Other meshes are read or made by the first, which sends
/// each its part. Frames of a deformation are read by all. Throws as load_scene_files(). Throws InvalidArgument if
/// pieces are to be changed in a way that needs the whole: patches by angle or array, bad cells left out. Collective.
LoadedScene load_scene_part(Scene scene, Ranks& ranks, const ReadOptions& options = {}, Threads threads = {});

}  // namespace dartcast
