// Points from VTK's .vtp files.
#pragma once

#include <filesystem>

#include "formats/point_file.hpp"

namespace dartcast {

/// Reads the points and their numeric arrays. The option `max_memory` counts, the other does not. Throws Error with the
/// file's name.
PointFile read_vtp(const std::filesystem::path& path, const ReadOptions& options);

/// The faces of a .vtp file. Throws InvalidMesh.
VtpFaces read_vtp_faces(std::string_view content, std::uint64_t max_memory);

}  // namespace dartcast
