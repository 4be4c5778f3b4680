// Pages of trajectories: their frames against the points of the way, the cells passed against the map.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/trajectory.hpp"
#include "report/page_reader.hpp"

namespace dartcast::trajectory_page_test {

namespace fs = std::filesystem;
using test::PageReader;

MeshData mesh_of(unsigned dimension) {
  if (dimension == 2) {
    RectangleOptions rectangle;
    rectangle.cells = {6, 6};
    rectangle.size = {6.0, 6.0};
    rectangle.jitter = 0.2;
    return generate_rectangle(rectangle);
  }
  BoxOptions box;
  box.cells = {5, 5, 5};
  box.size = {5.0, 5.0, 5.0};
  box.mixed = true;
  box.jitter = 0.2;
  return generate_box(box);
}

std::vector<Trace> traces_of(Environment& environment) {
  const double z = environment.map().dimension() == 2 ? 0.0 : 1.0;
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.6, 0.7, 0.55 * z}});
  return environment.trace(particles, 0, std::vector<Vec3>{{4.3, 1.2, 3.1 * z}, {2.5, 9.0, 2.2 * z}});
}

PageReader page_of(const std::string& html) {
  const fs::path file = fs::temp_directory_path() / ("dartcast_trajectory_" + std::to_string(::getpid()) + ".html");
  std::ofstream(file, std::ios::binary) << html;
  PageReader page(file);
  fs::remove(file);
  return page;
}

std::set<Cell> cells_of(const std::vector<TrajectoryPoint>& points) {
  std::set<Cell> cells;
  for (const TrajectoryPoint& p : points) {
    cells.insert(p.cell);
    if (p.next.valid()) cells.insert(p.next);
  }
  return cells;
}

class TrajectoryPage : public testing::TestWithParam<unsigned> {};

TEST_P(TrajectoryPage, HasAFrameForEachPoint) {
  Environment environment(mesh_of(GetParam()));
  const std::vector<Trace> traces = traces_of(environment);
  const std::vector<TrajectoryPoint> points = trajectory_points(traces);
  ASSERT_GT(points.size(), 6U);
  ASSERT_TRUE(traces.back().result.stopped);
  const PageReader page = page_of(trajectory_html(environment.complex(), traces));
  ASSERT_EQ(page.meta.at("frames").size(), points.size());
  ASSERT_EQ(page.meta.at("events").size(), points.size());
  const auto places = page.series<std::uint16_t>(page.meta.at("particles").at("position"), 3);
  const auto kinds = page.series<std::uint8_t>(page.meta.at("particles").at("kind"), 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = page.position(places.data() + 3 * i);
    EXPECT_NEAR(x[0], points[i].point.x, page.tolerance());
    EXPECT_NEAR(x[1], points[i].point.y, page.tolerance());
    EXPECT_NEAR(x[2], points[i].point.z, page.tolerance());
    EXPECT_EQ(kinds[i], static_cast<std::uint8_t>(points[i].kind));
    EXPECT_EQ(page.meta.at("events").at(i).at("step"), i);
  }
  EXPECT_EQ(page.meta.at("contacts").at("count"), 1U);
}

TEST_P(TrajectoryPage, HasTheFacesAroundTheCellsPassed) {
  Environment environment(mesh_of(GetParam()));
  const CombinatorialMap& map = environment.map();
  const std::vector<Trace> traces = traces_of(environment);
  const PageReader page = page_of(trajectory_html(environment.complex(), traces));
  const std::set<Cell> cells = cells_of(trajectory_points(traces));
  // By darts: a face that two of the cells share counts once.
  std::set<std::set<std::uint32_t>> faces;
  std::size_t shown = 0;
  for (const Cell c : cells) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      std::set<std::uint32_t> corners;
      for (const std::uint16_t k : view.shape().corners(f)) corners.insert(view.vertex(k).value);
      if (faces.insert(corners).second) shown += GetParam() == 2 ? 1 : corners.size() - 2;  // as triangles
    }
  }
  const auto patches = page.block<std::uint16_t>(page.meta.at("walls").at(0).at("face_patch"));
  const auto patch = page.meta.at("trajectory").at("patch").get<std::uint16_t>();
  EXPECT_EQ(page.meta.at("patches").at(patch), "cells passed");
  EXPECT_EQ(static_cast<std::size_t>(std::count(patches.begin(), patches.end(), patch)), shown);
}

INSTANTIATE_TEST_SUITE_P(InThePlaneAndInSpace, TrajectoryPage, testing::Values(2U, 3U));

TEST(TrajectoryPages, RefuseNothingToShow) {
  Environment environment(mesh_of(3));
  EXPECT_THROW((void)trajectory_html(environment.complex(), {}), InvalidArgument);
}

TEST(TrajectoryPages, ShowAnEvenChoiceOfManyPoints) {
  Environment environment(mesh_of(2));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.6, 0.7, 0.0}});
  std::vector<Vec3> targets;
  for (int i = 0; i < 1500; ++i) targets.push_back({i % 2 == 0 ? 1.6 : 0.6, 0.7, 0.0});
  const std::string html = trajectory_html(environment.complex(), environment.trace(particles, 0, targets));
  EXPECT_EQ(page_of(html).meta.at("frames").size(), 2000U);
  EXPECT_NE(html.find("2000 of 30"), std::string::npos);
  EXPECT_LT(html.size(), 2'000'000U);
}

}  // namespace dartcast::trajectory_page_test
