// Writes a camera path as a file for ParaView.
#include "output/camera_path_file.hpp"

#include <fmt/format.h>

#include "dartcast/error.hpp"
#include "formats/vtp_write.hpp"

namespace dartcast {

void write_camera_path(const CameraPath& path, const std::filesystem::path& file) {
  if (path.cameras.empty()) throw InvalidArgument("camera path: there is no camera to write");
  if (file.extension() != ".vtp") throw InvalidArgument(fmt::format("{}: name the file .vtp", file.string()));
  VtpWriter points(path.cameras.size(), [&](std::size_t i) { return path.cameras[i].position; });
  points.add_line();
  points.add_vectors("direction", [&](std::size_t i) { return path.cameras[i].direction; });
  points.add_vectors("up", [&](std::size_t i) { return path.cameras[i].up; });
  points.add("arc_length", [&](std::size_t i) { return path.cameras[i].arc; });
  points.write(file);
}

}  // namespace dartcast
