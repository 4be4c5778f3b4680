// Puts the parts of a decomposed case together again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "formats/openfoam/poly_mesh.hpp"

namespace dartcast {

/// The mesh that decomposePar has divided, with its labels, from the polyMesh folders of all processors. Zones keep the
/// order of their labels. Throws InvalidMesh, with file and line or byte, if a part cannot be read, or if the
/// parts do not make up a whole.
PolyMesh merged_parts(std::span<const std::filesystem::path> folders, std::uint64_t max_memory);

/// The labels in the whole of a part's points or cells: `name` is pointProcAddressing or cellProcAddressing.
std::vector<std::uint32_t> part_labels(const std::filesystem::path& folder, std::string_view name,
                                       std::uint64_t max_memory);

}  // namespace dartcast
