// Surfaces that are cut, sewn and refined under particles: who is not touched keeps every bit, nobody leaves the
// surface, and what is opened is a wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/surface.hpp"
#include "support/random_edits.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::surface_edit_test {

// Splits an edge and both faces beside it, so that triangles stay triangles.
Vertex refine(SurfaceEdit& edit, Dart d) {
  const SplitEdge split = split_edge(edit.topology(), d);
  for (const Cell c : split.cells) {
    const CombinatorialMap& map = edit.map();
    std::uint16_t at = 0;
    while (map.origin({c, at}) != split.vertex) ++at;
    const Dart a{c, at};
    split_face(edit.topology(), a, map.phi1(map.phi1(a)));
  }
  return split.vertex;
}

std::vector<SurfacePlace> random_places(const Surface& surface, std::size_t count, Random& random) {
  std::vector<SurfacePlace> places;
  for (std::size_t i = 0; i < count; ++i) places.push_back(test::random_place(surface, random));
  return places;
}

// Every place follows; returns how many have no face any more.
std::size_t follow_all(const Surface& surface, const SurfaceEditReport& report, std::vector<SurfacePlace>& places,
                       double within) {
  std::set<Cell> gone;
  std::map<SimplexId, GoneTriangle> was;
  for (const GoneTriangle& t : report.gone) {
    gone.insert(t.triangle.cell);
    was[t.triangle] = t;
  }
  std::vector<SurfacePlace> kept;
  std::size_t lost = 0;
  for (const SurfacePlace& place : places) {
    const auto now = followed(surface, report, place);
    if (!gone.contains(place.triangle.cell)) {
      EXPECT_TRUE(now && *now == place) << "nothing happened to its face";
      kept.push_back(place);
      continue;
    }
    if (!now) {
      EXPECT_TRUE(report.map.added.empty());
      ++lost;
      continue;
    }
    EXPECT_TRUE(surface.contains(*now));
    const auto& c = was.at(place.triangle).corners;
    const auto& w = place.weights;
    EXPECT_LT(norm(surface.point(*now) - (c[0] * w[0] + c[1] * w[1] + c[2] * w[2])), within);
    kept.push_back(*now);
  }
  places = kept;
  return lost;
}

TEST(SurfaceEdits, WhatIsOpenedIsAWallAndWhatIsSewnIsNone) {
  Surface surface(test::cube());
  const SimplexId t = test::triangle_of(surface, 0);
  unsigned edge = 0;
  while (!surface.across(t, edge).face.valid()) ++edge;
  const CellFace f = surface.across(t, edge).face;
  const SimplexId beyond = surface.across(t, edge).triangle;
  const std::array<Vertex, 3> corners = surface.vertices(t);
  std::array<double, 3> middle = {0.5, 0.5, 0.5};
  middle[edge] = 0.0;
  std::vector<SurfacePlace> places = {surface.place(t, {1.0, 1.0, 1.0}), surface.place(t, middle),
                                      surface.place(beyond, {1.0, 1.0, 1.0})};
  const Vec3 before[] = {surface.point(places[0]), surface.point(places[1]), surface.point(places[2])};
  const auto across = [&](const SurfacePlace& from) {
    const Vec3 a = surface.positions()[corners[(edge + 1) % 3].value];
    const Vec3 b = surface.positions()[corners[(edge + 2) % 3].value];
    return ((a + b) * 0.5 - surface.point(from)) * 1.5;
  };
  SurfacePlace walker = places[0];
  EXPECT_EQ(step(surface, walker, across(walker)).end, SurfaceEnd::arrived);
  EXPECT_NE(walker.triangle.cell, t.cell) << "over the edge";

  SurfaceEdit edit(surface);
  unsew(edit.topology(), f);
  const SurfaceEditReport opened = edit.commit();
  EXPECT_EQ(opened.map.added.size(), 2U);
  EXPECT_EQ(follow_all(surface, opened, places, 1e-300), 0U) << "in the same triangles with the same weights";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(surface.point(places[static_cast<std::size_t>(i)]), before[i]);
  EXPECT_EQ(surface.map().source(places[1].triangle.cell), 0U) << "what was on the edge stays on its side";
  walker = places[0];
  const SurfaceStep stopped = step(surface, walker, across(walker));
  EXPECT_EQ(stopped.end, SurfaceEnd::stopped);
  EXPECT_EQ(walker.triangle.cell, places[0].triangle.cell);
  EXPECT_EQ(walker.kind(), Kind::edge);

  const CombinatorialMap& map = edit.map();
  const Dart here = find_dart(map, places[0].triangle.cell, corners[(edge + 1) % 3], corners[(edge + 2) % 3]);
  const Dart there = find_dart(map, places[2].triangle.cell, corners[(edge + 2) % 3], corners[(edge + 1) % 3]);
  sew(edit.topology(), here, there);
  EXPECT_EQ(follow_all(surface, edit.commit(), places, 1e-300), 0U);
  walker = places[0];
  EXPECT_EQ(step(surface, walker, across(walker)).end, SurfaceEnd::arrived);
  EXPECT_NE(walker.triangle.cell, places[0].triangle.cell);
}

