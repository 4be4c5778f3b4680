// A run's particles as a cloud in an OpenFOAM case. Each frame has a folder TIME/lagrangian/NAME, with positions,
// velocities and ids. TIME/uniform/lagrangian/NAME says that positions are given, not weights in OpenFOAM's tetrahedra.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>

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

}  // namespace

std::size_t write_lagrangian(const fs::path& run_folder, const fs::path& openfoam_case, const std::string& cloud) {
  if (cloud.empty() || cloud.find('/') != std::string::npos)
    throw InvalidArgument(fmt::format("\"{}\" is no name for a cloud: give a word", cloud));
  if (!is_openfoam_case(openfoam_case) || !fs::is_directory(openfoam_case))
    throw InvalidArgument(fmt::format("{}: this is no folder of an OpenFOAM case", openfoam_case.string()));
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
