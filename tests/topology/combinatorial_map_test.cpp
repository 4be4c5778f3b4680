// The relations of the map on every dart of meshes of every type, against the meshes' own lists of faces.
#include "dartcast/combinatorial_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "mesh/cell_types.hpp"
#include "support/darts.hpp"
#include "support/mixed_mesh.hpp"

namespace dartcast::map_test {

using test::all_darts;

using FaceKey = std::vector<std::uint32_t>;  // sorted corners

MeshData box(CellType type, bool mixed = false) {
  BoxOptions o;
  o.cells = {3, 2, 3};
  o.size = {3, 2, 3};
  o.type = type;
  o.mixed = mixed;
  o.blocked_share = 0.3;
  return generate_box(o);
}

struct Case {
  const char* name;
  MeshData (*make)();
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class EveryMesh : public testing::TestWithParam<Case> {
 protected:
  // Twice: in the generator's numbering and in a random one.
  void SetUp() override {
    meshes_.push_back(GetParam().make());
    Random random(7);
    meshes_.push_back(test::renumbered(meshes_[0], test::permutation(meshes_[0].points.size(), random)));
  }
  std::vector<MeshData> meshes_;
};

INSTANTIATE_TEST_SUITE_P(CombinatorialMap, EveryMesh,
                         testing::Values(Case{"tetrahedra", [] { return box(CellType::tetrahedron); }},
                                         Case{"hexahedra", [] { return box(CellType::hexahedron); }},
                                         Case{"prisms", [] { return box(CellType::prism); }},
                                         Case{"pyramids", [] { return box(CellType::pyramid); }},
                                         Case{"mixed", [] { return box(CellType::hexahedron, true); }},
                                         Case{"octahedra",
                                              [] {
                                                OctahedraOptions o;
                                                o.cells = {2, 2, 1};
                                                o.size = {1.0, 1.0, 1.0};
                                                o.blocked_share = 0.3;
                                                return generate_octahedra(o);
                                              }},
                                         Case{"handmade", [] { return test::mixed_mesh(); }}),
                         [](const auto& i) { return std::string(i.param.name); });

FaceKey key_of(const CombinatorialMap& map, Dart d) {
  FaceKey key;
  Dart x = d;
  do {
    key.push_back(map.origin(x).value);
    x = map.phi1(x);
  } while (x != d && key.size() < 100);
  std::sort(key.begin(), key.end());
  return key;
}

// The mesh's own answer: which cells have which faces.
std::map<FaceKey, std::set<std::uint32_t>> cells_by_face(const MeshData& mesh) {
  std::map<FaceKey, std::set<std::uint32_t>> cells;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> f) {
      FaceKey key(f.begin(), f.end());
      std::sort(key.begin(), key.end());
      cells[key].insert(static_cast<std::uint32_t>(c));
    });
  }
  return cells;
}

TEST_P(EveryMesh, FacesAreThoseOfTheMeshInTheirOrder) {
  for (const MeshData& mesh : meshes_) {
    const CombinatorialMap map(mesh);
    ASSERT_EQ(map.cell_count(), mesh.cell_count());
    for (const Cell c : map.cells()) {
      EXPECT_EQ(map.type(c), mesh.types[map.source(c)]);
      std::set<std::vector<std::uint32_t>> expected, seen;
      for_each_face(mesh, map.source(c), [&](std::span<const std::uint32_t> f) {
        std::vector<std::uint32_t> face(f.begin(), f.end());
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        expected.insert(face);
      });
      const CellView v = map.view(c);
      for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
        std::vector<std::uint32_t> face;
        for (std::uint16_t k = 0; k < v.shape().degree(f); ++k) {
          face.push_back(map.origin({c, static_cast<std::uint16_t>(v.shape().first_dart(f) + k)}).value);
        }
        seen.insert(face);
      }
      EXPECT_EQ(seen, expected) << "cell " << map.source(c);
    }
  }
}

