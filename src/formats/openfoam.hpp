// OpenFOAM's cases: meshes of polyMesh folders, their times and fields. formats/openfoam has the functions.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/vec3.hpp"
#include "formats/file_series.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// Whether the path is a case, or a part of one. It may be its folder, a file in it that ends in .foam, or a polyMesh
/// folder. It may also be CASE/TIME, which need not exist if the processors' folders have it.
bool is_openfoam(const std::filesystem::path& path);

/// Whether the path is a case itself: its folder, or a file in it that ends in .foam.
bool is_openfoam_case(const std::filesystem::path& path);

/// The kind of a warning about a field that cannot be read, before its name.
inline const std::string unread_field = "field ";

/// The mesh of a case, of constant/polyMesh or else put together from the processors' folders. The mesh of CASE/TIME
/// has the points of that time, and its fields at cells and points as arrays. Zones of cells become regions. Patches
/// keep their names; so do zones of faces, for faces that are in no patch. A mesh of one layer between patches of the
/// type `empty` becomes a mesh of the plane. Cells and faces keep their labels as sources. A field that cannot be read
/// is left out with a warning. Throws InvalidMesh, with file and line, or byte, if the content is not right or cannot
/// be used.
ParsedMesh parse_openfoam(const std::filesystem::path& path, const ReadOptions& options);

/// The times of a case with points, as paths CASE/TIME; before them CASE/constant at 0 if no other is at 0 or before.
/// Throws InvalidMesh if there is none, or the mesh changes its faces at a time.
FieldSeries openfoam_points(const std::filesystem::path& path);

/// The times of a case with a field, as paths CASE/TIME. Throws likewise.
FieldSeries openfoam_field(const std::filesystem::path& path, std::string_view field);

/// Whether system/fvSchemes of a case says `ddtSchemes { default steadyState; }`: its times are then iterations. False
/// if the file is missing or says nothing of the kind.
bool is_steady_openfoam(const std::filesystem::path& path);

/// The points of CASE/TIME in a mesh of space, by label, as the file has them. Throws as parse_openfoam().
std::vector<Vec3> openfoam_points_at(const std::filesystem::path& path, const ReadOptions& options);

/// A vector field at the cells of CASE/TIME, by label. Throws likewise, and if there is none or it has not as many
/// values.
std::vector<Vec3> openfoam_cell_vectors(const std::filesystem::path& path, std::string_view field, std::size_t cells,
                                        const ReadOptions& options);

/// The number of cells of a case, and its patches.
struct OpenFoamSizes {
  struct Patch {
    std::string name;
    std::string type;  ///< as "wall", "empty"
  };
  std::size_t cells = 0;
  std::vector<Patch> patches;
};
/// Throws as parse_openfoam().
OpenFoamSizes openfoam_sizes(const std::filesystem::path& path, const ReadOptions& options);

/// Vector fields of a case at the points of its mesh, time by time.
///
/// Fields at cells are brought there with the points of their time (mesh/point_weights.hpp). If the field's file gives
/// values to faces at a point, these alone count. The point gets their mean, weighted with inverse distances, but 0 if
/// one of them is 0, as at a wall without slip. Weights are kept as long as the points stay.
class OpenFoamPointVectors {
 public:
  /// The field of CASE/TIME, in the order of parse_openfoam()'s points. Throws likewise, and if there is no such field.
  std::vector<Vec3> operator()(const std::filesystem::path& path, std::string_view field, const ReadOptions& options);

 private:
  struct AtTime;
  std::shared_ptr<const AtTime> last_;
};

}  // namespace dartcast
