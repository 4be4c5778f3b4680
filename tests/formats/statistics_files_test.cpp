// Files of statistics, read back by VTK.
#include "dartcast/statistics_files.hpp"

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::statistics_files_test {

vtkSmartPointer<vtkPolyData> read(const std::filesystem::path& file) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

double value(vtkDataArray* array, vtkIdType i, int component = 0) {
  if (array == nullptr) throw Error("the array is not there");
  return array->GetComponent(i, component);
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
  ASSERT_EQ(walls->GetNumberOfPolys(), 10);
  EXPECT_EQ(walls->GetNumberOfPoints(), 12);
  vtkCellData* data = walls->GetCellData();
  auto* names = vtkStringArray::SafeDownCast(walls->GetFieldData()->GetAbstractArray("patch_names"));
  ASSERT_NE(names, nullptr);
  ASSERT_EQ(names->GetNumberOfValues(), 6);
  double sum = 0.0;
  for (vtkIdType c = 0; c < 10; ++c) {
    const auto patch = static_cast<vtkIdType>(value(data->GetArray("patch"), c));
    const std::string name = names->GetValue(patch - 1);
    double bounds[6];
    walls->GetCellBounds(c, bounds);
    const double middle = 0.5 * (bounds[0] + bounds[1]);
    const double area = name.ends_with("xmin") || name.ends_with("xmax") ? 15.0 : name.find("y") < 9 ? 10.0 : 6.0;
    const bool hit = (name.ends_with("zmin") && middle == 1.0) || (name.ends_with("ymax") && middle == 1.0) ||
                     name.ends_with("xmax");
    EXPECT_EQ(value(data->GetArray("hits"), c), hit ? 2.0 : 0.0) << name;
    EXPECT_DOUBLE_EQ(value(data->GetArray("hits_per_area"), c), hit ? 2.0 / area : 0.0) << name;
    EXPECT_EQ(value(data->GetArray("cell"), c), middle > 2.0 ? 1.0 : 0.0);
    sum += value(data->GetArray("hits"), c);
  }
  EXPECT_EQ(sum, 6.0);
  EXPECT_THROW(write_wall_hits(environment, hits, folder / "walls.vtu"), InvalidArgument);
}

TEST(WallHitsFile, HasTheWallsOfFreeCellsAlone) {
  Environment environment(generate_bar());
  const test::Folder folder;
  write_wall_hits(environment, {}, folder / "walls.vtp");
  const auto walls = read(folder / "walls.vtp");
  EXPECT_EQ(walls->GetNumberOfPolys(), static_cast<vtkIdType>(environment.map().wall_face_count()));
  EXPECT_EQ(walls->GetNumberOfPolys(), 3 * 26 * 4 + 2 * 9);
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
  ASSERT_EQ(walls->GetNumberOfLines(), 6);
  double sum = 0.0;
  for (vtkIdType c = 0; c < 6; ++c) sum += value(walls->GetCellData()->GetArray("hits_per_area"), c);
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
  ASSERT_EQ(lines->GetNumberOfLines(), 3);
  ASSERT_EQ(lines->GetNumberOfPoints(), 12);
  const std::vector<double> ids = {3.0, 7.0, 12.0};
  vtkNew<vtkIdList> corners;
  for (vtkIdType line = 0; line < 3; ++line) {
    const double id = ids[static_cast<std::size_t>(line)];
    EXPECT_EQ(value(lines->GetCellData()->GetArray("id"), line), id);
    lines->GetCellPoints(line, corners);
    const vtkIdType size = id == 12.0 ? 2 : 5;
    ASSERT_EQ(corners->GetNumberOfIds(), size);
    for (vtkIdType k = 0; k < size; ++k) {
      const vtkIdType p = corners->GetId(k);
      const double step = static_cast<double>(k + 5 - size);
      EXPECT_EQ(lines->GetPoint(p)[0], id);
      EXPECT_EQ(lines->GetPoint(p)[1], step);
      EXPECT_EQ(value(lines->GetPointData()->GetArray("time"), p), 0.5 * step);
      EXPECT_EQ(value(lines->GetPointData()->GetArray("velocity"), p, 2), id);
      EXPECT_EQ(value(lines->GetPointData()->GetArray("contact"), p), step == 4.0 ? 1.0 : 0.0);
    }
  }
  write_pathlines({}, folder / "none.vtp");
  EXPECT_EQ(read(folder / "none.vtp")->GetNumberOfLines(), 0);
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
  ASSERT_EQ(lines->GetNumberOfLines(), 10);
  vtkNew<vtkIdList> corners;
  std::size_t contacts = 0;
  std::size_t rebounds = 0;
  for (vtkIdType line = 0; line < 10; ++line) {
    EXPECT_EQ(value(lines->GetCellData()->GetArray("id"), line), 2.0 * static_cast<double>(line));
    lines->GetCellPoints(line, corners);
    const double start = lines->GetPoint(corners->GetId(0))[0];
    for (vtkIdType k = 0; k < corners->GetNumberOfIds(); ++k) {
      const vtkIdType p = corners->GetId(k);
      const double way = start + 2.0 * value(lines->GetPointData()->GetArray("time"), p);
      EXPECT_NEAR(lines->GetPoint(p)[0], way <= 4.0 ? way : 8.0 - way, 1e-9);
      contacts += value(lines->GetPointData()->GetArray("contact"), p) > 0.0 ? 1 : 0;
    }
    const bool met = start > 2.0;
    rebounds += met ? 1 : 0;
    EXPECT_EQ(corners->GetNumberOfIds(), 101 + (met ? 1 : 0));
  }
  EXPECT_EQ(contacts, rebounds);
  EXPECT_GT(rebounds, 0U);
}

}  // namespace dartcast::statistics_files_test
