// Ends that are sewn, and gaps that are filled: exact volumes, and who is connected again.
#include <algorithm>
#include <cmath>

#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/expectations.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::reconnect_test {

using test::Dyadic;
using test::MeshKind;
using test::volume6;

MeshData free_box(std::array<std::uint32_t, 3> cells, CellType type = CellType::hexahedron, bool mixed = false) {
  MeshData mesh = test::blocked_box(cells, type, mixed);
  mesh.free.clear();
  return mesh;
}

// Two meshes in one, the second moved.
MeshData both(MeshData a, const MeshData& b, const Vec3& shift) {
  const auto base = static_cast<std::uint32_t>(a.points.size());
  for (const Vec3& x : b.points) a.points.push_back(x + shift);
  for (std::size_t c = 0; c < b.cell_count(); ++c) {
    std::vector<std::uint32_t> corners(b.cell(c).begin(), b.cell(c).end());
    for (std::uint32_t& v : corners) v += base;
    a.add_cell(b.types[c], corners);
  }
  if (!a.free.empty()) a.free.insert(a.free.end(), b.free.begin(), b.free.end());
  return a;
}

std::vector<CellFace> faces_at(ComplexEdit& edit, double z, double within = 1e-9) {
  return open_faces(edit, edit.map().cells(), {{0, 0, 1}, z}, within);
}

// The number of parts that all cells fall into.
std::size_t count_parts(CombinatorialMap map) {
  for (const Cell c : map.cells()) map.set_free(c, true);
  return test::count_rooms(map);
}

class Reconnecting : public testing::TestWithParam<MeshKind> {
 protected:
  static MeshData box(std::array<std::uint32_t, 3> cells) { return free_box(cells, GetParam().type, GetParam().mixed); }
};
constexpr MeshKind matching[] = {{"hexahedra", CellType::hexahedron, false},
                                 {"tetrahedra", CellType::tetrahedron, false},
                                 {"prisms", CellType::prism, false},
                                 {"pyramids", CellType::pyramid, false}};
INSTANTIATE_TEST_SUITE_P(Surgery, Reconnecting, testing::ValuesIn(matching),
                         [](const auto& i) { return std::string(i.param.name); });
// Cut at random: the faces of two boxes do not match.
INSTANTIATE_TEST_SUITE_P(Mixed, Reconnecting, testing::Values(MeshKind{"mixed", CellType::hexahedron, true}),
                         [](const auto& i) { return std::string(i.param.name); });

// Those whose boxes match.
class ReconnectingAlike : public Reconnecting {};
INSTANTIATE_TEST_SUITE_P(Surgery, ReconnectingAlike, testing::ValuesIn(matching),
                         [](const auto& i) { return std::string(i.param.name); });

// Two boxes whose faces match, the second a little off: sewn, with the first one's corners kept.
TEST_P(ReconnectingAlike, SewsFacesThatLieTogether) {
  for (const double off : {0.0, 0.0625}) {
    CellComplex complex(both(box({3, 2, 2}), box({3, 2, 2}), {off, 0, 2.0 + off}));
    const std::size_t faces = complex.map().wall_face_count();
    EXPECT_EQ(count_parts(complex.map()), 2U);
    ComplexEdit edit(complex);
    const auto low = faces_at(edit, 2.0, 1e-3);
    const auto all = faces_at(edit, 2.0 + off, 1e-3);
    std::vector<CellFace> high;
    for (const CellFace& f : all) {
      if (std::find(low.begin(), low.end(), f) == low.end() || off == 0.0) high.push_back(f);
    }
    std::vector<CellFace> a;
    std::vector<CellFace> b;
    for (const CellFace& f : off == 0.0 ? all : low) {
      if (edit.map().source(f.cell) < edit.map().cell_count() / 2) a.push_back(f);
    }
    for (const CellFace& f : high) {
      if (edit.map().source(f.cell) >= edit.map().cell_count() / 2) b.push_back(f);
    }
    const Reconnected joined = reconnect(edit, a, b);
    EXPECT_EQ(joined.how, Reconnection::sewn);
    EXPECT_NEAR(joined.shift, off * std::sqrt(2.0), 1e-12);
    edit.commit();
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_EQ(count_parts(complex.map()), 1U);
    EXPECT_EQ(complex.map().wall_face_count(), faces - 2 * a.size());
    EXPECT_TRUE(volume6(complex) == Dyadic(6.0 * (24 + off * 6)));
  }
}

