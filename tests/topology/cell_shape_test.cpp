// Shapes: how few there are, and that their simplices tile the cell and fit those of the neighbours.
#include "dartcast/cell_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "base/random.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/dyadic.hpp"
#include "support/meshes.hpp"
#include "support/mixed_mesh.hpp"

namespace dartcast::shape_test {

using test::determinant;
using test::Dyadic;

// One separate cell of the type for every numbering of its corners.
CombinatorialMap every_numbering(CellType type, std::uint32_t corners) {
  std::vector<std::uint32_t> order(corners);
  std::iota(order.begin(), order.end(), 0U);
  MeshData mesh;
  do {
    const auto base = static_cast<std::uint32_t>(mesh.cell_count()) * corners;
    std::vector<std::uint32_t> cell;
    for (const std::uint32_t i : order) cell.push_back(base + i);
    mesh.add_cell(type, cell);
  } while (std::next_permutation(order.begin(), order.end()));
  mesh.points.resize(mesh.cell_count() * corners);
  return CombinatorialMap(mesh);
}

TEST(Shapes, FewServeEveryNumbering) {
  EXPECT_EQ(every_numbering(CellType::tetrahedron, 4).shapes().size(), 1U);
  EXPECT_EQ(every_numbering(CellType::pyramid, 5).shapes().size(), 8U);
  EXPECT_EQ(every_numbering(CellType::prism, 6).shapes().size(), 10U);
  EXPECT_EQ(every_numbering(CellType::hexahedron, 8).shapes().size(),
            26U);  // 41, less what the second-lowest vertex decides
}

TEST(Shapes, SimplicesPerType) {
  const auto counts = [](const CombinatorialMap& map) {
    std::set<std::size_t> n;
    for (const Cell c : map.cells()) n.insert(map.shape(c).simplices().size());
    return n;
  };
  EXPECT_EQ(counts(every_numbering(CellType::tetrahedron, 4)), (std::set<std::size_t>{1}));
  EXPECT_EQ(counts(every_numbering(CellType::pyramid, 5)), (std::set<std::size_t>{2}));
  EXPECT_EQ(counts(every_numbering(CellType::prism, 6)), (std::set<std::size_t>{3}));
  // 12 triangles, less those around the lowest vertex: 2 in each of its three faces.
  EXPECT_EQ(counts(every_numbering(CellType::hexahedron, 8)), (std::set<std::size_t>{6}));
}

MeshData meshes(int which) {
  BoxOptions o;
  o.cells = {2, 3, 2};
  o.size = {1.0, 1.0, 1.0};
  o.jitter = 0.7;
  o.seed = 11;
  test::set_kind(o, which);
  if (which < 5) return generate_box(o);
  if (which == 6) return test::mixed_mesh();
  OctahedraOptions p;
  p.cells = {2, 1, 2};
  p.size = {1.0, 1.0, 1.0};
  return generate_octahedra(p);
}
constexpr int mesh_kinds = 7;

std::vector<MeshData> numbered_meshes(int which) {
  std::vector<MeshData> all = {meshes(which)};
  Random random(static_cast<std::uint64_t>(which));
  for (int i = 0; i < 3; ++i) all.push_back(test::renumbered(all[0], test::permutation(all[0].points.size(), random)));
  return all;
}

using Triple = std::array<std::uint16_t, 3>;
Triple sorted(Triple t) {
  std::sort(t.begin(), t.end());
  return t;
}
Triple facet(const ImplicitSimplex& s, unsigned opposite) {
  Triple t{};
  std::copy_if(s.vertex.begin(), s.vertex.end(), t.begin(), [&](auto v) { return v != s.vertex[opposite]; });
  return sorted(t);
}

TEST(Shapes, EveryFacetIsMatchedOnce) {
  for (int which = 0; which < mesh_kinds; ++which) {
    for (const MeshData& mesh : numbered_meshes(which)) {
      const CombinatorialMap map(mesh);
      for (std::uint32_t n = 0; n < map.shapes().size(); ++n) {
        const Shape& shape = map.shapes()[n];
        const auto& simplices = shape.simplices();
        std::size_t outer = 0;
        for (std::uint16_t s = 0; s < simplices.size(); ++s) {
          for (std::uint16_t i = 0; i < 4; ++i) {
            const Across a = simplices[s].across[i];
            if (a.outer()) {
              ++outer;
              EXPECT_EQ(facet(simplices[s], i), sorted(shape.triangle(a.face(), a.place)));
              EXPECT_EQ(shape.entry(a.face(), a.place), (Across{s, i}));
            } else {
              ASSERT_LT(a.index, simplices.size());
              ASSERT_NE(a.index, s);
              EXPECT_EQ(facet(simplices[s], i), facet(simplices[a.index], a.place));
              EXPECT_EQ(simplices[a.index].across[a.place], (Across{s, i}));
            }
          }
        }
        std::size_t triangles = 0;
        for (std::uint16_t f = 0; f < shape.face_count(); ++f) triangles += shape.triangle_count(f);
        EXPECT_EQ(outer, triangles);
      }
    }
  }
}

TEST(Shapes, SimplicesSumToTheVolumeWithinTheFans) {
  for (int which = 0; which < mesh_kinds; ++which) {
    for (const MeshData& mesh : numbered_meshes(which)) {
      const CombinatorialMap map(mesh);
      for (const Cell c : map.cells()) {
        const CellView v = map.view(c);
        const auto at = [&](std::uint16_t k) { return mesh.points[v.vertex(k).value]; };
        Dyadic simplices;
        for (const auto& s : v.shape().simplices()) {
          const Dyadic volume = determinant(at(s.vertex[0]), at(s.vertex[1]), at(s.vertex[2]), at(s.vertex[3]));
          EXPECT_GT(volume, 0);
          simplices += volume;
        }
        // Divergence theorem, from a point anywhere, over each face's own corners: fanned from its lowest-numbered
        // vertex.
        const Vec3 anywhere{0.3, -2.7, 11.1};
        Dyadic surface;
        for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
          const auto corners = v.shape().corners(f);
          for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
            EXPECT_LT(v.vertex(corners[0]), v.vertex(corners[k]));
            surface += determinant(anywhere, at(corners[0]), at(corners[k]), at(corners[k + 1]));
          }
        }
        EXPECT_EQ(simplices, surface) << "cell " << map.source(c);
      }
    }
  }
}

