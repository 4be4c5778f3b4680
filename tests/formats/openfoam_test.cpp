// Meshes of OpenFOAM, in every form that its programs write; planes; parts of several processors; what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include "complex/periodic_faces.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/mesh_selection.hpp"
#include "mesh/baffles.hpp"
#include "output/mesh_report_text.hpp"
#include "support/expectations.hpp"
#include "support/foam_case.hpp"
#include "support/foam_layer.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::test::openfoam_test {

using Loop = std::vector<std::uint32_t>;

Loop from_smallest(std::span<const std::uint32_t> corners) {
  Loop loop(corners.begin(), corners.end());
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  return loop;
}

/// The faces of each cell, seen from outside: all that a cell is, whatever the order of its corners.
std::vector<std::set<Loop>> shapes_of(const MeshData& mesh) {
  std::vector<std::set<Loop>> shapes;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    shapes.emplace_back();
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) { shapes.back().insert(from_smallest(face)); });
  }
  return shapes;
}

std::multiset<std::pair<std::string, std::set<std::uint32_t>>> patches_of(const MeshData& mesh) {
  std::multiset<std::pair<std::string, std::set<std::uint32_t>>> patches;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto face = mesh.patch_face(f);
    patches.insert({mesh.patch_names.at(mesh.patch_tags[f]), {face.begin(), face.end()}});
  }
  return patches;
}

std::vector<std::string> regions_of(const MeshData& mesh) {
  std::vector<std::string> names;
  for (const std::int32_t tag : mesh.regions) names.push_back(mesh.region_names.at(tag));
  return names;
}

/// The mesh that a case made from `mesh` must give: all boundary faces have a patch.
void expect_case(const MeshFile& file, const MeshData& mesh, bool types = true) {
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
  EXPECT_EQ(file.mesh.points, mesh.points);
  EXPECT_EQ(shapes_of(file.mesh), shapes_of(mesh));
  if (types) {
    EXPECT_EQ(file.mesh.types, mesh.types);
  }
  EXPECT_EQ(regions_of(file.mesh), regions_of(mesh));
  auto patches = patches_of(file.mesh);
  std::erase_if(patches, [](const auto& p) { return p.first == "walls"; });
  EXPECT_EQ(patches, patches_of(mesh));
}

/// A box of cells of all types, with regions, patches, and a patch inside.
MeshData box() {
  BoxOptions options;
  options.cells = {4, 3, 3};
  options.size = {1.0, 1.0, 1.0};
  options.mixed = true;
  options.jitter = 0.3;
  MeshData mesh = generate_box(options);
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  mesh.patch_names = {{1, "low"}, {2, "between"}};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    mesh.regions.push_back(c % 2 == 0 ? 1 : 2);
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      const bool low = std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return mesh.points[p].z == 0.0; });
      if (low) mesh.add_patch_face(face, 1);
    });
  }
  mesh.region_names = {{1, "even"}, {2, "odd"}};
  std::map<std::set<std::uint32_t>, int> seen;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      const std::set<std::uint32_t> key(face.begin(), face.end());
      if (++seen[key] == 2 && key.size() == 4) mesh.add_patch_face(face, 2);
    });
  }
  return mesh;
}

TEST(OpenFoam, EveryFormGivesTheSameMesh) {
  for (const MeshData& mesh : {box(), sample_mesh(), polyhedra()}) {
    for (const FoamStyle& style : foam_styles()) {
      SCOPED_TRACE(testing::Message() << style.binary << style.label_bytes << style.big_endian << style.gzip);
      const Folder folder;
      FoamWriter(folder / "case", style).write(foam_mesh(mesh));
      expect_case(read_mesh(folder / "case"), mesh, !(mesh.types == polyhedra().types));
    }
  }
}

TEST(OpenFoam, SinglePrecisionIsReadAsItIs) {
  const MeshData mesh = sample_mesh();
  const Folder folder;
  FoamWriter(folder / "case", {.binary = true, .scalar_bytes = 4}).write(foam_mesh(mesh));
  const MeshFile file = read_mesh(folder / "case");
  ASSERT_EQ(file.mesh.points.size(), mesh.points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    EXPECT_EQ(file.mesh.points[p].x, static_cast<double>(static_cast<float>(mesh.points[p].x)));
  }
}