// Reconnects the faces that unsewing opened.
TEST_P(Reconnecting, UndoesACutAlongFaces) {
  CellComplex complex(box({3, 3, 4}));
  const Dyadic before = volume6(complex);
  const std::size_t faces = complex.map().wall_face_count();
  ComplexEdit part(complex);
  const ConvexTool tools[] = {box_tool({0, 0, 1}, {3, 3, 2})};
  carve(part, complex.map().cells(), tools, Carving::remove);
  part.commit();
  EXPECT_EQ(count_parts(complex.map()), 2U);
  EXPECT_TRUE(volume6(complex) == before - Dyadic(6.0 * 9));

  ComplexEdit edit(complex);
  const auto a = faces_at(edit, 1.0);
  const auto b = faces_at(edit, 2.0);
  Reconnected joined = reconnect(edit, a, b);
  const bool alike = GetParam().type == CellType::hexahedron || GetParam().type == CellType::pyramid;
  if (alike && !GetParam().mixed) EXPECT_EQ(joined.how, Reconnection::paired);
  joined.cells = test::now(edit.commit(), joined.cells);
  test::expect_sound(complex);
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(joined.cells.size(), joined.how == Reconnection::paired ? a.size() : 1U);
  EXPECT_EQ(count_parts(complex.map()), 1U);
  EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  EXPECT_TRUE(volume6(complex) == before);
  EXPECT_TRUE(volume6(complex, joined.cells) == Dyadic(6.0 * 9));
  if (alike && !GetParam().mixed) EXPECT_EQ(complex.map().wall_face_count(), faces);
}

TEST(Reconnect, FillsBetweenEndsThatDoNotMatch) {
  for (const CellType type : {CellType::tetrahedron, CellType::prism, CellType::hexahedron}) {
    MeshData finer = free_box({4, 4, 2}, type);
    for (Vec3& x : finer.points) x = {x.x * 0.5, x.y * 0.5, x.z};
    CellComplex complex(both(free_box({2, 2, 2}), finer, {0, 0, 3.0}));
    ComplexEdit edit(complex);
    const Reconnected joined = reconnect(edit, faces_at(edit, 2.0), faces_at(edit, 3.0));
    EXPECT_EQ(joined.how, Reconnection::bridged);
    edit.commit();
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_EQ(count_parts(complex.map()), 1U);
    EXPECT_TRUE(volume6(complex) == Dyadic(6.0 * (8 + 8 + 4)));
  }
}

// Ends across from each other at an angle, and turned.
TEST(Reconnect, FillsBetweenEndsAtAnAngle) {
  MeshData upper = free_box({2, 2, 2});
  for (Vec3& x : upper.points) {
    const Vec3 y = x - Vec3{1, 1, 0};
    const double c = std::cos(0.3);
    const double s = std::sin(0.3);
    x = {1.1 + c * y.x - s * y.y, 0.9 + s * y.x + c * y.y, 0.3 * y.x + y.z};
  }
  CellComplex complex(both(free_box({2, 2, 2}), upper, {0, 0, 3.5}));
  ComplexEdit edit(complex);
  std::vector<CellFace> b;
  for (const CellFace& f :
       open_faces(edit, edit.map().cells(), plane_through({1.1, 0.9, 3.5}, {-0.285, -0.0885, 1}), 0.1))
    b.push_back(f);
  ASSERT_EQ(b.size(), 4U);
  const Reconnected joined = reconnect(edit, faces_at(edit, 2.0), b);
  EXPECT_EQ(joined.how, Reconnection::paired);
  edit.commit();
  test::expect_sound(complex);
  EXPECT_EQ(count_parts(complex.map()), 1U);
}

