// Reads the fields of a scene, and their files sample by sample.
#include "scene/scene_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/checked_file.hpp"
#include "formats/openfoam.hpp"
#include "scene/file_series.hpp"
#include "simulation/scene_field.hpp"

namespace dartcast {

namespace {

void read_table(TomlTable t, const std::filesystem::path& folder, FieldScene& field) {
  t.require("array", "the name of an array of three components");
  t.get("array", field.array);
  if (field.array.empty()) t.fail("array", "array must not be empty");
  FieldPlace at = FieldPlace::points;
  if (t.get("at", at, {{"points", FieldPlace::points}, {"cells", FieldPlace::cells}})) field.at = at;
  t.get("frame", field.frame, {{"space", FieldFrame::space}, {"mesh", FieldFrame::mesh}});
  std::vector<std::string> files;
  if (t.get("files", files) && files.empty()) t.fail("files", "files must not be empty");
  for (const std::string& file : files) field.files.push_back(folder / file);
  const bool times = t.get("times", field.times);
  const bool spacing = t.get("spacing", field.spacing, Range::positive);
  if (times && spacing) t.fail("spacing", "give times or spacing, not both");
  t.get("period", field.period, Range::positive);
  t.get("interpolation", field.interpolation, {{"linear", Interpolation::linear}, {"cubic", Interpolation::cubic}});
  t.finish();
}

// A name, or a table.
void read_field(TomlTable& motion, const char* key, const std::filesystem::path& folder, FieldScene& field) {
  if (motion.is_table(key)) {
    read_table(motion.table(key), folder, field);
  } else {
    motion.get(key, field.array);
    if (is_pattern(field.array))
      motion.fail(key, fmt::format("{0} = \"{1}\": arrays at several times need their times: {0} = {{ array = \"{1}\", "
                                   "spacing = 0.01 }}",
                                   key, field.array));
  }
}

// Calls make(), and puts the file's name before the message of an error unless it is there.
template <class Make>
auto with_file_name(const std::filesystem::path& file, Make&& make) {
  try {
    return make();
  } catch (const InvalidMesh& e) {
    if (std::string_view(e.what()).starts_with(file.string())) throw;
    throw InvalidMesh(fmt::format("{}: {}", file.string(), e.what()));
  }
}

// Reads a field from files of the same mesh as the scene's.
class FieldFiles {
 public:
  FieldFiles(const FieldScene& field, const EnvironmentScene& environment, const MeshData& mesh,
             const ReadOptions& options, std::vector<std::filesystem::path> files)
      : array_(field.array), at_(field.at), options_(options), files_(std::move(files)) {
    points_ = mesh.points.size();
    cells_ = mesh.cell_count();
    if (!environment.skip_bad_cells) return;
    for (std::size_t c = 0; c < cells_; ++c) kept_.push_back(source_of(mesh, c));
    std::sort(kept_.begin(), kept_.end());
  }

  /// The place of the first file's array, from then on that of all.
  FieldPlace find_place() {
    at_ = with_file_name(files_[0], [&] { return field_place(read(0), array_, at_); });
    return *at_;
  }

  [[nodiscard]] std::vector<Vec3> operator()(std::size_t k) const {
    return with_file_name(files_[k], [&] {
      std::vector<Vec3> values = read_values(k);
      const auto bad = std::find_if_not(values.begin(), values.end(), is_finite);
      if (bad != values.end())
        throw InvalidMesh(fmt::format("the array '{}' is not finite at its item {}", array_, bad - values.begin()));
      return values;
    });
  }

  /// The mesh in file k, with its arrays.
  [[nodiscard]] MeshData read(std::size_t k) const {
    MeshFile file = read_mesh(files_[k], options_);
    for (const Finding& warning : file.report.warnings) {
      if (warning.kind == unread_field + array_) throw InvalidMesh(warning.message);
    }
    if (!kept_.empty() && !file.mesh.types.empty()) {
      file.mesh = with_cells_of_scene(std::move(file.mesh));
    } else {
      file = valid_file(std::move(file));
    }
    if (file.mesh.points.size() != points_ || file.mesh.cell_count() != cells_) {
      throw InvalidMesh(
          fmt::format("{}: {} points and {} cells; the scene's mesh has {} and {}: a field's files must "
                      "have the same mesh",
                      files_[k].string(), file.mesh.points.size(), file.mesh.cell_count(), points_, cells_));
    }
    return std::move(file.mesh);
  }

 private:
  static std::uint32_t source_of(const MeshData& mesh, std::size_t c) {
    return mesh.source.empty() ? static_cast<std::uint32_t>(c) : mesh.source[c];
  }

