// A run's particles as a cloud in an OpenFOAM case, and what drag takes from them as volume fields. Each frame of a cloud has a folder TIME/lagrangian/NAME, with positions,
// velocities and ids. TIME/uniform/lagrangian/NAME says that positions are given, not weights in OpenFOAM's tetrahedra.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "formats/file_series.hpp"
#include "formats/openfoam.hpp"
#include "formats/point_file.hpp"
#include "output/recording.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

const DataArray& array_of(const PointFile& frame, std::string_view name, std::size_t components, const fs::path& file) {
  const auto found = std::find_if(frame.arrays.begin(), frame.arrays.end(),
                                  [&](const DataArray& a) { return a.name == name && a.components == components; });
  if (found == frame.arrays.end())
    throw InvalidMesh(fmt::format("{}: the frame has no array '{}': this is no frame of a run", file.string(), name));
  return *found;
}

std::string header(std::string_view type, std::string_view location, std::string_view object) {
  return fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n    location    \"{}\";\n    "
      "object      {};\n}}\n\n",
      type, location, object);
}

std::string head(std::string_view type, std::string_view location, std::string_view object, std::size_t count) {
  return header(type, location, object) + fmt::format("{}\n(\n", count);
}

void write_properties(const PointFile& frame, const fs::path& root, const std::string& location) {
  make_output_folder(root / location);
  write_bytes(
      root / location / "cloudProperties",
      header("dictionary", location, "cloudProperties") +
          fmt::format("processor0\n{{\n    particleCount   {};\n}}\n\ngeometry    positions;\n", frame.points.size()));
}

void write_cloud(const PointFile& frame, const fs::path& file, const fs::path& root, const std::string& location) {
  const std::size_t n = frame.points.size();
  const std::vector<double>& cells = array_of(frame, "cell", 1, file).values;
  const std::vector<double>& velocities = array_of(frame, "velocity", 3, file).values;
  const std::vector<double>& ids = array_of(frame, "id", 1, file).values;
  std::string positions = head("Cloud<passiveParticle>", location, "positions", n);
  std::string u = head("vectorField", location, "U", n);
  std::string id = head("labelField", location, "origId", n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = frame.points[i];
    fmt::format_to(std::back_inserter(positions), "({:.17g} {:.17g} {:.17g}) {:.0f}\n", p.x, p.y, p.z, cells[i]);
    fmt::format_to(std::back_inserter(u), "({:.17g} {:.17g} {:.17g})\n", velocities[3 * i], velocities[3 * i + 1],
                   velocities[3 * i + 2]);
    fmt::format_to(std::back_inserter(id), "{:.0f}\n", ids[i]);
  }
  const fs::path folder = root / location;
  make_output_folder(folder);
  write_bytes(folder / "positions", positions + ")\n");
  write_bytes(folder / "U", u + ")\n");
  write_bytes(folder / "origId", id + ")\n");
}

struct SourceField {
  const char* name;
  const char* type;
  const char* item;
  const char* dimensions;
  std::size_t components;
};
constexpr std::array<SourceField, 2> sources = {{{"momentum_source", "volVectorField", "vector", "1 -2 -2 0 0 0 0", 3},
                                                 {"energy_source", "volScalarField", "scalar", "1 -1 -3 0 0 0 0", 1}}};

// OpenFOAM wants the type of some patches in fields, too.
std::string boundary_field(const std::vector<OpenFoamSizes::Patch>& patches) {
  std::string text = "boundaryField\n{\n";
  for (const OpenFoamSizes::Patch& p : patches) {
    const bool constrains = p.type == "empty" || p.type == "wedge" || p.type.starts_with("cyclic") ||
                            p.type.starts_with("processor") || p.type.starts_with("symmetry");
    text += fmt::format("    \"{}\"\n    {{\n        type            {};\n    }}\n", p.name,
                        constrains ? p.type : "zeroGradient");
  }
  return text + "}\n";
}