TEST_P(EveryMesh, RelationsHoldAtEveryDart) {
  for (const MeshData& mesh : meshes_) {
    const CombinatorialMap map(mesh);
    const auto cells = cells_by_face(mesh);
    for (const Dart d : all_darts(map)) {
      const Vertex a = map.origin(d);
      const Vertex b = map.origin(map.phi1(d));
      ASSERT_NE(a, b);
      ASSERT_EQ(map.phi_1(map.phi1(d)), d);
      ASSERT_EQ(map.phi1(map.phi_1(d)), d);
      const Dart e = map.phi2(d);
      ASSERT_NE(map.face(e), map.face(d));
      ASSERT_EQ(e.cell, d.cell);
      ASSERT_EQ(map.phi2(e), d);
      ASSERT_EQ(map.origin(e), b);
      ASSERT_EQ(map.origin(map.phi1(e)), a);
      ASSERT_EQ(map.alpha1(d), map.phi1(e));
      ASSERT_EQ(map.origin(map.alpha1(d)), a);

      const auto& sides = cells.at(key_of(map, d));
      const Dart other = map.phi3(d);
      ASSERT_EQ(other.valid(), sides.size() == 2);
      ASSERT_EQ(map.opposite(map.face(d)).valid(), other.valid());
      if (!other.valid()) continue;
      ASSERT_NE(other.cell, d.cell);
      ASSERT_TRUE(sides.contains(map.source(other.cell)));
      ASSERT_EQ(key_of(map, other), key_of(map, d));
      ASSERT_EQ(map.opposite(map.face(d)), map.face(other));
      ASSERT_EQ(map.phi3(other), d);
      ASSERT_EQ(map.origin(other), b);
      ASSERT_EQ(map.origin(map.phi1(other)), a);
      ASSERT_EQ(map.phi1(map.phi3(map.phi1(other))), d);
    }
  }
}

TEST_P(EveryMesh, EveryCellIsASphere) {
  for (const MeshData& mesh : meshes_) {
    const CombinatorialMap map(mesh);
    for (const Cell c : map.cells()) {
      const Shape& s = map.shape(c);
      EXPECT_EQ(s.corner_count() - s.dart_count() / 2 + s.face_count(), 2);
    }
  }
}

// All darts that `holds` accepts, in the cells reached from d's over faces that hold all of `corners`.
template <class Holds>
std::set<Dart> brute_orbit(const CombinatorialMap& map, const std::map<FaceKey, std::set<std::uint32_t>>& faces,
                           const std::map<std::uint32_t, Cell>& cell_of, Dart d, const FaceKey& corners,
                           Holds&& holds) {
  std::set<std::uint32_t> reached = {map.source(d.cell)};
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& [key, cells] : faces) {
      if (!std::includes(key.begin(), key.end(), corners.begin(), corners.end())) continue;
      const bool touched = std::any_of(cells.begin(), cells.end(), [&](auto c) { return reached.contains(c); });
      for (const std::uint32_t c : cells) grown = (touched && reached.insert(c).second) || grown;
    }
  }
  std::set<Dart> orbit;
  for (const std::uint32_t c : reached) {
    const Cell cell = cell_of.at(c);
    for (std::uint16_t n = 0; n < map.shape(cell).dart_count(); ++n) {
      if (holds(Dart{cell, n})) orbit.insert({cell, n});
    }
  }
  return orbit;
}

TEST_P(EveryMesh, OrbitsAreThoseFoundByBruteForce) {
  for (const MeshData& mesh : meshes_) {
    const CombinatorialMap map(mesh);
    const auto faces = cells_by_face(mesh);
    std::map<std::uint32_t, Cell> cell_of;
    for (const Cell c : map.cells()) cell_of[map.source(c)] = c;
    const auto check = [&](const std::vector<Dart>& orbit, Dart d, const std::set<Dart>& expected) {
      ASSERT_EQ(orbit.front(), d);
      const std::set<Dart> distinct(orbit.begin(), orbit.end());
      ASSERT_EQ(distinct.size(), orbit.size());
      ASSERT_EQ(distinct, expected);
    };
    const std::vector<Dart> darts = all_darts(map);
    for (std::size_t i = 0; i < darts.size(); i += 1 + darts.size() / 150) {
      const Dart d = darts[i];
      const std::uint32_t a = map.origin(d).value;
      const std::uint32_t b = map.origin(map.phi1(d)).value;
      const FaceKey face = key_of(map, d);
      check(vertex_orbit(map, d), d,
            brute_orbit(map, faces, cell_of, d, {a}, [&](Dart x) { return map.origin(x).value == a; }));
      check(edge_orbit(map, d), d, brute_orbit(map, faces, cell_of, d, {std::min(a, b), std::max(a, b)}, [&](Dart x) {
              const std::uint32_t p = map.origin(x).value;
              const std::uint32_t q = map.origin(map.phi1(x)).value;
              return (p == a && q == b) || (p == b && q == a);
            }));
      check(face_orbit(map, d), d,
            brute_orbit(map, faces, cell_of, d, face, [&](Dart x) { return key_of(map, x) == face; }));
      std::set<Dart> of_cell;
      for (std::uint16_t n = 0; n < map.shape(d.cell).dart_count(); ++n) of_cell.insert({d.cell, n});
      check(cell_orbit(map, d), d, of_cell);
    }
  }
}

