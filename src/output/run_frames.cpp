// Reads particles from their frames, and the walls from those of the environment.
#include "output/run_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/point_file.hpp"
#include "output/run_files.hpp"
#include "output/wall_faces.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

const std::vector<double>& values_of_frame(const PointFile& file, std::string_view name, std::size_t components,
                                           const fs::path& path) {
  const auto found = std::find_if(file.arrays.begin(), file.arrays.end(),
                                  [&](const DataArray& a) { return a.name == name && a.components == components; });
  if (found == file.arrays.end())
    throw InvalidMesh(fmt::format("{}: the frame has no array '{}': this is no frame of a run", path.string(), name));
  return found->values;
}

}  // namespace

RunFrames::RunFrames(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "particles.pvd") || !fs::is_regular_file(folder / "environment.pvd"))
    throw InvalidArgument(fmt::format("{}: there are no frames of a run", folder.string()));
  particles_ = read_pvd(folder / "particles.pvd");
  environment_ = read_pvd(folder / "environment.pvd");
  if (environment_.files.size() != 1 && environment_.files.size() != size())
    throw InvalidArgument(fmt::format("{}: particles and environment have different frames", folder.string()));
}

RunFrame RunFrames::read(std::size_t frame) const {
  const fs::path& path = particles_.files.at(frame);
  PointFile file = read_points(path);
  RunFrame out{frame_step(path.filename().string()).value_or(frame), particles_.times[frame], {}, {}, {}, {}};
  const std::vector<double>& v = values_of_frame(file, "velocity", 3, path);
  for (std::size_t i = 0; i < file.points.size(); ++i) out.velocities.push_back({v[3 * i], v[3 * i + 1], v[3 * i + 2]});
  out.radii = values_of_frame(file, "radius", 1, path);
  for (const double id : values_of_frame(file, "id", 1, path)) out.ids.push_back(static_cast<std::uint64_t>(id));
  out.points = std::move(file.points);
  return out;
}

RunWalls RunFrames::walls(std::size_t frame) const {
  const MeshData mesh = read_valid_mesh(environment_.files.at(walls_stand() ? 0 : frame)).mesh;
  WallFaceList list = wall_face_list(CombinatorialMap(mesh));
  RunWalls walls;
  for (const Vertex v : list.vertices) walls.points.push_back(mesh.points[v.value]);
  walls.offsets = std::move(list.offsets);
  walls.corners = std::move(list.corners);
  return walls;
}

}  // namespace dartcast
