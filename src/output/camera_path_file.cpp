// A camera path as the content of a file for ParaView.
#include "output/camera_path_file.hpp"

#include <utility>
#include <vector>

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

}  // namespace dartcast