// Parted vertices have higher numbers, so that the triangle beyond begins with another corner.
TEST(SurfaceEdits, WeightsGoAlongWithTheirCorners) {
  Surface surface(test::surface_mesh({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.5}, {0.0, 1.0, 0.5}, {1.0, 1.0, 0.25}},
                                     {{0, 1, 2}, {1, 3, 2}}));
  const SimplexId t = test::triangle_of(surface, 1);
  std::vector<SurfacePlace> places = {surface.place(t, {0.5, 0.25, 0.25}), surface.place(t, {0.125, 0.625, 0.25})};
  const std::array<Vec3, 2> before = {surface.point(places[0]), surface.point(places[1])};
  const Vertex first = surface.vertices(t)[0];
  SurfaceEdit edit(surface);
  unsew(edit.topology(),
        edit.map().face(find_dart(edit.map(), test::triangle_of(surface, 0).cell, Vertex(1), Vertex(2))));
  const SurfaceEditReport report = edit.commit();
  EXPECT_EQ(report.map.created.size(), 2U);
  EXPECT_EQ(follow_all(surface, report, places, 1e-15), 0U);
  EXPECT_NE(surface.positions()[surface.vertices(places[0].triangle)[0].value], surface.positions()[first.value]);
  for (unsigned i = 0; i < 2; ++i) EXPECT_EQ(surface.point(places[i]), before[i]);
}

TEST(SurfaceEdits, ASplitKeepsEveryoneWhereTheyAre) {
  Surface surface(test::sphere(2));
  Random random(5);
  std::vector<SurfacePlace> places = random_places(surface, 500, random);
  SurfaceEdit edit(surface);
  const auto cells = surface.map().cells();
  const Dart d{cells[7], 1};
  const Vec3 a = edit.position(edit.map().origin(d));
  const Vec3 b = edit.position(edit.map().origin(edit.map().phi1(d)));
  const Vertex v = refine(edit, d);
  EXPECT_EQ(edit.position(v), (a + b) * 0.5);
  edit.place(v, a + (b - a) * 0.25);
  const SurfaceEditReport report = edit.commit();
  EXPECT_EQ(report.map.added.size(), 4U);
  EXPECT_EQ(surface.positions()[v.value], a + (b - a) * 0.25);
  EXPECT_EQ(follow_all(surface, report, places, 1e-15), 0U);
  EXPECT_EQ(places.size(), 500U);
  std::vector<Vec3> moved(surface.positions().begin(), surface.positions().end());
  for (Vec3& x : moved) x.z *= 1.5;
  EXPECT_NO_THROW(surface.move(moved)) << "with the new vertex";
  EXPECT_THROW(surface.move(std::span<const Vec3>(moved).first(moved.size() - 1)), InvalidArgument);
}

