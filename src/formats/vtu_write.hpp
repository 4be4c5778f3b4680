// A mesh as a .vtu file, and as its arrays.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "dartcast/mesh_data.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// The field array that names the program which wrote the cell array `free`: "dartcast". Other programs may have an array
/// of that name, with another meaning.
inline constexpr const char* free_writer = "free_written_by";

/// The field array of MeshData::baffle_tags, as texts.
inline constexpr const char* baffle_patches = "baffle_patches";

/// The field arrays that write_vtu() writes as bytes, texts that are each ended by a 0.
inline constexpr std::array<std::string_view, 4> arrays_of_texts = {free_writer, baffle_patches, "region_names",
                                                                    "patch_names"};

/// Cells, patch faces and data as write_vtu() writes them. Arrays that stand in the mesh as in the file are not copied:
/// the mesh stays as it is while the data set is used.
XmlDataSet vtu_data_set(const std::shared_ptr<const MeshData>& mesh);

/// The points' array, for a data set of other positions.
XmlArray vtu_points(std::span<const Vec3> points, std::shared_ptr<const void> owner);

/// Writes cells, patch faces and arrays so that a reader of .vtu finds the same bits. `free`, the regions and the patches
/// become the cell arrays `free`, `region` and `patch`, in place of cell arrays of these names. With `free` stands the field
/// array free_writer. Names of regions and patches, and the tags of baffles, are field arrays. The bytes are raw. Throws Error if the file cannot be written.
void write_vtu(const MeshData& mesh, const std::filesystem::path& path);

/// Whether `free`, the regions or the patches replace a cell array of this name.
bool is_replaced(const MeshData& mesh, const std::string& cell_array);

}  // namespace dartcast
