// Reads a field's files, sample by sample.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_series.hpp"
#include "formats/openfoam.hpp"
#include "formats/scene_files.hpp"
#include "simulation/mesh_arrays.hpp"
#include "simulation/series.hpp"

namespace dartcast {

namespace {

// Reads a field from files of the same mesh as the scene's; null: as the first file's.
class FieldFiles {
 public:
  FieldFiles(const FieldScene& field, const MeshData* mesh, const CellsOfScene& cells, const ReadOptions& options,
             std::vector<std::filesystem::path> files)
      : array_(field.array), at_(field.at), options_(options), files_(std::move(files)), cells_(cells) {
    if (mesh != nullptr) sizes_ = {mesh->points.size(), mesh->cell_count()};
    if (at_ != FieldPlace::cells) options_.point_fields = {array_};
  }

  /// The place of the first file's array, from then on that of all.
  FieldPlace find_place() {
    at_ = with_file_name(files_[0].string(), [&] { return field_place(read(0), array_, at_); });
    return *at_;
  }

  [[nodiscard]] std::vector<Vec3> operator()(std::size_t k) {
    return with_file_name(files_[k].string(), [&] {
      std::vector<Vec3> values = read_values(k);
      const auto bad = std::find_if_not(values.begin(), values.end(), is_finite);
      if (bad != values.end())
        throw InvalidMesh(fmt::format("the array '{}' is not finite at its item {}", array_, bad - values.begin()));
      return values;
    });
  }

  /// The mesh in file k, with its arrays.
  [[nodiscard]] MeshData read(std::size_t k) {
    MeshFile file = read_mesh(files_[k], options_);
    for (const Finding& warning : file.report.warnings) {
      if (warning.kind == unread_field + array_) throw InvalidMesh(warning.message);
    }
    MeshData mesh = cells_.mesh_of(std::move(file));
    if (!sizes_) sizes_ = {mesh.points.size(), mesh.cell_count()};
    if (mesh.points.size() != sizes_->points || mesh.cell_count() != sizes_->cells) {
      throw InvalidMesh(
          fmt::format("{}: {} points and {} cells; the scene's mesh has {} and {}: a field's files must "
                      "have the same mesh",
                      files_[k].string(), mesh.points.size(), mesh.cell_count(), sizes_->points, sizes_->cells));
    }
    return mesh;
  }

 private:
  [[nodiscard]] std::vector<Vec3> read_values(std::size_t k) {
    // A case has one mesh for all times: its values alone are enough, unless points have been dropped.
    if (cells_.are_all() && is_openfoam(files_[k])) {
      if (at_ == FieldPlace::cells) return openfoam_cell_vectors(files_[k], array_, sizes_->cells, options_);
      std::vector<Vec3> values = to_points_(files_[k], array_, options_);
      if (values.size() == sizes_->points) return values;
    }
    return field_values(read(k), array_, at_);
  }

  std::string array_;
  std::optional<FieldPlace> at_;
  ReadOptions options_;
  std::vector<std::filesystem::path> files_;
  struct Sizes {
    std::size_t points, cells;
  };
  std::optional<Sizes> sizes_;
  CellsOfScene cells_;
  OpenFoamPointVectors to_points_;
};

// Reads arrays that particles take, from the files of a field. All parts of an array come from one reading.
class SampledFiles {
 public:
  SampledFiles(FieldFiles files, std::string array, std::optional<FieldPlace> at)
      : files_(std::move(files)), array_(std::move(array)), at_(at) {}

  const ArrayInMesh& operator()(std::size_t k) {
    if (!last_ || at_sample_ != k) last_ = array_in_mesh(files_.read(k), array_, at_);
    at_sample_ = k;
    return *last_;
  }