// By label; cells that the run has left out have 0.
std::vector<double> by_label(const MeshData& frame, const DataArray& array, std::size_t cells, const fs::path& file) {
  const auto source = std::find_if(frame.cell_data.begin(), frame.cell_data.end(),
                                   [](const DataArray& a) { return a.name == "source"; });
  std::vector<double> values(cells * array.components);
  std::vector<bool> seen(cells);
  for (std::size_t c = 0; c < frame.cell_count(); ++c) {
    const std::size_t label = source == frame.cell_data.end() ? c : static_cast<std::size_t>(source->values[c]);
    if (label >= cells || seen[label])
      throw InvalidArgument(
          fmt::format("{}: its cells are not those of the case: give the case of the run's mesh, which was not edited",
                      file.string()));
    seen[label] = true;
    for (std::size_t k = 0; k < array.components; ++k)
      values[label * array.components + k] = array.values[c * array.components + k];
  }
  return values;
}

void write_source(const SourceField& source, const std::vector<double>& values,
                  const std::vector<OpenFoamSizes::Patch>& patches, const fs::path& root, const std::string& time) {
  std::string text = header(source.type, time, source.name) +
                     fmt::format("dimensions      [{}];\n\ninternalField   nonuniform List<{}>\n{}\n(\n",
                                 source.dimensions, source.item, values.size() / source.components);
  for (std::size_t i = 0; i < values.size(); i += source.components) {
    if (source.components == 1)
      fmt::format_to(std::back_inserter(text), "{:.17g}\n", values[i]);
    else
      fmt::format_to(std::back_inserter(text), "({:.17g} {:.17g} {:.17g})\n", values[i], values[i + 1], values[i + 2]);
  }
  make_output_folder(root / time);
  write_bytes(root / time / source.name, text + ")\n;\n\n" + boundary_field(patches));
}

void check_case(const fs::path& openfoam_case) {
  if (!is_openfoam_case(openfoam_case) || !fs::is_directory(openfoam_case))
    throw InvalidArgument(fmt::format("{}: this is no folder of an OpenFOAM case", openfoam_case.string()));
}

}  // namespace

std::size_t write_sources(const fs::path& run_folder, const fs::path& openfoam_case) {
  check_case(openfoam_case);
  const OpenFoamSizes sizes = openfoam_sizes(openfoam_case, {});
  const FieldSeries frames = read_pvd(run_folder / "environment.pvd");
  std::size_t written = 0;
  for (std::size_t k = 0; k < frames.files.size(); ++k) {
    const MeshData frame = read_mesh(frames.files[k]).mesh;
    for (const SourceField& source : sources) {
      const auto found = std::find_if(frame.cell_data.begin(), frame.cell_data.end(), [&](const DataArray& a) {
        return a.name == source.name && a.components == source.components;
      });
      if (found == frame.cell_data.end()) continue;
      write_source(source, by_label(frame, *found, sizes.cells, frames.files[k]), sizes.patches, openfoam_case,
                   fmt::format("{:.12g}", frames.times[k]));
      ++written;
    }
  }
  if (written == 0)
    throw Error(
        fmt::format("{}: the run has no source terms: ask for momentum_source or energy_source in its table "
                    "[statistics], cells",
                    run_folder.string()));
  return frames.files.size();
}

std::size_t write_lagrangian(const fs::path& run_folder, const fs::path& openfoam_case, const std::string& cloud) {
  if (cloud.empty() || cloud.find('/') != std::string::npos)
    throw InvalidArgument(fmt::format("\"{}\" is no name for a cloud: give a word", cloud));
  check_case(openfoam_case);
  const FieldSeries frames = read_pvd(run_folder / "particles.pvd");
  for (std::size_t k = 0; k < frames.files.size(); ++k) {
    const std::string time = fmt::format("{:.12g}", frames.times[k]);
    const PointFile frame = read_points(frames.files[k]);
    write_properties(frame, openfoam_case, fmt::format("{}/uniform/lagrangian/{}", time, cloud));
    write_cloud(frame, frames.files[k], openfoam_case, fmt::format("{}/lagrangian/{}", time, cloud));
  }
  return frames.files.size();
}

}  // namespace dartcast
