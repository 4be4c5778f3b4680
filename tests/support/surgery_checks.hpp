// Checks after every operation: a sound complex, the same volume, and which cells can reach each other.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <set>
#include <span>
#include <unordered_set>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_data.hpp"
#include "support/edit_meshes.hpp"
#include "support/remesh_checks.hpp"
#include "support/volume.hpp"

namespace dartcast::test {

/// Boxes of one type of cells, or mixed.
struct MeshKind {
  const char* name;
  CellType type;
  bool mixed;
};
inline void PrintTo(const MeshKind& k, std::ostream* out) { *out << k.name; }

/// The cells of an open edit under their numbers after its commit.
inline std::vector<Cell> now(const ComplexEditReport& report, std::vector<Cell> cells) {
  for (Cell& c : cells) c = report.now(c);
  return cells;
}

/// Whether two exact numbers are nearer than this.
inline bool near(const Dyadic& a, const Dyadic& b, double within) { return (a - b).abs() < Dyadic(within); }

/// All free cells that are reached from one over faces that are no walls.
inline std::unordered_set<std::uint32_t> flood(const CombinatorialMap& map, Cell start) {
  std::unordered_set<std::uint32_t> seen = {start.value};
  std::vector<Cell> cells = {start};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView v = map.view(cells[i]);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (v.neighbour(f).valid() && !v.is_wall(f) && seen.insert(v.neighbour(f).value).second)
        cells.push_back(v.neighbour(f));
    }
  }
  return seen;
}

/// The number of parts that free cells fall into.
inline std::size_t count_rooms(const CombinatorialMap& map) {
  std::unordered_set<std::uint32_t> seen;
  std::size_t rooms = 0;
  for (const Cell c : map.cells()) {
    if (!map.is_free(c) || seen.contains(c.value)) continue;
    ++rooms;
    seen.merge(flood(map, c));
  }
  return rooms;
}

/// A copy of what an operation may change, to see that it has not.
class Before {
 public:
  explicit Before(const CellComplex& complex)
      : complex_(complex), map_(complex.map()), positions_(complex.positions().begin(), complex.positions().end()) {}

  void expect_unchanged() const {
    EXPECT_TRUE(complex_.map() == map_);
    EXPECT_TRUE(
        std::equal(positions_.begin(), positions_.end(), complex_.positions().begin(), complex_.positions().end()));
  }

 private:
  const CellComplex& complex_;
  CombinatorialMap map_;
  std::vector<Vec3> positions_;
};

/// A box of n cubes of edge 1 along each axis, all of it blocked.
inline MeshData blocked_box(std::array<std::uint32_t, 3> cells, CellType type = CellType::hexahedron,
                            bool mixed = false) {
  BoxOptions o;
  o.cells = cells;
  o.size = {static_cast<double>(cells[0]), static_cast<double>(cells[1]), static_cast<double>(cells[2])};
  o.type = type;
  o.mixed = mixed;
  MeshData mesh = generate_box(o);
  mesh.free.assign(mesh.cell_count(), 0);
  return mesh;
}

}  // namespace dartcast::test