TEST(OpenFoam, ShapesAreRecognised) {
  const Folder folder;
  FoamWriter(folder / "case", {}).write(foam_mesh(polyhedra()));
  const MeshFile file = read_mesh(folder / "case");
  EXPECT_EQ(file.mesh.types, (std::vector<CellType>{CellType::hexahedron, CellType::pyramid}));
}

TEST(OpenFoam, PathsThatNameACase) {
  const MeshData mesh = sample_mesh();
  const Folder folder;
  FoamWriter(folder / "case", {}).write(foam_mesh(mesh));
  std::filesystem::create_directories(folder / "case/0.5");
  write_bytes(folder / "case/any.foam", "");
  for (const char* path : {"case", "case/", "case/any.foam", "case/constant", "case/constant/polyMesh", "case/0.5"}) {
    SCOPED_TRACE(path);
    expect_case(read_mesh(folder / path), mesh);
  }
}

TEST(OpenFoam, ListsInOtherWords) {
  const MeshData mesh = sample_mesh();
  const Folder folder;
  const FoamWriter writer(folder / "case", {});
  FoamMesh foam = foam_mesh(mesh);
  foam.cell_zones = {};
  writer.write(foam);
  writer.file("constant/polyMesh/cellZones", "regIOobject",
              "( // no count\n all { type cellZone; inGroups 2(a b); cellLabels ( 0 1 /* two */ 3 ); }\n"
              "same { cellLabels List<label> 3{2}; note \"a } in; quotes\"; } none { cellLabels 0(); more { x 1; } }"
              " nothing { cellLabels 0{}; } )");
  const MeshFile file = read_mesh(folder / "case");
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_EQ(regions_of(file.mesh), (std::vector<std::string>{"all", "all", "same", "all"}));
}

TEST(OpenFoam, ACellInSeveralZonesHasTheFirst) {
  const Folder folder;
  FoamMesh foam = foam_mesh(sample_mesh());
  foam.cell_zones = {{"a", {0, 1}}, {"b", {1, 2, 3}}};
  FoamWriter(folder / "case", {}).write(foam);
  const MeshFile file = read_mesh(folder / "case");
  EXPECT_EQ(regions_of(file.mesh), (std::vector<std::string>{"a", "a", "b", "b"}));
  ASSERT_EQ(file.report.warnings.size(), 1U);
  EXPECT_EQ(file.report.warnings[0].kind, "zones");
  EXPECT_EQ(file.report.warnings[0].first, std::vector<std::size_t>{1});
}

// Planes.

MeshData rectangle() {
  RectangleOptions options;
  options.cells = {7, 6};
  options.size = {1.0, 1.0};
  options.mixed = true;
  options.jitter = 0.2;
  MeshData mesh = generate_rectangle(options);
  mesh.regions.assign(mesh.cell_count(), 3);
  mesh.region_names = {{3, "water"}};
  return mesh;
}

TEST(OpenFoam, OneLayerIsAPlane) {
  const MeshData plane = rectangle();
  for (const FoamStyle& style : foam_styles()) {
    const Folder folder;
    FoamWriter(folder / "case", style).write(foam_mesh(layer(plane, -1e-3, 2e-3), {{"sides", "empty"}}));
    const MeshFile file = read_mesh(folder / "case");
    ASSERT_TRUE(file.report.valid()) << report_text(file.report);
    EXPECT_EQ(file.report.dimension, 2);
    expect_case(file, plane);
  }
}

MeshFile read_foam(const FoamMesh& mesh) {
  const Folder folder;
  FoamWriter(folder / "case", {}).write(mesh);
  return read_mesh(folder / "case");
}

void expect_refused(const MeshFile& file, const std::vector<std::string>& words) {
  ASSERT_FALSE(file.report.valid());
  for (const std::string& word : words) {
    EXPECT_NE(file.report.defects[0].message.find(word), std::string::npos) << file.report.defects[0].message;
  }
}