 private:
  FieldFiles files_;
  std::string array_;
  std::optional<FieldPlace> at_;
  std::optional<ArrayInMesh> last_;
  std::size_t at_sample_ = 0;
};

ArraySamples sampled_files(const FieldScene& field, const MeshData* mesh, const CellsOfScene& cells,
                           const ReadOptions& options, const std::vector<std::filesystem::path>& names) {
  auto files = std::make_shared<SampledFiles>(FieldFiles(field, mesh, cells, options, names), field.array, field.at);
  const ArrayInMesh& first = (*files)(0);
  ArraySamples samples{field.array, first.components, {}};
  for (std::size_t part = 0; 3 * part < samples.components; ++part) {
    FieldSamples& s = samples.parts.emplace_back();
    s.place = first.place;
    s.vectors = false;
    s.read = [files, part, count = first.components, place = first.place, names](std::size_t k) {
      const ArrayInMesh& read = (*files)(k);
      if (read.components != count || read.place != place)
        throw InvalidMesh(fmt::format("{}: the array has other components or another place than in the first file",
                                      names[k].string()));
      return three_components(read, part);
    };
  }
  return samples;
}

// All times are arrays of one file, and are read at once.
void read_arrays_of_file(FieldScene& field, const MeshData* mesh, const CellsOfScene& cells,
                         const ReadOptions& options) {
  if (field.files.size() != 1)
    throw InvalidArgument(
        fmt::format("the field '{}' has a star for the arrays of one file: name just one", field.array));
  const std::filesystem::path file = field.files.front();
  check_exist(field.files);
  const MeshData read = FieldFiles(field, mesh, cells, options, {file}).read(0);
  field.samples = with_file_name(file.string(), [&] { return field_samples_of(field, read); });
  field.files.clear();
}

}  // namespace

void read_field_files(FieldScene& field, const MeshData* mesh, const CellsOfScene& cells, const ReadOptions& options,
                      const std::vector<std::string>& sample, std::vector<ArraySamples>& sampled) {
  if (field.files.empty() || field.samples.read) return;
  if (is_pattern(field.array)) {
    if (!sample.empty())
      throw InvalidArgument(
          fmt::format("sample: the field '{}' is several arrays of a file, which have no others at "
                      "their times: give it a file for each time",
                      field.array));
    return read_arrays_of_file(field, mesh, cells, options);
  }
  const bool of_case = field.files.size() == 1 && is_openfoam_case(field.files.front());
  const bool steady = field.steady.value_or(of_case && is_steady_openfoam(field.files.front()));
  FieldSeries series = file_series({fmt::format("the field '{}'", field.array), field.array, field.files, field.times,
                                    steady && !of_case ? 1.0 : field.spacing});
  if (steady) series = {{series.files.back()}, {0.0}};
  check_exist(series.files);
  auto files = std::make_shared<FieldFiles>(field, mesh, cells, options, series.files);
  field.samples.place = files->find_place();
  field.samples.times = std::move(series.times);
  field.samples.period = field.period;
  field.samples.interpolation = field.interpolation;
  field.samples.read = [files](std::size_t k) { return (*files)(k); };
  for (const std::string& array : sample) {
    FieldScene other = field;
    other.array = array;
    ArraySamples& samples = sampled.emplace_back(sampled_files(other, mesh, cells, options, series.files));
    for (FieldSamples& s : samples.parts) {
      s.name = fmt::format("the sampled array '{}'", array);
      s.times = field.samples.times;
      s.period = field.period;
      s.interpolation = field.interpolation;
    }
  }
  field.files.clear();
}

FrameReader displaced_frames(DeformationScene& scene, const MeshData& mesh, const CellsOfScene& cells, double scale,
                             const ReadOptions& options) {
  FieldScene field;
  field.array = scene.displacement;
  field.at = FieldPlace::points;
  field.files = std::exchange(scene.frames, {});
  field.times = scene.step.times;
  field.spacing = scene.spacing;
  field.steady = false;
  std::vector<ArraySamples> none;
  try {
    read_field_files(field, &mesh, cells, options, {}, none);
  } catch (const Error& e) {
    throw InvalidMesh(fmt::format("deformation: the displacement '{}': {}", scene.displacement, e.what()));
  }
  scene.step.times = field.samples.times;
  return [read = std::move(field.samples.read), rest = mesh.points, scale](std::size_t frame) {
    std::vector<Vec3> points = read(frame);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = rest[i] + points[i] * scale;
    return points;
  };
}

}  // namespace dartcast