// The edge that faces the other end is nearest to the wrong one there.
TEST(Reconnect, MatchesTheWholeEndsNotTheirNearestEdges) {
  for (const Vec3& shift : {Vec3{1.2, 0, 1.3}, Vec3{-1.2, 0, 1.3}, Vec3{0, 1.2, 1.3}, Vec3{0, -1.2, 1.3}}) {
    CellComplex complex(both(free_box({1, 1, 1}), free_box({1, 1, 1}), shift));
    ComplexEdit edit(complex);
    EXPECT_EQ(reconnect(edit, faces_at(edit, 1.0), faces_at(edit, 1.3)).how, Reconnection::paired);
    edit.commit();
    test::expect_sound(complex);
    EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 2.3), 1e-12));
  }
}

// A piece of a vessel is cut out across the tissue and the lumen.
class Vessel {
 public:
  Vessel(const Plane& low, const Plane& high) : complex(made()), low_(low), high_(high) {
    const ConvexTool tools[] = {{{low.turned(), high}, 0.3e-3}};
    ComplexEdit edit(complex);
    const Carved carved = carve(edit, cells_near(complex, tools), tools, Carving::remove);
    edit.commit();
    EXPECT_GE(carved.removed, 40U);
    EXPECT_TRUE(carved.whole.empty());
    test::expect_sound(complex);
    EXPECT_EQ(test::count_rooms(complex.map()), 2U);
  }

  Reconnected reconnect_ends(bool lumen_only, const ReconnectOptions& options) {
    ComplexEdit edit(complex);
    std::vector<CellFace> ends[2];
    for (const int i : {0, 1}) {
      ends[i] = open_faces(edit, edit.map().cells(), i == 0 ? low_ : high_, 0.02e-3);
      if (lumen_only) std::erase_if(ends[i], [&](const CellFace& f) { return !edit.map().is_free(f.cell); });
    }
    Reconnected joined = reconnect(edit, ends[0], ends[1], options);
    joined.cells = test::now(edit.commit(), joined.cells);
    test::expect_sound(complex);
    return joined;
  }

  static MeshData made() {
    VesselOptions o;
    o.core = 2;
    o.rings = 1;
    o.out_of_plane = 0.0;
    return generate_vessel(o);
  }

  CellComplex complex;

 private:
  Plane low_, high_;
};

// Within a layer of cells the ends match: the piece is put back, lumen and tissue.
TEST(Reconnect, ReplacesAPieceOfAVessel) {
  Vessel vessel({{0, 0, 1}, -14.2e-3}, {{0, 0, 1}, -13.7e-3});
  const Dyadic before = volume6(CellComplex(Vessel::made()));
  const Reconnected joined = vessel.reconnect_ends(false, {1e-6, {}});
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  EXPECT_EQ(joined.how, Reconnection::paired);
  EXPECT_EQ(joined.cells.size(), 40U);
  EXPECT_EQ(test::count_rooms(vessel.complex.map()), 1U);
  EXPECT_EQ(count_parts(vessel.complex.map()), 1U);
  EXPECT_TRUE(test::near(volume6(vessel.complex), before, 1e-12 * 6.0 * 4e-6));
}

// The same ends sewn: the vessel is shorter by the piece there.
TEST(Reconnect, SewsAVesselWithoutAPiece) {
  Vessel vessel({{0, 0, 1}, -14.2e-3}, {{0, 0, 1}, -13.7e-3});
  const Reconnected joined = vessel.reconnect_ends(false, {10.0, {}});
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  EXPECT_EQ(joined.how, Reconnection::sewn);
  EXPECT_NEAR(joined.shift, 0.5e-3, 1e-9);
  EXPECT_EQ(test::count_rooms(vessel.complex.map()), 1U);
}

