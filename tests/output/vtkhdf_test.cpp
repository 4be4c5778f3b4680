// Files of VTKHDF, read here by HDF5 as the format's description says (docs.vtk.org, "VTKHDF file format"): each frame has
// the particles and the walls of the run's own frames. ParaView's word on them: tools/compare_vtkhdf.py.
#include <gtest/gtest.h>

#ifdef DARTCAST_HDF5
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "output/export_run.hpp"
#include "output/run_frames.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::vtkhdf_test {

class HdfFile {
 public:
  explicit HdfFile(const std::filesystem::path& path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;
  ~HdfFile() { H5Fclose(file_); }

  [[nodiscard]] std::vector<double> doubles(const std::string& name) const {
    return read<double>(name, H5T_NATIVE_DOUBLE);
  }
  [[nodiscard]] std::vector<std::int64_t> numbers(const std::string& name) const {
    return read<std::int64_t>(name, H5T_NATIVE_INT64);
  }

 private:
  template <class T>
  [[nodiscard]] std::vector<T> read(const std::string& name, hid_t type) const {
    const hid_t set = H5Dopen2(file_, ("VTKHDF/" + name).c_str(), H5P_DEFAULT);
    EXPECT_GE(set, 0) << name;
    const hid_t space = H5Dget_space(set);
    std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    EXPECT_GE(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
    H5Sclose(space);
    H5Dclose(set);
    return values;
  }

  hid_t file_;
};

template <class T>
std::vector<T> part(const std::vector<T>& all, std::int64_t from, std::int64_t count) {
  return {all.begin() + from, all.begin() + from + count};
}

// One frame, by the offsets of its step.
class HdfFrame {
 public:
  HdfFrame(const HdfFile& file, std::size_t step) : file_(file), step_(step) {
    part_ = file.numbers("Steps/PartOffsets").at(step);
    points_from_ = file.numbers("Steps/PointOffsets").at(step);
    points_ = file.numbers("NumberOfPoints").at(static_cast<std::size_t>(part_));
  }

  [[nodiscard]] std::vector<Vec3> vectors(const std::string& name) const {
    const std::vector<double> values = part(file_.doubles(name), 3 * points_from_, 3 * points_);
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
    return out;
  }
  [[nodiscard]] std::vector<std::int64_t> numbers(const std::string& name) const {
    return part(file_.numbers(name), file_.numbers("Steps/PointDataOffsets/" + name.substr(10)).at(step_), points_);
  }
  /// The corners of each cell. `topology`: 0 vertices, 1 lines, 2 polygons, 3 strips.
  [[nodiscard]] std::vector<std::vector<std::int64_t>> cells(std::size_t topology) const {
    const std::string group = std::array<const char*, 4>{"Vertices/", "Lines/", "Polygons/", "Strips/"}.at(topology);
    const auto at = static_cast<std::size_t>(part_);
    const std::int64_t count = file_.numbers(group + "NumberOfCells").at(at);
    const std::int64_t from = file_.numbers("Steps/CellOffsets").at(4 * step_ + topology);
    const std::int64_t ids_from = file_.numbers("Steps/ConnectivityIdOffsets").at(4 * step_ + topology);
    const std::int64_t ids = file_.numbers(group + "NumberOfConnectivityIds").at(at);
    const std::vector<std::int64_t> corners = part(file_.numbers(group + "Connectivity"), ids_from, ids);
    // Each part has one more offset than cells.
    const std::vector<std::int64_t> offsets = part(file_.numbers(group + "Offsets"), from + part_, count + 1);
    EXPECT_EQ(offsets.front(), 0);
    EXPECT_EQ(offsets.back(), ids);
    std::vector<std::vector<std::int64_t>> out;
    for (std::size_t c = 0; c + 1 < offsets.size(); ++c)
      out.push_back(part(corners, offsets[c], offsets[c + 1] - offsets[c]));
    return out;
  }

 private:
  const HdfFile& file_;
  std::size_t step_;
  std::int64_t part_ = 0;
  std::int64_t points_from_ = 0;
  std::int64_t points_ = 0;
};

void expect_particles(const HdfFrame& read, const RunFrame& frame) {
  const std::vector<Vec3> points = read.vectors("Points"), velocities = read.vectors("PointData/velocity");
  const std::vector<std::int64_t> ids = read.numbers("PointData/id"), marks = read.numbers("PointData/is_particle");
  const auto vertices = read.cells(0);
  ASSERT_EQ(vertices.size(), frame.points.size());
  EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), static_cast<std::ptrdiff_t>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto at = static_cast<std::size_t>(vertices[i].at(0));
    EXPECT_EQ(points.at(at), frame.points[i]);
    EXPECT_EQ(velocities.at(at), frame.velocities[i]);
    EXPECT_EQ(ids.at(at), static_cast<std::int64_t>(frame.ids[i]));
    EXPECT_EQ(marks.at(at), 1);
  }
}

void expect_walls(const HdfFrame& read, const RunWalls& walls) {
  const std::vector<Vec3> points = read.vectors("Points");
  const std::size_t topology = walls.are_lines() ? 1 : 2;
  const auto cells = read.cells(topology);
  ASSERT_EQ(cells.size(), walls.offsets.size() - 1);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    ASSERT_EQ(cells[c].size(), walls.offsets[c + 1] - walls.offsets[c]);
    for (std::size_t k = 0; k < cells[c].size(); ++k)
      EXPECT_EQ(points.at(static_cast<std::size_t>(cells[c][k])), walls.points[walls.corners[walls.offsets[c] + k]]);
  }
  EXPECT_TRUE(read.cells(3 - topology).empty());
  EXPECT_TRUE(read.cells(3).empty());
}

// Particles come and go; walls move, or are cut, or are lines in the plane.
TEST(VtkHdf, HasTheFramesOfTheRun) {
  const std::string particles =
      "[[particles]]\ninlet = 'xmin'\nrate = 40.0\nvelocity = [2.0, 0.3, 0.0]\n[motion]\ndt = 0.05\nsteps = 40\n"
      "[contact.patch.xmax]\nresponse = 'escape'\n[output]\nevery = 5\nreport = false\n";
  const test::Folder folder;
  for (const std::string scene :
       {"[environment]\ngenerator = 'box'\ncells = [3, 2, 2]\n[[deformation]]\nkind = 'bend'\namplitude = 0.1\nlength "
        "= 2\n",
        "[environment]\ngenerator = 'box'\ncells = [3, 2, 2]\n[[event]]\nat = 0.6\nkind = 'carve'\ntool = 'box'\n"
        "low = [1.2, 0.2, 0.2]\nhigh = [1.8, 0.8, 0.8]\nwhat = 'remove'\n",
        "[environment]\ngenerator = 'rectangle'\ncells = [3, 2]\n"}) {
    SCOPED_TRACE(scene);
    RunOptions options;
    options.folder = folder / "run";
    run_scene(parse_scene(scene + particles, folder / "scene.toml"), options);
    ASSERT_EQ(export_run(folder / "run", folder / "run.vtkhdf"), 9U);
    const RunFrames frames(folder / "run");
    const HdfFile file(folder / "run.vtkhdf");
    EXPECT_EQ(file.doubles("Steps/Values"), frames.times());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const HdfFrame read(file, k);
      expect_particles(read, frames.read(k));
      expect_walls(read, frames.walls(frames.walls_stand() ? 0 : k));
    }
  }
}

}  // namespace dartcast::vtkhdf_test
#endif
