// The folders of an OpenFOAM case: where its mesh is, and what there is at its times.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"
#include "formats/openfoam/foam_field.hpp"
#include "formats/openfoam/poly_mesh.hpp"

namespace dartcast {

/// Whether a case has its parts in one folder, as processors4: the collated format.
bool is_collated(const std::filesystem::path& root);

/// A time's folder.
struct FoamTime {
  double time = 0.0;
  std::string name;  ///< as "0.25"
};

/// A case, or a polyMesh folder alone.
class FoamCase {
 public:
  /// The case that a path names; see is_openfoam(). None if it names none.
  static std::optional<FoamCase> find(const std::filesystem::path& path);

  /// Whether the path names a time of the case.
  [[nodiscard]] bool names_time() const { return names_time_; }
  /// Whether the path is a polyMesh folder.
  [[nodiscard]] bool is_folder_alone() const { return folder_alone_; }
  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  /// Folders of processors; none if the case has a mesh of its own.
  [[nodiscard]] const std::vector<std::filesystem::path>& parts() const { return parts_; }

  /// All times, increasing. Throws InvalidMesh if the mesh changes its faces at one.
  [[nodiscard]] std::vector<FoamTime> times() const;
  /// Whether the time's folder, or that of each processor, has the file: "U", "polyMesh/points".
  [[nodiscard]] bool has(std::string_view time, std::string_view file) const;

  /// The mesh, with the points of the path's time.
  [[nodiscard]] PolyMesh read(std::uint64_t max_memory) const;
  /// The points at the path's time: of its folder, else of the last one before that has points.
  [[nodiscard]] std::vector<Vec3> points(std::uint64_t max_memory) const;
  /// The time of these points: "constant", or the name of its folder.
  [[nodiscard]] std::string time_of_points() const;

  /// A field's values in the order of cells or points, `components` each.
  struct Field {
    std::string name;
    bool at_cells = true;
    std::size_t components = 1;
    std::vector<double> values;
    FoamFaceValues faces;  ///< in no order; only if they are wanted
  };
  /// The field at the path's time, of a mesh of so many cells and points. None if there is no such file, or its class
  /// is not one of fields at cells or points.
  [[nodiscard]] std::optional<Field> field(std::string_view name, std::size_t cells, std::size_t points,
                                           std::uint64_t max_memory, bool with_faces = false) const;
  /// The names of all files in the path's time.
  [[nodiscard]] std::vector<std::string> files() const;

 private:
  [[nodiscard]] std::filesystem::path folder_of(std::string_view time) const { return root_ / time; }
  [[nodiscard]] std::vector<std::filesystem::path> mesh_folders() const;

  std::filesystem::path root_;
  std::filesystem::path mesh_;     // the polyMesh folder; of the processors' folders if these are the case
  std::string time_ = "constant";  // or a time's name
  bool names_time_ = false;
  bool folder_alone_ = false;
  std::vector<std::filesystem::path> parts_;       // the case's mesh, if root has none
  std::vector<std::filesystem::path> processors_;  // all, also if root has a mesh
};

}  // namespace dartcast
