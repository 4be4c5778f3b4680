// Files of statistics, read back.
#include "dartcast/statistics_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/vtk/vtk_grid.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::statistics_files_test {

struct Vtp : VtkGrid {
  [[nodiscard]] std::size_t count(std::uint8_t type) const {
    return static_cast<std::size_t>(std::count(types.begin(), types.end(), type));
  }
  [[nodiscard]] std::vector<std::uint32_t> cell(std::size_t c) const {
    const auto begin = connectivity.begin();
    return {begin + static_cast<std::ptrdiff_t>(offsets[c]), begin + static_cast<std::ptrdiff_t>(offsets[c + 1])};
  }
};

Vtp read(const std::filesystem::path& file) { return {read_vtk_xml_grid(read_bytes(file), "PolyData", 0)}; }

double value(const std::vector<VtkArray>& arrays, const char* name, std::size_t i, std::size_t component = 0) {
  const VtkArray* array = find_array(arrays, name);
  if (array == nullptr) throw Error("the array is not there");
  return array->values.at(i * array->components + component);
}

TEST(WallHitsFile, HasEveryWallWithItsHitsAndArea) {
  BoxOptions box;
  box.cells = {2, 1, 1};
  box.size = {4.0, 3.0, 5.0};
  Environment environment(generate_box(box));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1.0, 1.0, 1.0}, {1.5, 1.0, 1.0}, {3.0, 1.0, 1.0}});
  WallHits hits;
  for (int i = 0; i < 2; ++i) {
    Particles now = particles;
    const std::vector<Vec3> targets = {{1.0, 1.0, -9.0}, {1.5, 9.0, 1.0}, {9.0, 1.0, 1.0}};
    hits.add(environment, environment.advance(now, targets).contacts);
  }
  const test::Folder folder;
  write_wall_hits(environment, hits, folder / "walls.vtp");
  const auto walls = read(folder / "walls.vtp");
  ASSERT_EQ(walls.count(vtk_polygon), 10U);
  EXPECT_EQ(walls.points.size(), 12U);
  const auto& data = walls.cell_data;
  const VtkArray* names = find_array(walls.field, "patch_names");
  ASSERT_NE(names, nullptr);
  ASSERT_EQ(names->texts.size(), 6U);
  double sum = 0.0;
  for (std::size_t c = 0; c < 10; ++c) {
    const auto patch = static_cast<std::size_t>(value(data, "patch", c));
    const std::string name = names->texts.at(patch - 1);
    const auto corners = walls.cell(c);
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end(), [&](std::uint32_t p, std::uint32_t q) {
      return walls.points[p].x < walls.points[q].x;
    });
    const double middle = 0.5 * (walls.points[*low].x + walls.points[*high].x);
    const double area = name.ends_with("xmin") || name.ends_with("xmax") ? 15.0 : name.find("y") < 9 ? 10.0 : 6.0;
    const bool hit = (name.ends_with("zmin") && middle == 1.0) || (name.ends_with("ymax") && middle == 1.0) ||
                     name.ends_with("xmax");
    EXPECT_EQ(value(data, "hits", c), hit ? 2.0 : 0.0) << name;
    EXPECT_DOUBLE_EQ(value(data, "hits_per_area", c), hit ? 2.0 / area : 0.0) << name;
    EXPECT_EQ(value(data, "cell", c), middle > 2.0 ? 1.0 : 0.0);
    sum += value(data, "hits", c);
  }
  EXPECT_EQ(sum, 6.0);
  EXPECT_THROW(write_wall_hits(environment, hits, folder / "walls.vtu"), InvalidArgument);
}

TEST(WallHitsFile, HasTheWallsOfFreeCellsAlone) {
  Environment environment(generate_bar());
  const test::Folder folder;
  write_wall_hits(environment, {}, folder / "walls.vtp");
  const auto walls = read(folder / "walls.vtp");
  EXPECT_EQ(walls.count(vtk_polygon), environment.map().wall_face_count());
  EXPECT_EQ(walls.count(vtk_polygon), 3U * 26 * 4 + 2 * 9);
}

