// The data of the environment that ParaView shows: the input's arrays, and where each cell came from.
#include "output/environment_record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/point_file.hpp"
#include "output/recording.hpp"
#include "support/data_arrays.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::environment_record_test {

using test::array;

namespace fs = std::filesystem;

// Cubes whose cells, regions and arrays say where each is: `number` of a cell, `place` and `height` of a point.
MeshData labelled_box() {
  BoxOptions o;
  o.cells = {6, 3, 3};
  o.size = {6, 3, 3};
  o.blocked_layer = false;
  MeshData mesh = generate_box(o);
  DataArray number{"number", 1, {}};
  DataArray place{"place", 3, {}};
  DataArray height{"height", 1, {}};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    number.values.push_back(100.0 + static_cast<double>(c));
    mesh.regions.push_back(static_cast<std::int32_t>(c % 4) + 1);
    mesh.free.push_back(c % 6 == 3 ? 0 : 1);
  }
  for (const Vec3& x : mesh.points) {
    place.values.insert(place.values.end(), {x.x, x.y, x.z});
    height.values.push_back(x.z);
  }
  mesh.cell_data = {number};
  mesh.point_data = {place, height};
  return mesh;
}

struct Box {
  Vec3 low = {1e9, 1e9, 1e9};
  Vec3 high = {-1e9, -1e9, -1e9};

  void add(const Vec3& x) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  [[nodiscard]] bool holds(const Vec3& x) const {
    constexpr double near = 1e-9;
    return x.x > low.x - near && x.x < high.x + near && x.y > low.y - near && x.y < high.y + near &&
           x.z > low.z - near && x.z < high.z + near;
  }
};

std::map<double, Box> boxes_by_source(const MeshData& frame) {
  std::map<double, Box> boxes;
  const DataArray& source = array(frame.cell_data, "source");
  for (std::size_t c = 0; c < frame.cell_count(); ++c) {
    const auto corners = frame.cell(c);
    if (frame.types[c] != CellType::polyhedron) {
      for (const std::uint32_t v : corners) boxes[source.values[c]].add(frame.points[v]);
      continue;
    }
    for (std::size_t f = 0, at = 1; f < corners[0]; ++f, at += corners[at] + 1) {
      for (std::size_t k = 1; k <= corners[at]; ++k) boxes[source.values[c]].add(frame.points[corners[at + k]]);
    }
  }
  return boxes;
}

// The join: a particle with `cell` c lies in the cells whose `source` is c. The cells are boxes, so
// that their bounds are exact.
void expect_joined(const fs::path& folder, const std::string& step, bool static_points) {
  const MeshFile frame = read_mesh(folder / ("environment_" + step + ".vtu"));
  ASSERT_TRUE(frame.report.valid());
  const std::map<double, Box> boxes = boxes_by_source(frame.mesh);
  const PointFile particles = read_points(folder / ("particles_" + step + ".vtp"));
  const DataArray& cell = array(particles.arrays, "cell");
  ASSERT_GT(particles.points.size(), 10U);
  for (std::size_t i = 0; i < particles.points.size(); ++i)
    EXPECT_TRUE(boxes.at(cell.values[i]).holds(particles.points[i])) << step << " particle " << i;
  const DataArray& source = array(frame.mesh.cell_data, "source");
  const DataArray& number = array(frame.mesh.cell_data, "number");
  const DataArray& region = array(frame.mesh.cell_data, "region");
  for (std::size_t c = 0; c < frame.mesh.cell_count(); ++c) {
    const double row = (source.values[c] - 7.0) / 2.0;
    EXPECT_EQ(number.values[c], 100.0 + row);
    EXPECT_EQ(region.values[c], static_cast<double>(static_cast<int>(row) % 4 + 1));
  }
  if (!static_points) return;
  const DataArray& place = array(frame.mesh.point_data, "place");
  const DataArray& height = array(frame.mesh.point_data, "height");
  for (std::size_t p = 0; p < frame.mesh.points.size(); ++p) {
    const Vec3 at = {place.values[3 * p], place.values[3 * p + 1], place.values[3 * p + 2]};
    EXPECT_LE(norm(at - frame.mesh.points[p]), 1e-9) << p;
    EXPECT_NEAR(height.values[p], frame.mesh.points[p].z, 1e-9) << p;
  }
}

void add_frame(Recording& recording, const Simulation& simulation) {
  const RecordingFrame frame{simulation.steps(), simulation.time()};
  recording.add_frame(simulation, {&frame, 1});
}