TEST(OpenFoam, PlanesThatAreNone) {
  BoxOptions box;
  box.cells = {3, 2, 2};
  box.size = {1.0, 1.0, 1.0};
  MeshData mesh = generate_box(box);
  expect_refused(read_foam(foam_mesh(mesh, {{"zmin", "empty"}, {"zmax", "empty"}})), {"cell", "one layer"});
  expect_refused(read_foam(foam_mesh(mesh, {{"zmin", "empty"}, {"zmax", "empty"}, {"xmin", "empty"}})), {"one layer"});
  MeshData across = layer(rectangle(), 0.0, 1.0);
  for (Vec3& p : across.points) p = {p.z, p.x, p.y};
  expect_refused(read_foam(foam_mesh(across, {{"sides", "empty"}})),
                 {"across x", "transformPoints", "((1 0 0) (0 0 1))"});
  for (Vec3& p : across.points) p = {p.z, p.x, p.y};
  expect_refused(read_foam(foam_mesh(across, {{"sides", "empty"}})), {"across y", "((0 1 0) (0 0 1))"});
  MeshData bent = layer(rectangle(), 0.0, 1.0);
  bent.points[0].z = 1.5;
  expect_refused(read_foam(foam_mesh(bent, {{"sides", "empty"}})), {"two sides of a layer"});
}

TEST(OpenFoam, EmptyPatchesWithoutFacesAreNoPlane) {
  FoamMesh foam = foam_mesh(sample_mesh());
  foam.patches.push_back({"frontAndBack", "empty"});
  foam.patches.push_back({"axis", "wedge"});
  expect_case(read_foam(foam), sample_mesh());
}

TEST(OpenFoam, PatchTypes) {
  const MeshData mesh = sample_mesh();
  expect_refused(read_foam(foam_mesh(mesh, {{"inlet", "processor"}})), {"inlet", "reconstructParMesh"});
  for (const char* type : {"cyclic", "cyclicAMI", "wedge"}) {
    const MeshFile file = read_foam(foam_mesh(mesh, {{"inlet", type}}));
    ASSERT_EQ(file.report.warnings.size(), 1U) << report_text(file.report);
    EXPECT_EQ(file.report.warnings[0].kind, "cyclic");
    EXPECT_EQ(file.report.warnings[0].count, 1U);
    EXPECT_NE(file.report.warnings[0].message.find("inlet"), std::string::npos);
    EXPECT_EQ(patches_of(file.mesh).count({"inlet", {0, 1, 2, 3}}), 1U);
  }
}

// Pairs of patches.

// A turn by some degrees along x: y is the distance from the z axis. Seen against z it goes clockwise, by negative degrees
// the other way.
MeshData bent(MeshData mesh, double degrees) {
  for (Vec3& p : mesh.points) {
    const double angle = p.x * degrees * std::numbers::pi / 180.0;
    p = {(1.0 + p.y) * std::sin(angle), (1.0 + p.y) * std::cos(angle), degrees < 0.0 ? -p.z : p.z};
  }
  return mesh;
}

const PeriodicPair& only_pair(const MeshFile& file) {
  EXPECT_TRUE(file.report.warnings.empty()) << report_text(file.report);
  EXPECT_EQ(file.mesh.periodic.size(), 1U);
  EXPECT_EQ(file.report.periodic, file.mesh.periodic);
  EXPECT_GT(CellComplex(file.mesh).periodic()->face_count(0), 0U);  // each has a partner
  return file.mesh.periodic.at(0);
}

