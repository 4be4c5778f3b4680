// Writes a camera path as a file for ParaView.
#include "output/camera_path_file.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/file_write.hpp"
#include "formats/vtp_write.hpp"

namespace dartcast {

XmlDataSet camera_path_data(const CameraPath& path) {
  std::vector<Vec3> positions;
  std::vector<Vec3> directions;
  std::vector<Vec3> ups;
  std::vector<double> arcs;
  for (const Camera& camera : path.cameras) {
    positions.push_back(camera.position);
    directions.push_back(camera.direction);
    ups.push_back(camera.up);
    arcs.push_back(camera.arc);
  }
  VtpFile file(std::move(positions));
  file.add_line();
  if (path.cameras.empty()) return file.data();
  file.add("direction", std::move(directions));
  file.add("up", std::move(ups));
  file.add("arc_length", std::move(arcs));
  return file.data();
}

void write_camera_path(const CameraPath& path, const std::filesystem::path& file) {
  if (path.cameras.empty()) throw InvalidArgument("camera path: there is no camera to write");
  if (file.extension() != ".vtp") throw InvalidArgument(fmt::format("{}: name the file .vtp", file.string()));
  write_xml(file, camera_path_data(path), Compression::none, write_pieces);
}

}  // namespace dartcast
