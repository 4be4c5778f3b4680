// Any file of a surface in space: read, repaired and judged.
#pragma once

#include <filesystem>

#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Whether the ending is one of those that check_surface() reads.
bool is_surface_file(const std::filesystem::path& path);

/// Reads .stl (ASCII, binary), .obj, .ply (ASCII, binary) or .off, by ending and content, and inspects it as
/// check_and_repair_surface() does. Nothing in the file makes this throw: what cannot be read is a defect of kind
/// "file" in the report, with line or byte. Points keep their order and those that no face uses are kept, so that the
/// positions of another file of the same faces can be handed to Surface::move(); of .stl see formats/stl.hpp. Of the
/// options `max_memory` counts. Cost: n log n; a few times the file's size in memory.
MeshFile check_surface(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same, but throws InvalidMesh, with the file's name, the first defect and its first faces, where the surface is
/// refused: `Surface(read_surface(path).mesh)`.
MeshFile read_surface(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dartcast
