// A camera's path as a file.
#include "output/camera_path_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "dartcast/generators.hpp"
#include "formats/file_write.hpp"
#include "formats/point_file.hpp"

namespace dartcast::camera_path_file_test {

namespace fs = std::filesystem;

CameraPath path_in_a_bar() {
  Environment environment(generate_bar());
  return camera_path(environment, std::vector<Vec3>{{2.5, 2.5, 3.0}, {2.0, 2.5, 9.0}, {3.0, 2.5, 20.0}}, {0.7});
}

TEST(CameraPathFile, HoldsTheCamerasAsALine) {
  const fs::path file = fs::path(testing::TempDir()) / "dartcast_camera.vtp";
  const CameraPath path = path_in_a_bar();
  ASSERT_GT(path.cameras.size(), 20U);
  write_xml(file, camera_path_data(path), Compression::none, write_pieces);
  const PointFile read = read_points(file);
  ASSERT_EQ(read.points.size(), path.cameras.size());
  ASSERT_EQ(read.arrays.size(), 3U);
  const auto vector = [&](std::size_t array, std::size_t i) {
    const std::vector<double>& v = read.arrays[array].values;
    return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  };
  for (std::size_t i = 0; i < read.points.size(); ++i) {
    EXPECT_EQ(read.points[i], path.cameras[i].position);
    EXPECT_EQ(vector(0, i), path.cameras[i].direction);
    EXPECT_EQ(vector(1, i), path.cameras[i].up);
    EXPECT_EQ(read.arrays[2].values[i], path.cameras[i].arc);
  }
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_NE(text.str().find("NumberOfLines=\"1\""), std::string::npos);
  EXPECT_EQ(read.arrays[0].name, "direction");
  EXPECT_EQ(read.arrays[1].name, "up");
  EXPECT_EQ(read.arrays[2].name, "arc_length");
  fs::remove(file);
}

}  // namespace dartcast::camera_path_file_test