TEST(OpenFoam, CyclicPatchesArePairs) {
  const std::map<std::string, std::string> cyclic = {{"xmin", "cyclic xmax"}, {"xmax", "cyclic xmin"}};
  const MeshData box = generate_box({.cells = {3, 2, 1}, .size = Vec3{1.0, 1.0, 1.0}});
  PeriodicPair along = only_pair(read_foam(foam_mesh(box, cyclic)));
  EXPECT_EQ(along.a + along.b, "xminxmax");
  EXPECT_EQ(along.translate, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_EQ(along.angle, 0.0);
  // One row of faces: their middles alone would not show a turn.
  for (const double degrees : {1.0, 60.0, 90.0, 170.0}) {
    PeriodicPair turn = only_pair(read_foam(foam_mesh(bent(box, -degrees), cyclic)));
    EXPECT_NEAR(turn.angle, degrees, 1e-9);
    EXPECT_NEAR(norm(turn.axis - Vec3{0.0, 0.0, 1.0}), 0.0, 1e-9);
    EXPECT_NEAR(norm(turn.centre - Vec3{0.0, 0.0, turn.centre.z}), 0.0, 1e-9);
    turn = only_pair(read_foam(foam_mesh(bent(box, degrees), cyclic)));
    EXPECT_NEAR(turn.angle * turn.axis.z, -degrees, 1e-9);
  }
  auto plane = cyclic;
  plane["zmin"] = plane["zmax"] = "empty";
  EXPECT_EQ(only_pair(read_foam(foam_mesh(box, plane))).translate, (Vec3{1.0, 0.0, 0.0}));
  const PeriodicPair in_plane = only_pair(read_foam(foam_mesh(bent(box, -90.0), plane)));
  EXPECT_EQ(in_plane.angle, 90.0);
  EXPECT_EQ(in_plane.axis, (Vec3{0.0, 0.0, 1.0}));
}

TEST(OpenFoam, TwoWedgesAreAPair) {
  const MeshData box = generate_box({.cells = {1, 2, 3}, .size = Vec3{1.0, 1.0, 1.0}});
  for (const double degrees : {1.0, 5.0}) {
    const MeshFile file = read_foam(foam_mesh(bent(box, -degrees), {{"xmin", "wedge"}, {"xmax", "wedge"}}));
    const PeriodicPair& pair = only_pair(file);
    EXPECT_NEAR(pair.angle, degrees, 1e-9);
    EXPECT_NEAR(norm(pair.axis - Vec3{0.0, 0.0, 1.0}) + norm(pair.centre), 0.0, 1e-9);
  }
}

TEST(OpenFoam, CyclicPatchesThatDoNotFitAreWalls) {
  const MeshData box = generate_box({.cells = {3, 2, 1}, .size = Vec3{1.0, 1.0, 1.0}});
  const auto expect_walls = [](const MeshFile& file) {
    EXPECT_TRUE(file.mesh.periodic.empty());
    ASSERT_EQ(file.report.warnings.size(), 1U);
    EXPECT_EQ(file.report.warnings[0].kind, "cyclic");
  };
  expect_walls(read_foam(foam_mesh(box, {{"xmin", "cyclic xmax"}, {"xmax", "cyclic ymin"}})));
  expect_walls(read_foam(foam_mesh(box, {{"xmin", "cyclic xmax"}, {"xmax", "patch"}})));
  expect_walls(read_foam(foam_mesh(box, {{"xmin", "cyclic xmin"}})));
  expect_walls(read_foam(foam_mesh(box, {{"xmin", "cyclic ymin"}, {"ymin", "cyclic xmin"}})));  // 2 faces, and 3
  MeshData other = box;
  for (Vec3& p : other.points) p.y *= 1.0 + 0.01 * p.x;
  expect_walls(read_foam(foam_mesh(other, {{"xmin", "cyclic xmax"}, {"xmax", "cyclic xmin"}})));
}

// Baffles.

/// A case where some faces inside are two faces of the boundary: the owner's in the patch here, the other in there.
FoamMesh with_baffles(const FoamMesh& mesh, const std::set<std::size_t>& baffles) {
  FoamMesh out = mesh;
  out.faces.clear();
  out.owner.clear();
  out.neighbour.clear();
  out.face_zones.clear();
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (baffles.contains(f)) continue;
    out.faces.push_back(mesh.faces[f]);
    out.owner.push_back(mesh.owner[f]);
    if (f < mesh.neighbour.size()) out.neighbour.push_back(mesh.neighbour[f]);
  }
  for (const bool here : {true, false}) {
    for (const std::size_t f : baffles) {
      out.faces.push_back(mesh.faces[f]);
      if (!here) std::reverse(out.faces.back().begin(), out.faces.back().end());
      out.owner.push_back(here ? mesh.owner[f] : mesh.neighbour[f]);
    }
    out.patches.push_back({here ? "here" : "there", "wall", baffles.size()});
  }
  return out;
}

