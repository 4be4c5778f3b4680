// Meshes in pieces: .pvtu files. Not installed.
#pragma once

#include <filesystem>
#include <string_view>

#include "dartcast/mesh_files.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// All pieces, as the whole mesh. Throws InvalidMesh.
ParsedMesh read_pieces(const std::filesystem::path& path, std::string_view content, const ReadOptions& options);

}  // namespace dartcast
