// Surfaces as files. Numbers are written so that they are read back to the bit.
#pragma once

#include <filesystem>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

std::string format_obj(const MeshData& surface);
std::string format_off(const MeshData& surface);
std::string format_ply(const MeshData& surface);
/// Polygons become triangles; points have no numbers.
std::string format_stl(const MeshData& surface);
void write_vtp_surface(const MeshData& surface, const std::filesystem::path& path);

}  // namespace dartcast