TEST(WallHitsFile, InThePlaneTheWallsAreLines) {
  RectangleOptions rectangle;
  rectangle.cells = {2, 1};
  rectangle.size = {4.0, 3.0};
  Environment environment(generate_rectangle(rectangle));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1.0, 1.0, 0.0}});
  WallHits hits;
  hits.add(environment, environment.advance(particles, std::vector<Vec3>{{1.0, -1.0, 0.0}}).contacts);
  const test::Folder folder;
  write_wall_hits(environment, hits, folder / "walls.vtp");
  const auto walls = read(folder / "walls.vtp");
  ASSERT_EQ(walls.count(vtk_poly_line), 6U);
  double sum = 0.0;
  for (std::size_t c = 0; c < 6; ++c) sum += value(walls.cell_data, "hits_per_area", c);
  EXPECT_DOUBLE_EQ(sum, 0.5);
}

// Points of a step come by particle, those of the next step behind them.
TEST(PathlinesFile, HasAPolylineForEachParticle) {
  std::vector<PathPoint> points;
  for (int step = 0; step < 5; ++step) {
    for (const std::uint64_t id : {7U, 3U, 12U}) {
      if (id == 12 && step < 3) continue;
      const double x = static_cast<double>(id);
      points.push_back({id, 0.5 * step, {x, 1.0 * step, 0.0}, {0.0, 2.0, x}, step == 4});
    }
  }
  const test::Folder folder;
  write_pathlines(points, folder / "lines.vtp");
  const auto lines = read(folder / "lines.vtp");
  ASSERT_EQ(lines.count(vtk_poly_line), 3U);
  ASSERT_EQ(lines.points.size(), 12U);
  const std::vector<double> ids = {3.0, 7.0, 12.0};
  for (std::size_t line = 0; line < 3; ++line) {
    const double id = ids[line];
    EXPECT_EQ(value(lines.cell_data, "id", line), id);
    const std::vector<std::uint32_t> corners = lines.cell(line);
    const std::size_t size = id == 12.0 ? 2 : 5;
    ASSERT_EQ(corners.size(), size);
    for (std::size_t k = 0; k < size; ++k) {
      const std::uint32_t p = corners[k];
      const double step = static_cast<double>(k + 5 - size);
      EXPECT_EQ(lines.points[p].x, id);
      EXPECT_EQ(lines.points[p].y, step);
      EXPECT_EQ(value(lines.point_data, "time", p), 0.5 * step);
      EXPECT_EQ(value(lines.point_data, "velocity", p, 2), id);
      EXPECT_EQ(value(lines.point_data, "contact", p), step == 4.0 ? 1.0 : 0.0);
    }
  }
  write_pathlines({}, folder / "none.vtp");
  EXPECT_EQ(read(folder / "none.vtp").count(vtk_poly_line), 0U);
  EXPECT_THROW(write_pathlines({}, folder / "lines.csv"), InvalidArgument);
}

// Particles fly on straight lines to a wall and back.
TEST(PathlinesFile, OfARunHasPointsOnTheKnownLines) {
  const test::Folder folder;
  RunOptions options;
  options.folder = folder / "out";
  run_scene(parse_scene(R"(
[environment]
generator = "box"
cells = [4, 4, 2]
[[particles]]
count = 20
velocity = [2.0, 0.0, 0.0]
[motion]
dt = 0.01
steps = 100
[contact]
restitution = 1.0
[statistics]
pathlines = { every = 2 }
[output]
every = 50
)",
                        "test.toml"),
            options);
  const auto lines = read(folder / "out" / "pathlines.vtp");
  ASSERT_EQ(lines.count(vtk_poly_line), 10U);
  std::size_t contacts = 0;
  std::size_t rebounds = 0;
  for (std::size_t line = 0; line < 10; ++line) {
    EXPECT_EQ(value(lines.cell_data, "id", line), 2.0 * static_cast<double>(line));
    const std::vector<std::uint32_t> corners = lines.cell(line);
    const double start = lines.points[corners[0]].x;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t p = corners[k];
      const double way = start + 2.0 * value(lines.point_data, "time", p);
      EXPECT_NEAR(lines.points[p].x, way <= 4.0 ? way : 8.0 - way, 1e-9);
      contacts += value(lines.point_data, "contact", p) > 0.0 ? 1 : 0;
    }
    const bool met = start > 2.0;
    rebounds += met ? 1 : 0;
    EXPECT_EQ(corners.size(), 101U + (met ? 1 : 0));
  }
  EXPECT_EQ(contacts, rebounds);
  EXPECT_GT(rebounds, 0U);
}

}  // namespace dartcast::statistics_files_test