TEST_P(EveryMesh, IntegrityIsClean) {
  for (const MeshData& mesh : meshes_) {
    const CombinatorialMap map(mesh);
    for (const Violation& v : check_integrity(map)) ADD_FAILURE() << v.message;
  }
}

TEST(CombinatorialMap, IntegrityOfTheVesselAndTheBarIsClean) {
  VesselOptions small;
  small.core = 2;
  small.rings = 1;
  small.tissue_layers = 1;
  small.step_length = 1.5e-3;
  EXPECT_TRUE(check_integrity(CombinatorialMap(generate_vessel(small))).empty());
  EXPECT_TRUE(check_integrity(CombinatorialMap(generate_bar())).empty());
}

// Wall faces of free cells, by the mesh's own faces.
std::size_t brute_wall_count(const MeshData& mesh, const std::vector<std::uint8_t>& free) {
  std::size_t count = 0;
  for (const auto& [key, cells] : cells_by_face(mesh)) {
    std::size_t free_sides = 0;
    for (const std::uint32_t c : cells) free_sides += free[c];
    count += free_sides == 1 ? 1 : 0;
  }
  return count;
}

TEST_P(EveryMesh, SetFreeMarksItsWallsAndThoseOfItsNeighbours) {
  for (const MeshData& mesh : meshes_) {
    CombinatorialMap map(mesh);
    std::vector<std::uint8_t> free = mesh.free;
    if (free.empty()) free.assign(mesh.cell_count(), 1);
    ASSERT_EQ(map.wall_face_count(), brute_wall_count(mesh, free));
    const auto cells = map.cells();
    Random random(3);
    for (int i = 0; i < 40; ++i) {
      const Cell c = cells[random.below(static_cast<std::uint32_t>(cells.size()))];
      const bool to = random.below(2) == 0;
      map.set_free(c, to);
      free[map.source(c)] = to ? 1 : 0;
      ASSERT_EQ(map.is_free(c), to);
      ASSERT_EQ(map.wall_face_count(), brute_wall_count(mesh, free));
      for (const Cell x : cells) {
        const CellView v = map.view(x);
        ASSERT_EQ(v.is_free(), free[map.source(x)] != 0);
        for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
          const Cell other = v.neighbour(f);
          ASSERT_EQ(v.is_wall(f), !other.valid() || free[map.source(x)] != free[map.source(other)]);
        }
      }
    }
    EXPECT_TRUE(check_integrity(map).empty());
  }
}

// A cube of twelve triangles with a tetrahedron on each: a tetrahedron's record has 3 bits for its neighbour's face.
TEST(CombinatorialMap, StandardCellsFindTheirPlaceAmongManyFaces) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  std::vector<std::uint32_t> faces = {12};
  for (const auto& quad : standard_faces(CellType::hexahedron)) {
    for (const std::size_t k : {0, 2}) {
      const std::array<std::uint32_t, 3> f = {quad[k], quad[k + 1], quad[(k + 2) % 4]};
      faces.insert(faces.end(), {3, f[0], f[1], f[2]});
    }
  }
  mesh.add_cell(CellType::polyhedron, faces);
  for (std::size_t i = 1; i < faces.size(); i += 4) {
    mesh.points.push_back((mesh.points[faces[i + 1]] + mesh.points[faces[i + 2]] + mesh.points[faces[i + 3]]) * 0.6);
    test::add_tetrahedron(
        mesh, {faces[i + 1], faces[i + 2], faces[i + 3], static_cast<std::uint32_t>(mesh.points.size() - 1)});
  }
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const CombinatorialMap map(test::renumbered(mesh, test::permutation(mesh.points.size(), random)));
    EXPECT_TRUE(check_integrity(map).empty());
    const Cell cube(CombinatorialMap::general_pool, 0);
    for (std::uint16_t f = 0; f < 12; ++f) {
      const CellFace other = map.opposite({cube, f});
      ASSERT_TRUE(other.valid());
      EXPECT_EQ(map.opposite(other), (CellFace{cube, f}));
    }
  }
}