  [[nodiscard]] std::vector<Vec3> read_values(std::size_t k) const {
    // A case has one mesh for all times: its values alone are enough.
    if (at_ == FieldPlace::cells && kept_.empty() && is_openfoam(files_[k]))
      return openfoam_cell_vectors(files_[k], array_, cells_, options_);
    return field_values(read(k), array_, at_);
  }

  // Without the bad cells that the scene has left out, and the points of these.
  [[nodiscard]] MeshData with_cells_of_scene(MeshData all) const {
    MeshData mesh;
    for (const DataArray& a : all.cell_data) mesh.cell_data.push_back({a.name, a.components, {}});
    for (std::size_t c = 0; c < all.cell_count(); ++c) {
      if (!std::binary_search(kept_.begin(), kept_.end(), source_of(all, c))) continue;
      mesh.add_cell(all.types[c], all.cell(c));
      for (std::size_t a = 0; a < all.cell_data.size(); ++a) {
        const DataArray& from = all.cell_data[a];
        const auto first = from.values.begin() + static_cast<std::ptrdiff_t>(c * from.components);
        mesh.cell_data[a].values.insert(mesh.cell_data[a].values.end(), first,
                                        first + static_cast<std::ptrdiff_t>(from.components));
      }
    }
    mesh.points = std::move(all.points);
    mesh.point_data = std::move(all.point_data);
    check_and_repair(mesh);  // drops the points of the other cells
    return mesh;
  }

  std::string array_;
  std::optional<FieldPlace> at_;
  ReadOptions options_;
  std::vector<std::filesystem::path> files_;
  std::size_t points_ = 0;
  std::size_t cells_ = 0;
  std::vector<std::uint32_t> kept_;  // sources of the scene's cells, where it leaves bad ones out
};

// All times are arrays of one file, and are read at once.
void read_arrays_of_file(FieldScene& field, const EnvironmentScene& environment, const MeshData& mesh,
                         const ReadOptions& options) {
  if (field.files.size() != 1)
    throw InvalidArgument(
        fmt::format("the field '{}' has a star for the arrays of one file: name just one", field.array));
  const std::filesystem::path file = field.files.front();
  check_exist(field.files);
  const MeshData read = FieldFiles(field, environment, mesh, options, {file}).read(0);
  field.samples = with_file_name(file, [&] { return field_samples_of(field, read); });
  field.files.clear();
}

}  // namespace

void read_fields(TomlTable& motion, const std::filesystem::path& folder, MotionScene& scene) {
  read_field(motion, "field", folder, scene.field);
  read_field(motion, "force", folder, scene.force);
  const bool has_field = scene.field.given();
  if (motion.is_table("field") && motion.has("field_frame"))
    motion.fail("field_frame", "field_frame belongs to a field that is a name: say frame in the field's table");
  if (motion.get("field_frame", scene.field.frame, {{"space", FieldFrame::space}, {"mesh", FieldFrame::mesh}}) &&
      !has_field) {
    motion.fail("field_frame", "field_frame needs a field");
  }
  motion.get("integrator", scene.integrator, {{"euler", Integrator::euler}, {"rk4", Integrator::rk4}});
  if (scene.integrator == Integrator::rk4) {
    if (!has_field) motion.fail("integrator", "integrator = \"rk4\" needs a field, which the particles follow");
    if (scene.drag != 0.0)
      motion.fail("integrator", "integrator = \"rk4\" is for particles without mass: leave drag out");
    if (scene.substeps != 1)
      motion.fail("integrator", "integrator = \"rk4\" takes a step as one segment: leave substeps out");
  }
  if (scene.force.given() && has_field && scene.drag == 0.0)
    motion.fail("force", "a force has no effect on particles that follow a field without drag: give drag");
}

void load_field(FieldScene& field, const EnvironmentScene& environment, const MeshData& mesh,
                const ReadOptions& options) {
  if (field.files.empty() || field.samples.read) return;
  if (is_pattern(field.array)) return read_arrays_of_file(field, environment, mesh, options);
  FieldSeries series =
      file_series({fmt::format("the field '{}'", field.array), field.array, field.files, field.times, field.spacing});
  check_exist(series.files);
  auto files = std::make_shared<FieldFiles>(field, environment, mesh, options, series.files);
  field.samples.place = files->find_place();
  field.samples.times = std::move(series.times);
  field.samples.period = field.period;
  field.samples.interpolation = field.interpolation;
  field.samples.read = [files](std::size_t k) { return (*files)(k); };
  field.files.clear();
}

}  // namespace dartcast
