// A case as a mesh, as frames of a deformation, and as a field at several times.
#include "formats/openfoam.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/openfoam/foam_case.hpp"
#include "formats/openfoam/foam_file.hpp"
#include "formats/openfoam/poly_cells.hpp"

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

void add_fields(const FoamCase& from, std::size_t cells, std::size_t points, std::uint64_t max_memory,
                const std::vector<std::uint32_t>& kept_points, ParsedMesh& parsed) {
  MeshData& mesh = parsed.mesh;
  for (const std::string& name : from.files()) {
    std::optional<FoamCase::Field> field;
    try {
      field = from.field(name, cells, points, max_memory);
    } catch (const InvalidMesh& e) {
      parsed.warnings.push_back({unread_field + name, 1, {}, fmt::format("it is left out: {}", e.what())});
    }
    if (!field) continue;
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
  ParsedMesh parsed = has_empty_faces(mesh) ? mesh_in_plane(mesh, kept) : mesh_in_space(std::move(mesh));
  if (from.names_time()) add_fields(from, cells, points, options.max_memory, kept, parsed);
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

std::vector<Vec3> openfoam_cell_vectors(const fs::path& path, std::string_view field, std::size_t cells,
                                        const ReadOptions& options) {
  const FoamCase from = case_of(path);
  const auto found = from.field(field, cells, 0, options.max_memory);
  if (!found || !found->at_cells || found->components != 3)
    throw InvalidMesh(fmt::format("{}: there is no field {} of vectors at cells", path.string(), field));
  std::vector<Vec3> vectors;
  vectors.reserve(cells);
  for (std::size_t c = 0; c < cells; ++c)
    vectors.push_back({found->values[3 * c], found->values[3 * c + 1], found->values[3 * c + 2]});
  return vectors;
}

}  // namespace dartcast