/// The walls of the map: their cells and corners, and the names of their patches.
std::map<std::pair<std::uint32_t, std::set<std::uint32_t>>, std::string> walls_of(const MeshData& mesh) {
  std::map<std::pair<std::uint32_t, std::set<std::uint32_t>>, std::string> walls;
  const CombinatorialMap map(mesh);
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      if (!view.is_wall(f)) continue;
      std::set<std::uint32_t> corners;
      for (const std::uint16_t k : view.shape().corners(f)) corners.insert(view.vertex(k).value);
      walls[{map.source(c), corners}] = map.patch_names()[map.patch({c, f}).value];
    }
  }
  return walls;
}

template <class Walls>
std::set<typename Walls::key_type> places_of(const Walls& walls) {
  std::set<typename Walls::key_type> places;
  for (const auto& [place, name] : walls) places.insert(place);
  return places;
}

/// In files, in pieces, and with other patches the walls are the same.
void expect_kept(const MeshData& mesh) {
  const auto walls = walls_of(mesh);
  const Folder folder;
  for (const std::string name : {"a.vtu", "a.vtk"}) {
    write_mesh(mesh, folder / name);
    EXPECT_EQ(walls_of(read_valid_mesh(folder / name).mesh), walls) << name;
  }
  for (const std::string name : {"a.msh", "a.mesh"})
    expect_parts(error_text([&] { write_mesh(mesh, folder / name); }), {"baffles", ".vtu"});
  MeshData few = mesh;
  select_patches(few, std::vector<std::string>{"here"});
  auto unnamed = walls;
  for (auto& [place, name] : unnamed) name = name == "here" ? name : "";
  EXPECT_EQ(walls_of(few), unnamed);
  MeshData turned = mesh;  // a face of one cell may run in either sense
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    if (is_baffle(mesh, mesh.patch_tags[f])) continue;
    turned.baffle_tags.push_back(mesh.patch_tags[f]);
    std::reverse(turned.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f]),
                 turned.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f + 1]));
  }
  EXPECT_EQ(walls_of(turned), walls);
  MeshData divided = mesh;
  divide_walls(divided, 30.0);
  EXPECT_EQ(places_of(walls_of(divided)), places_of(walls));
  for (const MeshData& whole : {mesh, few}) {
    if (mesh.dimension() == 2) continue;
    write_mesh_parts(whole, 3, folder / "a.pvtu");
    EXPECT_EQ(walls_of(read_valid_mesh(folder / "a.pvtu").mesh), walls_of(whole));
  }
}

void expect_baffles(const MeshData& mesh, const std::set<std::size_t>& baffles, const FoamMesh& foam) {
  SCOPED_TRACE(baffles.size());
  const MeshFile file = read_foam(with_baffles(foam, baffles));
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  auto wanted = walls_of(mesh);
  for (auto& [place, name] : wanted) name = name.empty() ? "walls" : name;
  for (const std::size_t f : baffles) {
    std::set<std::uint32_t> corners;
    for (const std::int64_t p : foam.faces[f]) {
      if (mesh.dimension() == 3 || p < static_cast<std::int64_t>(mesh.points.size()))
        corners.insert(static_cast<std::uint32_t>(p));
    }
    wanted[{static_cast<std::uint32_t>(foam.owner[f]), corners}] = "here";
    wanted[{static_cast<std::uint32_t>(foam.neighbour[f]), corners}] = "there";
  }
  EXPECT_EQ(walls_of(file.mesh), wanted);
  expect_kept(file.mesh);
}

TEST(OpenFoam, BafflesAreWallsOnBothSides) {
  OctahedraOptions octahedra;
  octahedra.cells = {2, 2, 2};
  octahedra.size = {1.0, 1.0, 1.0};
  RectangleOptions rectangle;
  rectangle.cells = {4, 3};
  rectangle.size = {1.0, 1.0};
  rectangle.mixed = true;
  const MeshData plane = generate_rectangle(rectangle);
  std::mt19937 random(5);
  for (const MeshData& mesh : {box(), generate_octahedra(octahedra), plane}) {
    const bool flat = mesh.dimension() == 2;
    const FoamMesh foam = flat ? foam_mesh(layer(mesh, 0.0, 1.0), {{"sides", "empty"}}) : foam_mesh(mesh);
    std::vector<std::size_t> inside(foam.neighbour.size());
    std::iota(inside.begin(), inside.end(), 0U);
    std::shuffle(inside.begin(), inside.end(), random);
    for (const std::size_t n : {std::size_t{1}, inside.size() / 3})
      expect_baffles(mesh, {inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(n)}, foam);
  }
}