TEST(Shapes, TrianglesHaveTheSameCornersFromBothSides) {
  for (int which = 0; which < mesh_kinds; ++which) {
    for (const MeshData& mesh : numbered_meshes(which)) {
      const CombinatorialMap map(mesh);
      std::size_t sewn = 0;
      for (const Cell c : map.cells()) {
        const CellView v = map.view(c);
        for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
          if (!v.neighbour(f).valid()) continue;
          ++sewn;
          const CellView w = map.view(v.neighbour(f));
          for (std::uint16_t t = 0; t < v.shape().triangle_count(f); ++t) {
            std::set<Vertex> here, there;
            for (const auto k : v.shape().triangle(f, t)) here.insert(v.vertex(k));
            for (const auto k : w.shape().triangle(v.neighbour_face(f), v.shape().triangle_from_other_side(f, t))) {
              there.insert(w.vertex(k));
            }
            EXPECT_EQ(here, there);
          }
        }
      }
      EXPECT_GT(sewn, 0U);
    }
  }
}

// A cube as a key; numbers as MeshData's hexahedron.
ShapeKey cube() {
  ShapeKey key;
  key.corner_count = 8;
  for (const std::vector<std::uint16_t>& f : std::vector<std::vector<std::uint16_t>>{
           {0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 4, 7, 3}}) {
    key.faces.push_back({f, false});
  }
  return key;
}

TEST(Shape, FacesMustClose) {
  EXPECT_NO_THROW(Shape{cube()});
  ShapeKey open = cube();
  open.faces.pop_back();
  EXPECT_THROW(Shape{open}, InvalidMesh);
  ShapeKey turned = cube();
  std::reverse(turned.faces[2].corners.begin(), turned.faces[2].corners.end());
  EXPECT_THROW(Shape{turned}, InvalidMesh);
  ShapeKey repeated = cube();
  repeated.faces[1].corners[2] = 4;
  EXPECT_THROW(Shape{repeated}, InvalidMesh);
  ShapeKey beyond = cube();
  beyond.faces[1].corners[2] = 8;
  EXPECT_THROW(Shape{beyond}, InvalidMesh);
  ShapeKey edge = cube();
  edge.faces.push_back({{0, 1}, false});
  EXPECT_THROW(Shape{edge}, InvalidMesh);
}

TEST(Shape, FeaturesOfACube) {
  const Shape s(cube());
  const auto kind = [&](std::vector<std::uint16_t> points) { return s.feature(points).kind; };
  EXPECT_EQ(kind({6}), Kind::vertex);
  EXPECT_EQ(s.origin(s.feature(std::vector<std::uint16_t>{6}).dart), 6);
  EXPECT_EQ(kind({6, 7}), Kind::edge);
  EXPECT_EQ(kind({4, 6}), Kind::face);    // a diagonal of a face
  EXPECT_EQ(kind({0, 6}), Kind::volume);  // a diagonal of the cube
  EXPECT_EQ(kind({4, 5, 6}), Kind::face);
  EXPECT_EQ(s.face_of(s.feature(std::vector<std::uint16_t>{4, 5, 6}).dart), 1);
  EXPECT_EQ(kind({0, 2, 7}), Kind::volume);
  EXPECT_EQ(kind({0, 1, 2, 6}), Kind::volume);
}

TEST(Shape, PointsOfFacesAndOfTheCell) {
  ShapeKey key = cube();
  key.has_point = true;
  key.faces[1].has_point = true;
  key.faces[4].has_point = true;
  const Shape s(key);
  EXPECT_EQ(s.point_count(), 11);  // 8 and 9 in faces 1 and 4, 10 in the cell
  EXPECT_EQ(s.face_of_point(8), 1);
  EXPECT_EQ(s.face_of_point(9), 4);
  EXPECT_EQ(s.face_of_point(10), s.face_count());
  EXPECT_EQ(s.face_of_point(3), s.face_count());
  EXPECT_EQ(s.simplices().size(), 4U * 2 + 2U * 4);
  EXPECT_EQ(s.triangle(4, 3)[0], 9);
  EXPECT_EQ(s.feature(std::vector<std::uint16_t>{8}).kind, Kind::face);
  EXPECT_EQ(s.face_of(s.feature(std::vector<std::uint16_t>{8, 6}).dart), 1);
  EXPECT_EQ(s.feature(std::vector<std::uint16_t>{6, 7}).kind, Kind::edge);
  EXPECT_EQ(s.feature(std::vector<std::uint16_t>{10, 6}).kind, Kind::volume);
  EXPECT_EQ(s.feature(std::vector<std::uint16_t>{8, 9}).kind, Kind::volume);
}

}  // namespace dartcast::shape_test
