// Surfaces in VTK's .vtp, and SimVascular's folders, whose patches are such surfaces.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "dartcast/mesh_files.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/parsed_surface.hpp"

namespace dartcast {

/// The polygons of the file. The cell array patch, else region, else ModelFaceID gives their groups: texts, or whole
/// numbers, of which 0 is none.
ParsedSurface parse_vtp_surface(std::string_view content, std::uint64_t max_memory);

/// Whether the folder is SimVascular's "mesh-complete": it has mesh-surfaces, and a file that ends in .mesh.vtu or one
/// .vtu alone.
bool is_simvascular(const std::filesystem::path& folder);

/// The mesh of such a folder. Each .vtp file in mesh-surfaces is a patch with the file's name. Its points are those of
/// the mesh with the same GlobalNodeID, or at the same place if they have none. Throws InvalidMesh with the file.
ParsedMesh parse_simvascular(const std::filesystem::path& folder, const ReadOptions& options);

}  // namespace dartcast
