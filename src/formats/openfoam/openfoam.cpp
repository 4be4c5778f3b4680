// A case as a mesh, as frames of a deformation, and as a field at several times.
#include "formats/openfoam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/openfoam/foam_case.hpp"
#include "formats/openfoam/foam_file.hpp"
#include "formats/openfoam/poly_cells.hpp"
#include "mesh/point_weights.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

FoamCase case_of(const fs::path& path) {
  if (auto found = FoamCase::find(path)) return std::move(*found);
  if (is_collated(path))
    throw InvalidMesh(
        "the case has its parts in one folder (the collated format), which is not read: run "
        "reconstructParMesh -constant, or decomposePar without -fileHandler collated");
  throw InvalidMesh(
      "this folder is no case of OpenFOAM: there is neither constant/polyMesh/faces nor "
      "processor0/constant/polyMesh");
}

/// The values of items that the mesh has kept, or of all.
std::vector<double> selected(std::vector<double> values, std::size_t components,
                             const std::vector<std::uint32_t>& kept) {
  if (kept.empty()) return values;
  std::vector<double> out;
  for (const std::uint32_t i : kept) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i * components);
    out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(components));
  }
  return out;
}

/// Brings fields at the cells of a mesh, as parsed, to its points. Those on faces of patches that have values take these
/// alone.
class CellsToPoints {
 public:
  explicit CellsToPoints(const MeshData& mesh)
      : of_cells_(weights_of_cells(mesh)), of_faces_(weights_of_patch_faces(mesh)), labels_(mesh.patch_source) {}

  [[nodiscard]] std::vector<double> operator()(const FoamCase::Field& field) const {
    std::vector<double> values = values_at_points(of_cells_, field.values, field.components);
    const std::vector<const double*> faces = values_of_faces(field);
    std::vector<double> sum(field.components);
    for (std::size_t p = 0; p < of_faces_.points(); ++p) {
      if (is_known(faces, field.components, p, sum))
        std::copy(sum.begin(), sum.end(), values.begin() + static_cast<std::ptrdiff_t>(p * field.components));
    }
    return values;
  }

 private:
  // The values on each patch face; null: it has none.
  [[nodiscard]] std::vector<const double*> values_of_faces(const FoamCase::Field& field) const {
    std::unordered_map<std::uint32_t, const double*> known;
    for (std::size_t i = 0; i < field.faces.faces.size(); ++i)
      known.emplace(field.faces.faces[i], &field.faces.values[i * field.components]);
    std::vector<const double*> values(labels_.size(), nullptr);
    for (std::size_t f = 0; f < labels_.size() && !known.empty(); ++f) {
      if (const auto found = known.find(labels_[f]); found != known.end()) values[f] = found->second;
    }
    return values;
  }

  // Whether faces at the point have values. A vector is 0 if it is 0 on one of them: a wall without slip.
  [[nodiscard]] bool is_known(const std::vector<const double*>& faces, std::size_t components, std::size_t p,
                              std::vector<double>& sum) const {
    double total = 0.0;
    bool still = false;
    std::fill(sum.begin(), sum.end(), 0.0);
    for (std::size_t k = of_faces_.offsets[p]; k < of_faces_.offsets[p + 1]; ++k) {
      const double* const value = faces[of_faces_.items[k]];
      if (value == nullptr) continue;
      total += of_faces_.weights[k];
      for (std::size_t j = 0; j < components; ++j) sum[j] += value[j] * of_faces_.weights[k];
      still = still || (components == 3 && std::all_of(value, value + 3, [](double x) { return x == 0.0; }));
    }
    for (double& x : sum) x = still ? 0.0 : x / total;
    return total > 0.0;
  }

  PointWeights of_cells_;
  PointWeights of_faces_;
  std::vector<std::uint32_t> labels_;  // of the patch faces
};

void add_fields(const FoamCase& from, std::size_t cells, std::size_t points, const ReadOptions& options,
                const std::vector<std::uint32_t>& kept_points, ParsedMesh& parsed) {
  MeshData& mesh = parsed.mesh;
  std::optional<CellsToPoints> to_points;
  for (const std::string& name : from.files()) {
    const bool at_points = std::count(options.point_fields.begin(), options.point_fields.end(), name) != 0;
    std::optional<FoamCase::Field> field;
    try {
      field = from.field(name, cells, points, options.max_memory, at_points);
    } catch (const InvalidMesh& e) {
      parsed.warnings.push_back({unread_field + name, 1, {}, fmt::format("it is left out: {}", e.what())});
    }
    if (!field) continue;
    if (at_points && field->at_cells) {
      if (!to_points) to_points.emplace(mesh);
      mesh.point_data.push_back({name, field->components, (*to_points)(*field)});
    }
    DataArray array{name, field->components, {}};
    array.values =
        field->at_cells ? std::move(field->values) : selected(std::move(field->values), field->components, kept_points);
    (field->at_cells ? mesh.cell_data : mesh.point_data).push_back(std::move(array));
  }
}

/// The case's times that have a file.
FieldSeries times_with(const FoamCase& from, std::string_view file) {
  FieldSeries series;
  for (const FoamTime& t : from.times()) {
    if (!from.has(t.name, file)) continue;
    if (!series.times.empty() && t.time == series.times.back())
      throw InvalidMesh(fmt::format("{}: two folders of the time {}", from.root().string(), t.time));
    series.files.push_back(from.root() / t.name);
    series.times.push_back(t.time);
  }
  return series;
}

/// `kept`: the labels of its points; empty: all.
ParsedMesh parsed_mesh(PolyMesh mesh, std::vector<std::uint32_t>& kept) {
  return has_empty_faces(mesh) ? mesh_in_plane(mesh, kept) : mesh_in_space(std::move(mesh));
}

}  // namespace