// Parts.

TEST(OpenFoam, PartsMakeUpTheWhole) {
  const MeshData mesh = box();
  std::mt19937 random(3);
  for (const FoamStyle& style : foam_styles()) {
    for (const std::size_t parts : {1U, 2U, 5U}) {
      std::vector<std::size_t> part(mesh.cell_count());
      for (std::size_t& k : part) k = random() % parts;
      part[0] = parts - 1;
      const Folder folder;
      write_foam_parts(folder / "case", style, foam_mesh(mesh), part);
      const MeshFile file = read_mesh(folder / "case");
      expect_case(file, mesh);
      EXPECT_EQ(file.report.format, "OpenFOAM polyMesh, of " + std::to_string(parts) + " processors");
    }
  }
}

TEST(OpenFoam, PartsWithHalvesOfCyclicPairs) {
  const MeshData mesh = generate_box({.cells = {4, 2, 2}, .size = Vec3{1.0, 1.0, 1.0}});
  std::vector<std::size_t> part;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) part.push_back(c % 3);
  const Folder folder;
  write_foam_parts(folder / "case", {}, foam_mesh(mesh, {{"xmin", "cyclic xmax"}, {"xmax", "cyclic xmin"}}), part);
  const MeshFile file = read_mesh(folder / "case");
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_EQ(patches_of(file.mesh), patches_of(mesh));
  EXPECT_EQ(only_pair(file).translate, (Vec3{1.0, 0.0, 0.0}));
}

TEST(OpenFoam, PartsThatDoNotFit) {
  const MeshData mesh = box();
  const FoamMesh whole = foam_mesh(mesh);
  std::vector<std::size_t> part(mesh.cell_count());
  for (std::size_t c = 0; c < part.size(); ++c) part[c] = c % 2;
  const auto refused = [&](const std::string& name, std::vector<std::int64_t> labels,
                           const std::vector<std::string>& words) {
    const Folder folder;
    write_foam_parts(folder / "case", {}, whole, part);
    FoamWriter(folder / "case/processor1", {}).labels_file(name, labels);
    expect_refused(read_mesh(folder / "case"), words);
  };
  std::vector<std::int64_t> cells;
  for (std::size_t c = 1; c < part.size(); c += 2) cells.push_back(static_cast<std::int64_t>(c));
  std::vector<std::int64_t> wrong = cells;
  wrong[3] = 0;
  refused("cellProcAddressing", wrong, {"processor1/constant/polyMesh", "cell 3 has the label 0", "decomposePar"});
  wrong[3] = 1 << 30;
  refused("cellProcAddressing", wrong, {"cell 3 has the label 1073741824"});
  wrong.pop_back();
  refused("cellProcAddressing", wrong, {"labels for", "cells"});
  refused("cellProcAddressing", {-1}, {"processor1", "item 0 is -1"});
  refused("pointProcAddressing", {1, 2}, {"2 labels for", "points"});
  refused("faceProcAddressing", {0}, {"1 labels for", "faces"});
  const Folder folder;
  write_foam_parts(folder / "case", {}, whole, part);
  std::filesystem::remove_all(folder / "case/processor1");
  expect_refused(read_mesh(folder / "case"), {"beyond all cells", "fit"});
  std::filesystem::remove_all(folder / "case/processor0");
  std::filesystem::create_directories(folder / "case/processors2");
  expect_refused(read_mesh(folder / "case"), {"collated"});
}

// Refusals.

