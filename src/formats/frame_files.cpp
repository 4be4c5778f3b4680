// Reads frames from mesh files. Only the first is checked as a whole mesh if the others have the same cells.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "formats/file_series.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/openfoam.hpp"
#include "formats/point_file.hpp"
#include "formats/scene_files.hpp"
#include "formats/vtk.hpp"
#include "mesh/same_cells.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

class FrameFiles {
 public:
  FrameFiles(std::vector<fs::path> files, const MeshData* mesh, const CellsOfScene& cells, double scale,
             const ReadOptions& options)
      : files_(std::move(files)),
        points_(mesh != nullptr ? std::optional(mesh->points.size()) : std::nullopt),
        scale_(scale),
        options_{{}, options.max_memory, options.linearise, {}},
        cells_(cells) {
    check_exist(files_);
    read_first();
  }

  /// Names the array of displacements that would move the points, if there is one, and the points stand still.
  [[nodiscard]] Finding unused_displacement() const {
    if (displacement_.empty() || files_.size() < 2) return {};
    try {
      const std::vector<Vec3> first = read(0);
      if (read(files_.size() / 2) != first || read(files_.size() - 1) != first) return {};
    } catch (const Error&) {
      return {};  // the run reports it when it gets there
    }
    return {"unused_displacement",
            files_.size(),
            {},
            fmt::format("frames whose points stand still, from {} on, have the array '{}': displacement = \"{}\" in "
                        "[[deformation]] moves the points by it",
                        files_.front().string(), displacement_, displacement_)};
  }

  [[nodiscard]] std::vector<Vec3> read(std::size_t frame) const {
    try {
      std::vector<Vec3> points;
      if (has_points_alone(files_.at(frame))) {
        points = read_points_alone(files_[frame]);
      } else if (auto same = read_same_cells(files_.at(frame))) {
        points = std::move(*same);
      } else {
        points = read_whole(files_[frame]).points;
      }
      for (Vec3& x : points) x *= scale_;
      return points;
    } catch (const Error& e) {
      throw Error(fmt::format("deformation: frame {} cannot be read: {}", frame, e.what()));
    }
  }

 private:
  // The file as a mesh of its own, checked and repaired.
  [[nodiscard]] MeshData read_whole(const fs::path& file) const {
    MeshData mesh = cells_.mesh_of(read_mesh(file, options_));
    check_count(file, mesh.points.size());
    return mesh;
  }

  void check_count(const fs::path& file, std::size_t points) const {
    if (!points_ || points == *points_) return;
    throw InvalidMesh(fmt::format("{}: {} points; the scene's mesh has {}: frames must have the same points",
                                  file.string(), points, *points_));
  }

  // A .vtp file has no cells of the mesh: its points are the mesh's, in their order.
  static bool has_points_alone(const fs::path& file) { return ending_of(file) == ".vtp"; }
  [[nodiscard]] std::vector<Vec3> read_points_alone(const fs::path& file) const {
    std::vector<Vec3> points = read_points(file, options_).points;
    check_count(file, points.size());
    return points;
  }

  static bool is_displacement(const DataArray& array) {
    std::string name = array.name;
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return array.components == 3 && name.find("disp") != std::string::npos;
  }

  void read_first() {
    if (has_points_alone(files_.front())) {
      points_ = read_points_alone(files_.front()).size();
      return;
    }
    MeshData first = read_whole(files_.front());
    points_ = first.points.size();
    const auto named = std::find_if(first.point_data.begin(), first.point_data.end(), is_displacement);
    if (named != first.point_data.end()) displacement_ = named->name;
    const std::optional<VtuPoints> plain = cells_.are_all() ? read_points_of(files_.front()) : std::nullopt;
    if (!plain || plain->points != first.points) return;
    first_cells_ = plain->cells;
    first_.types = std::move(first.types);
    first_.offsets = std::move(first.offsets);
    first_.connectivity = std::move(first.connectivity);
  }

  [[nodiscard]] std::optional<VtuPoints> read_points_of(const fs::path& file) const {
    if (is_openfoam(file)) {
      return VtuPoints{openfoam_points_at(file, options_), 0};  // all times of a case have the same cells
    }
    if (ending_of(file) != ".vtu") return std::nullopt;
    return read_vtu_points(read_bytes(file), options_.max_memory);
  }

  // The points of a file with the cells of the first; none if it must be checked as a mesh of its own. This second reading
  // finds the words for what is wrong with it.
  [[nodiscard]] std::optional<std::vector<Vec3>> read_same_cells(const fs::path& file) const {
    if (!first_cells_) return std::nullopt;
    try {
      std::optional<VtuPoints> plain = read_points_of(file);
      if (!plain || plain->cells != *first_cells_ || plain->points.size() != *points_ ||
          !stays_valid(first_, plain->points))
        return std::nullopt;
      return std::move(plain->points);
    } catch (const InvalidMesh&) {
      return std::nullopt;
    }
  }

  const std::vector<fs::path> files_;
  std::optional<std::size_t> points_;
  const double scale_;
  const ReadOptions options_;
  const CellsOfScene cells_;
  MeshData first_;                            // cells alone
  std::string displacement_;                  // an array of the first file; empty: it has none
  std::optional<std::uint64_t> first_cells_;  // none: each file is read as a mesh of its own
};

}  // namespace

FrameReader frame_reader(std::vector<fs::path> files, const MeshData* mesh, const CellsOfScene& cells, double scale,
                         const ReadOptions& options, std::vector<Finding>& warnings) {
  const auto all = std::make_shared<const FrameFiles>(std::move(files), mesh, cells, scale, options);
  add_finding(warnings, all->unused_displacement());
  return [all](std::size_t frame) { return all->read(frame); };
}

}  // namespace dartcast