class EnvironmentRecordTest : public testing::Test {
 protected:
  test::Folder temporary;
  fs::path folder = temporary / "run";
};

// Sources as those of a file in which other things stand between the cells.
TEST_F(EnvironmentRecordTest, CellsAndParticlesAreJoinedBySource) {
  MeshData mesh = labelled_box();
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) mesh.source.push_back(7 + 2 * c);
  Environment environment(mesh);
  SimulationOptions options;
  options.dt = 0.1;
  Simulation simulation(environment, options);
  simulation.add_random(80, {1.0, -2.0, 0.5});
  WritingThread writing;
  std::optional<EnvironmentRecord> record = EnvironmentRecord(mesh);
  Recording recording({writing, folder}, {true, true}, record, "");
  simulation.set_after_edit([&](const Environment& edited) { record->update_after_edit(edited); });
  simulation.step();
  add_frame(recording, simulation);
  writing.finish();
  expect_joined(folder, "000001", true);
  Event cut;
  cut.what = Cut{plane_through({3.5, 1.5, 1.5}, {1.0, 0.2, 0.1}), 0.4};
  apply(simulation, cut);
  simulation.step();
  add_frame(recording, simulation);
  writing.finish();
  expect_joined(folder, "000002", true);
  Event carve;
  carve.what = Carve{box_tool({4.2, 0.4, 0.3}, {5.4, 1.6, 1.7}), Carving::remove, false};
  apply(simulation, carve);
  simulation.step();
  add_frame(recording, simulation);
  writing.finish();
  expect_joined(folder, "000003", true);
}

TEST_F(EnvironmentRecordTest, AFileOfFacesAndCellsIsKept) {
  MeshData mesh = labelled_box();
  mesh.cell_data.push_back({"source", 1, std::vector<double>(mesh.cell_count(), -1.0)});
  mesh.cell_data.push_back({"free", 1, std::vector<double>(mesh.cell_count(), 0.5)});
  write_mesh(mesh, temporary / "in.vtu");
  RunOptions options;
  options.folder = folder;
  run_scene(parse_scene("[environment]\nmesh = '" + (temporary / "in.vtu").string() +
                            "'\n[[particles]]\ncount = 9\n[motion]\nsteps = 2\n",
                        "test.toml"),
            options);
  const MeshData out = read_mesh(folder / "environment.vtu").mesh;
  const MeshData in = read_mesh(temporary / "in.vtu").mesh;
  EXPECT_EQ(out.points, in.points);
  for (const char* name : {"place", "height"})
    EXPECT_EQ(array(out.point_data, name).values, array(in.point_data, name).values);
  EXPECT_EQ(array(out.cell_data, "number").values, array(in.cell_data, "number").values);
  for (std::size_t c = 0; c < out.cell_count(); ++c) EXPECT_EQ(array(out.cell_data, "source").values[c], in.source[c]);
}

// The arrays of a run that was cut off and resumed after edits are those of one that was not.
TEST_F(EnvironmentRecordTest, ResumedRunsKeepTheArrays) {
  write_mesh(labelled_box(), temporary / "in.vtu");
  const Scene scene = parse_scene("[environment]\nmesh = '" + (temporary / "in.vtu").string() + R"('
free = { array = "free", values = [1] }
[[particles]]
count = 60
velocity = [1.0, 0.5, 0.25]
[[event]]
at = 0.2
kind = "cut"
surface = "plane"
point = [3.4, 1.5, 1.5]
normal = [1.0, 0.3, 0.0]
width = 0.25
[[event]]
at = 0.7
kind = "carve"
tool = "box"
low = [0.4, 0.4, 0.3]
high = [1.3, 1.6, 1.7]
[motion]
dt = 0.1
steps = 10
[output]
every = 5
)",
                                  "test.toml");
  RunOptions options;
  options.folder = folder;
  run_scene(scene, options);
  options.folder = temporary / "two";
  options.steps = 5;
  run_scene(scene, options);
  options.steps = 10;
  options.resume = true;
  run_scene(scene, options);
  for (const char* name : {"environment_000005.vtu", "environment_000010.vtu", "stats.csv"})
    EXPECT_EQ(read_bytes(folder / name), read_bytes(options.folder / name)) << name;
  const MeshData last = read_mesh(folder / "environment_000010.vtu").mesh;
  EXPECT_GT(last.cell_count(), 60U);
  EXPECT_EQ(array(last.point_data, "place").components, 3U);
}

}  // namespace dartcast::environment_record_test