TEST(OpenFoam, FilesThatAreNotRight) {
  struct Wrong {
    std::string file, type, content;
    std::vector<std::string> words;
  };
  const std::vector<Wrong> all = {
      {"points",
       "vectorField",
       "3\n((0 0 0) (1 0 0) (0 1))",
       {"constant/polyMesh/points, line 13", "a number should stand here"}},
      {"points", "vectorField", "4((0 0 0) (1 0 0) (0 1 0))", {"line 12", "vector"}},
      {"points", "vectorField", "400000((0 0 0))", {"400000 points are announced"}},
      {"points", "vectorField", "12{(0 0 0)}", {"without volume"}},
      {"faces", "faceList", "1(4(0 1 2 77))", {"faces: item 3 is 77", "less than 12"}},
      {"faces", "faceList", "1(2(0 1))", {"face 0 has 2 corners"}},
      {"faces", "faceList", "100{100{0}}", {"faces", "more labels than the file has bytes"}},
      {"faces", "faceList", "0()", {"owner"}},
      {"owner", "labelList", "3(0 0 0)", {"3 owners for"}},
      {"owner", "labelList", "3(0 0 -1)", {"owners: item 2 is -1"}},
      {"neighbour", "labelList", "99{0}", {"99 neighbours for"}},
      {"boundary", "polyBoundaryMesh", "1(a {type patch; nFaces 3; startFace 2;})", {"a has the faces 2 to 4"}},
      {"boundary", "polyBoundaryMesh", "1(a {type patch; nFaces 3;})", {"no startFace"}},
      {"boundary", "polyBoundaryMesh", "0()", {"in no patch"}},
      {"boundary", "polyBoundaryMesh", "(a {type patch; nFaces 14; startFace 3;}", {"truncated"}},
      {"boundary", "polyBoundaryMesh", "(a {#include \"b\"; nFaces 14; startFace 3;})", {"directives"}},
      {"cellZones", "regIOobject", "1(z {cellLabels List<label> 1(4);})", {"cellLabels: item 0 is 4"}},
      {"faceZones", "regIOobject", "1(z {faceLabels List<label> 1(99);})", {"faceLabels: item 0 is 99"}},
      {"points", "vectorField", "/* no end", {"a comment does not end"}}};
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.file + ": " + wrong.content);
    const Folder folder;
    const FoamWriter writer(folder / "case", {});
    writer.write(foam_mesh(sample_mesh()));
    writer.file("constant/polyMesh/" + wrong.file, wrong.type, wrong.content);
    const MeshFile file = read_mesh(folder / "case");
    const std::string text = report_text(file.report);
    EXPECT_FALSE(file.report.valid());
    for (const std::string& word : wrong.words) EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

TEST(OpenFoam, HeadersAndFolders) {
  const Folder folder;
  const auto refused = [&](const std::string& head, const std::string& word) {
    FoamWriter(folder / "case", {}).write(foam_mesh(sample_mesh()));
    write_bytes(folder / "case/constant/polyMesh/owner", head);
    expect_refused(read_mesh(folder / "case"), {"owner", word});
  };
  refused("", "empty");
  refused("1(0)", "FoamFile");
  refused("FoamFile { format", "truncated");
  refused("FoamFile { format yaml; }", "yaml");
  refused("FoamFile { format ascii; class labelList; } 3(0", "");
  std::filesystem::remove(folder / "case/constant/polyMesh/owner");
  expect_refused(read_mesh(folder / "case"), {"owner", "no such file"});
  expect_refused(read_mesh(folder / "none"), {"OpenFOAM"});
  std::filesystem::create_directories(folder / "empty");
  expect_refused(read_mesh(folder / "empty"), {"no case of OpenFOAM"});
  expect_refused(read_mesh(folder / "none.foam"), {"no case of OpenFOAM"});
  ReadOptions options;
  options.patch_array = "patch";
  FoamWriter(folder / "case", {}).write(foam_mesh(sample_mesh()));
  expect_refused(read_mesh(folder / "case", options), {"patches of its own"});
  options = {};
  options.max_memory = 1000;
  expect_refused(read_mesh(folder / "case", options), {"points", "memory"});
}

TEST(OpenFoam, AFileThatUnpacksToMoreThanTheMemoryIsRefused) {
  const Folder folder;
  FoamWriter(folder / "case", {}).write(foam_mesh(sample_mesh()));
  std::filesystem::remove(folder / "case/constant/polyMesh/owner");
  FoamWriter(folder / "case", {.gzip = true})
      .file("constant/polyMesh/owner", "labelList", "1(0)" + std::string(100'000'000, ' '));
  EXPECT_LT(std::filesystem::file_size(folder / "case/constant/polyMesh/owner.gz"), 200'000U);
  ReadOptions options;
  options.max_memory = 200'000'000;
  expect_refused(read_mesh(folder / "case", options), {"owner.gz", "memory"});
}

}  // namespace dartcast::test::openfoam_test