TEST(SurfaceEdits, ATriangleWithoutAreaIsRefusedAndNothingChanges) {
  Surface surface(test::sphere(1));
  const CombinatorialMap before = [&] {
    const SurfaceEdit counts(surface);
    return surface.map();
  }();
  const std::vector<Vec3> positions(surface.positions().begin(), surface.positions().end());
  {
    SurfaceEdit edit(surface);
    const Dart d{surface.map().cells()[0], 0};
    const Vertex v = split_edge(edit.topology(), d).vertex;
    edit.place(v, edit.position(Vertex(0)));  // on another vertex
    EXPECT_THROW(edit.place(v, {1e200, 0.0, 0.0}), InvalidArgument);
    EXPECT_THROW(edit.place(Vertex(0), {}), InvalidArgument);
    EXPECT_THROW(static_cast<void>(edit.position(Vertex(100000))), InvalidArgument);
    EXPECT_THROW(edit.commit(), EditRefused);
    EXPECT_EQ(surface.map(), before);
    refine(edit, {surface.map().cells()[0], 0});  // and goes on; not committed
  }
  EXPECT_EQ(surface.map(), before);
  EXPECT_TRUE(std::ranges::equal(surface.positions(), positions));
}

TEST(SurfaceEdits, PlacesOfARemovedFaceAreReported) {
  Surface surface(test::sphere(1));
  Random random(2);
  std::vector<SurfacePlace> places = random_places(surface, 200, random);
  const Cell c = places[0].triangle.cell;
  const auto there = std::count_if(places.begin(), places.end(), [&](const auto& p) { return p.triangle.cell == c; });
  SurfaceEdit edit(surface);
  remove(edit.topology(), c);
  EXPECT_EQ(follow_all(surface, edit.commit(), places, 1e-15), static_cast<std::size_t>(there));
}

// Edits at random while particles move: they stay on the surface, and in its free faces.
TEST(SurfaceEdits, AtRandomLoseNobody) {
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(20, 1000); ++seed) {
    Surface surface(seed % 2 == 0 ? test::bumpy(2, 0.1, seed) : test::sphere(2));
    Random random(seed);
    std::vector<SurfacePlace> places = random_places(surface, 100, random);
    test::CellBag bag(surface.map());
    std::size_t edits = 0;
    for (int i = 0; i < 60; ++i) {
      SurfaceEditReport report;
      double within = 10.0;  // faces that are not plane are fanned anew: what is on them moves with the surface
      {
        SurfaceEdit edit(surface);
        const Cell c = bag.draw(edit.map(), random);
        try {
          if (random.below(2) == 0) {
            const Dart d{c, static_cast<std::uint16_t>(random.below(edit.map().shape(c).dart_count()))};
            const Dart beyond = edit.map().phi2(d);
            const auto is_triangle = [&](Cell f) { return edit.map().shape(f).face_count() == 3; };
            if (is_triangle(c) && (!beyond.valid() || is_triangle(beyond.cell))) within = 1e-14;
            refine(edit, d);
          } else {
            const auto kind = test::draw_kind(bag, 60, random, 2);
            test::apply(edit.topology(), test::draw_edit(edit.map(), kind, c, bag, random));
          }
          report = edit.commit();
        } catch (const EditRefused&) {
          continue;
        }
      }
      ++edits;
      bag.update(report.map);
      ASSERT_TRUE(check_integrity(surface.map(), report.map.added, 1).empty());
      follow_all(surface, report, places, within);
      if (places.size() < 50) places = random_places(surface, 100, random);
      for (SurfacePlace& place : places) {
        const bool free = surface.map().is_free(place.triangle.cell);
        const SurfaceStep done = step(surface, place, test::random_vector(random) * 0.2);
        ASSERT_TRUE(surface.contains(place));
        ASSERT_EQ(done.end == SurfaceEnd::held, !free);
        ASSERT_TRUE(!free || surface.map().is_free(place.triangle.cell));
      }
    }
    ASSERT_GT(edits, 10U);
    ASSERT_TRUE(check_integrity(surface.map(), 1).empty());
  }
}

}  // namespace dartcast::surface_edit_test