bool is_openfoam(const fs::path& path) { return FoamCase::find(path).has_value(); }

bool is_openfoam_case(const fs::path& path) {
  const auto found = FoamCase::find(path);
  return found && !found->names_time() && !found->is_folder_alone();
}

ParsedMesh parse_openfoam(const fs::path& path, const ReadOptions& options) {
  const FoamCase from = case_of(path);
  PolyMesh mesh = from.read(options.max_memory);
  if (mesh.cells == 0) throw InvalidMesh("the mesh has no cells");
  const std::size_t cells = mesh.cells;
  const std::size_t points = mesh.points.size();
  std::vector<std::uint32_t> kept;
  ParsedMesh parsed = parsed_mesh(std::move(mesh), kept);
  if (from.names_time()) add_fields(from, cells, points, options, kept, parsed);
  parsed.format = from.parts().empty() ? "OpenFOAM polyMesh"
                                       : fmt::format("OpenFOAM polyMesh, of {} processors", from.parts().size());
  finish(parsed);
  return parsed;
}

FieldSeries openfoam_points(const fs::path& path) {
  const FoamCase from = case_of(path);
  FieldSeries series = times_with(from, "polyMesh/points");
  if (series.files.empty()) throw InvalidMesh(fmt::format("{}: no time of the case has points", from.root().string()));
  if (series.times.front() > 0.0) {
    series.files.insert(series.files.begin(), from.root() / "constant");
    series.times.insert(series.times.begin(), 0.0);
  }
  return series;
}

FieldSeries openfoam_field(const fs::path& path, std::string_view field) {
  const FoamCase from = case_of(path);
  FieldSeries series = times_with(from, field);
  if (series.files.empty())
    throw InvalidMesh(fmt::format("{}: no time of the case has a field {}", from.root().string(), field));
  return series;
}

namespace {

// The value of `default` in the block of this name; empty where there is none.
std::string default_scheme(FoamFile& file, std::string_view block) {
  while (file.next() != '\0') {
    if (file.next() == '#') {
      file.directive();
    } else if (file.next() == '$' || file.word("a key") != block) {
      file.skip_entry();
    } else {
      file.expect('{', "behind the name of a block");
      while (!file.take('}')) {
        if (file.next() == '$' || file.next() == '#') return {};
        if (file.word("a key") == "default") return file.entry();
        file.skip_entry();
      }
    }
  }
  return {};
}

}  // namespace

bool is_steady_openfoam(const fs::path& path) {
  const fs::path folder = case_of(path).root() / "system";
  if (!has_foam_file(folder, "fvSchemes")) return false;
  try {
    FoamFile file(folder, "fvSchemes", 0);
    return default_scheme(file, "ddtSchemes").starts_with("steadyState");
  } catch (const InvalidMesh&) {
    return false;  // it is not needed for anything else
  }
}

std::vector<Vec3> openfoam_points_at(const fs::path& path, const ReadOptions& options) {
  return case_of(path).points(options.max_memory);
}

namespace {

FoamCase::Field vectors_of(const FoamCase& from, const fs::path& path, std::string_view field, std::size_t cells,
                           std::size_t points, std::uint64_t max_memory, bool with_faces) {
  auto found = from.field(field, cells, points, max_memory, with_faces);
  if (!found || found->components != 3)
    throw InvalidMesh(fmt::format("{}: there is no field {} of vectors at cells", path.string(), field));
  return std::move(*found);
}

std::vector<Vec3> as_vec3(std::span<const double> values) {
  std::vector<Vec3> vectors;
  vectors.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) vectors.push_back({values[i], values[i + 1], values[i + 2]});
  return vectors;
}

}  // namespace

std::vector<Vec3> openfoam_cell_vectors(const fs::path& path, std::string_view field, std::size_t cells,
                                        const ReadOptions& options) {
  const FoamCase::Field found = vectors_of(case_of(path), path, field, cells, 0, options.max_memory, false);
  if (!found.at_cells)
    throw InvalidMesh(fmt::format("{}: there is no field {} of vectors at cells", path.string(), field));
  return as_vec3(found.values);
}

OpenFoamSizes openfoam_sizes(const fs::path& path, const ReadOptions& options) {
  const PolyMesh mesh = case_of(path).read(options.max_memory);
  OpenFoamSizes sizes{mesh.cells, {}};
  for (const PolyPatch& p : mesh.patches) sizes.patches.push_back({p.name, p.type});
  return sizes;
}

struct OpenFoamPointVectors::AtTime {
  std::string time;  // of the points
  std::size_t cells;
  std::size_t points;
  std::vector<std::uint32_t> kept;
  std::function<std::vector<double>(const FoamCase::Field&)> to_points;
};

std::vector<Vec3> OpenFoamPointVectors::operator()(const fs::path& path, std::string_view field,
                                                   const ReadOptions& options) {
  const FoamCase from = case_of(path);
  const std::string time = from.time_of_points();
  if (!last_ || last_->time != time) {
    PolyMesh mesh = from.read(options.max_memory);
    const std::size_t cells = mesh.cells;
    const std::size_t points = mesh.points.size();
    std::vector<std::uint32_t> kept;
    const ParsedMesh parsed = parsed_mesh(std::move(mesh), kept);
    last_ = std::make_shared<const AtTime>(AtTime{time, cells, points, std::move(kept), CellsToPoints(parsed.mesh)});
  }
  FoamCase::Field found = vectors_of(from, path, field, last_->cells, last_->points, options.max_memory, true);
  return as_vec3(found.at_cells ? last_->to_points(found) : selected(std::move(found.values), 3, last_->kept));
}

}  // namespace dartcast