// Across layers they don't: the lumen is one cell there.
TEST(Reconnect, BridgesTheLumenOfAVessel) {
  Vessel vessel(plane_through({0, 0, -15e-3}, {0, 0.4, 1.0}), plane_through({0, 0, -12e-3}, {0.4, 0, 1.0}));
  const Reconnected joined = vessel.reconnect_ends(true, {});
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  EXPECT_EQ(joined.how, Reconnection::bridged);
  EXPECT_EQ(test::count_rooms(vessel.complex.map()), 1U);
  EXPECT_TRUE(vessel.complex.map().is_free(joined.cells.at(0)));
}

TEST(Reconnect, GivesNewFacesAtTheSideAPatch) {
  MeshData mesh = both(free_box({1, 1, 1}), free_box({1, 1, 1}), {0, 0, 2.0});
  CellComplex complex(mesh);
  ComplexEdit edit(complex);
  const Patch side = edit.map().patch("xmin");
  const Reconnected joined = reconnect(edit, faces_at(edit, 1.0), faces_at(edit, 2.0), {0.1, side});
  ASSERT_EQ(joined.cells.size(), 1U);
  edit.commit();
  const Cell c = joined.cells[0];
  EXPECT_EQ(c.pool(), Cell(static_cast<std::uint32_t>(CellType::hexahedron), 0).pool());
  std::size_t sides = 0;
  for (std::uint16_t f = 0; f < 6; ++f) {
    const bool open = !complex.map().view(c).neighbour(f).valid();
    EXPECT_EQ(complex.map().patch(CellFace{c, f}), open ? side : Patch{});
    sides += open ? 1 : 0;
  }
  EXPECT_EQ(sides, 4U);
}

TEST(Reconnect, RefusesWithoutAChange) {
  MeshData mesh = both(free_box({2, 2, 1}), free_box({2, 2, 1}), {0, 0, 2.0});
  mesh = both(mesh, free_box({3, 1, 1}), {0, 0, 5.0});
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[0] = 0;
  CellComplex complex(mesh);
  { ComplexEdit first(complex); }
  const test::Before before(complex);
  ComplexEdit edit(complex);
  const auto a = faces_at(edit, 1.0);
  const auto b = faces_at(edit, 2.0);
  const auto c = faces_at(edit, 5.0);
  const auto expect = [&](auto act, std::initializer_list<const char*> parts) {
    test::expect_parts(test::refusal(act), parts);
  };
  expect([&] { reconnect(edit, a, {}); }, {"invalid", "no faces"});
  expect([&] { reconnect(edit, a, a); }, {"invalid", "in common"});
  expect([&] { reconnect(edit, a, b, {-1.0, {}}); }, {"invalid", "tolerance"});
  expect([&] { reconnect(edit, a, b, {0.1, Patch{99}}); }, {"invalid", "patch"});
  const std::vector<CellFace> twice = {b[0], b[0]};
  expect([&] { reconnect(edit, a, twice); }, {"invalid", "cell 4", "twice"});
  const std::vector<CellFace> gone = {CellFace{Cell(1, 999), 0}};
  expect([&] { reconnect(edit, a, gone); }, {"invalid", "no such face"});
  expect([&] { reconnect(edit, a, c); }, {"refused", "free and blocked"});
  const std::vector<CellFace> pinched = {b[0], b[3]};
  expect([&] { reconnect(edit, c, pinched); }, {"refused", "rim"});
  const Cell first = edit.map().cells()[0];
  for (std::uint16_t f = 0; f < 6; ++f) {
    if (!edit.map().view(first).neighbour(f).valid()) continue;
    const std::vector<CellFace> inner = {CellFace{first, f}};
    expect([&] { reconnect(edit, inner, c); }, {"refused", "cell 0", "neighbour"});
    break;
  }
  before.expect_unchanged();
}

}  // namespace dartcast::reconnect_test