TEST(CombinatorialMap, SourceNumbersOfAMixedMeshAreThoseOfTheInput) {
  MeshData mesh = test::mixed_mesh();
  mesh.source = {70, 10, 20, 30, 40, 50, 60, 80};
  const CombinatorialMap map(mesh);
  std::map<std::uint32_t, CellType> types;
  for (const Cell c : map.cells()) types[map.source(c)] = map.type(c);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) EXPECT_EQ(types.at(mesh.source[c]), mesh.types[c]);
  EXPECT_FALSE(map.contains(Cell(0, 99)));
  EXPECT_FALSE(map.contains(Cell{}));
  EXPECT_FALSE(map.contains(Cell(5, 0)));
}

TEST(CombinatorialMap, PatchesOfABoxAreItsSides) {
  const MeshData mesh = box(CellType::prism);
  const CombinatorialMap map(mesh);
  const std::set<std::string> names(map.patch_names().begin(), map.patch_names().end());
  EXPECT_EQ(names, (std::set<std::string>{"", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}));
  EXPECT_EQ(map.patch_names()[0], "");
  std::map<std::string, int> faces;
  for (const Cell c : map.cells()) {
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      const std::string& name = map.patch_names()[map.patch(CellFace{c, f}).value];
      EXPECT_EQ(name.empty(), v.neighbour(f).valid());
      if (name.empty()) continue;
      ++faces[name];
      const char axis = name[0];
      const bool high = name.substr(1) == "max";
      for (const std::uint16_t k : v.shape().corners(f)) {
        const Vec3& p = mesh.points[v.vertex(k).value];
        const double at = axis == 'x' ? p.x : axis == 'y' ? p.y : p.z;
        EXPECT_EQ(at, high ? (axis == 'y' ? 2.0 : 3.0) : 0.0);
      }
    }
  }
  EXPECT_EQ(faces.size(), 6U);
  EXPECT_EQ(faces["xmin"], 2 * 3);
}

TEST(CombinatorialMap, APatchFaceInsideIsNamedFromBothSides) {
  MeshData mesh = test::mixed_mesh();
  mesh.add_patch_face(std::vector<std::uint32_t>{6, 5, 1, 2},
                      5);                                       // between hexahedron and pyramid, from another corner
  mesh.add_patch_face(std::vector<std::uint32_t>{1, 2, 8}, 9);  // between pyramid and tetrahedron: a tag without a name
  mesh.add_patch_face(std::vector<std::uint32_t>{5, 6, 2, 1}, 9);  // named twice: the first counts
  mesh.add_patch_face(std::vector<std::uint32_t>{1, 6, 2, 5}, 9);  // no face: crossed
  mesh.add_patch_face(std::vector<std::uint32_t>{1, 2, 8, 5}, 9);  // no face: one corner is another
  mesh.patch_names[5] = "gate";
  const CombinatorialMap map(mesh);
  const Patch gate = map.patch("gate");
  std::map<std::uint32_t, int> of_gate, of_nine;
  for (const Cell c : map.cells()) {
    for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
      if (map.patch(CellFace{c, f}) == gate) ++of_gate[map.source(c)];
      if (map.patch(CellFace{c, f}) == map.patch("9")) ++of_nine[map.source(c)];
    }
  }
  EXPECT_EQ(of_gate, (std::map<std::uint32_t, int>{{0, 1}, {1, 1}}));
  EXPECT_EQ(of_nine, (std::map<std::uint32_t, int>{{1, 1}, {3, 1}}));
}

TEST(CombinatorialMap, AnUnknownPatchListsTheKnownOnes) {
  const CombinatorialMap map(box(CellType::hexahedron));
  try {
    (void)map.patch("inlet");
    FAIL() << "an unknown patch was taken";
  } catch (const InvalidArgument& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("\"inlet\""), std::string::npos) << text;
    for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) {
      EXPECT_NE(text.find(name), std::string::npos) << text;
    }
  }
  try {
    (void)CombinatorialMap(test::mixed_mesh()).patch("inlet");
    FAIL() << "an unknown patch was taken";
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find("none"), std::string::npos) << e.what();
  }
}

}  // namespace dartcast::map_test
