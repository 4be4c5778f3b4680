// The table of ways through a shape: what it says of each facet is what the simplices say, corner by corner.
#include "topology/exit_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/generators.hpp"
#include "oracle/scenes.hpp"
#include "support/tier.hpp"
#include "tracking/space.hpp"

namespace dartcast::test::exit_table_test {

using Triangle = std::array<std::uint32_t, 3>;  // vertices

// The vertices of a facet, in the order of the three corners, from the one in slot 0 on.
Triangle in_slots(const CellView& cell, unsigned row, const std::array<std::uint8_t, 3>& corners, unsigned turn) {
  const ImplicitSimplex& s = cell.shape().simplices()[row / 4];
  Triangle triangle{};
  for (unsigned k = 0; k < 3; ++k) triangle[(k + turn) % 3] = cell.vertex(s.vertex[corners[k]]).value;
  return triangle;
}

// The first mistake in the exits of a cell, or nothing.
std::string check_cell(const CombinatorialMap& map, Cell c, std::size_t& outer) {
  const CellView cell = map.view(c);
  const Shape& shape = cell.shape();
  const detail::ExitTable& table = shape.exits();
  if (table.empty()) return "no table";
  for (unsigned row = 0; row < 4 * shape.simplices().size(); ++row) {
    const ImplicitSimplex& s = shape.simplices()[row / 4];
    const Across across = s.across[row % 4];
    const detail::SimplexExit exit = table.exits_of(row / 4)[row % 4];
    const detail::SimplexEntry& itself = table.entry(0, row);
    if (itself.row() != row || itself.turn() != 0) return fmt::format("row {}: not itself", row);
    if (itself.apex != s.vertex[row % 4]) return fmt::format("row {}: another apex", row);
    if ((exit.outer != 0) != across.outer()) return fmt::format("row {}: within the cell or not", row);
    unsigned face = 0;
    CellView next = cell;
    if (across.outer()) {
      if (exit.word != 2U + shape.point_count() + across.face()) return fmt::format("row {}: another word", row);
      if (!cell.neighbour(across.face()).valid()) continue;
      next = map.view(cell.neighbour(across.face()));
      face = 1U + cell.neighbour_face(across.face());
      ++outer;
    }
    const detail::SimplexEntry& entry = next.shape().exits().entry(face, exit.place);
    const Passage expected = pass(map, {c, static_cast<std::uint16_t>(row / 4)}, cell, across);
    if (entry.row() / 4 != expected.simplex.simplex || entry.row() % 4 != expected.facet)
      return fmt::format("row {}: leads elsewhere", row);
    // The turn of corners in slots: those of the exit from corner 0 on, and those of the entry.
    const Triangle left = in_slots(cell, row, detail::exit_corners(row % 4), 0);
    const Triangle entered =
        in_slots(next, entry.row(), facet_corners[entry.row() % 4], (exit.turn + 3 - entry.turn()) % 3);
    if (entry.apex != next.shape().simplices()[entry.row() / 4].vertex[entry.row() % 4])
      return fmt::format("row {}: another apex beyond", row);
    if (left != entered) return fmt::format("row {}: corners in other slots", row);
    if (!across.outer() || cell.is_wall(across.face())) continue;
    if (c.pool() == CombinatorialMap::general_pool) {
      if (cell.words()[exit.extra] != face - 1) return fmt::format("row {}: another face, or a wall", row);
      continue;
    }
    if (((cell.words()[1] >> exit.wall_shift) & 1U) != 0) return fmt::format("row {}: a wall", row);
    if (((cell.words()[1] >> exit.face_shift) & 7U) != std::min(face - 1, 7U))
      return fmt::format("row {}: another face", row);
  }
  return "";
}

TEST(ExitTable, SaysWhatTheSimplicesSay) {
  std::size_t outer = 0;
  for (int kind = 0; kind < oracle::scene_kinds; ++kind) {
    for (int seed = 1; seed <= scaled(20, 400); ++seed) {
      const CellComplex complex(
          oracle::random_scene(static_cast<oracle::SceneKind>(kind), static_cast<std::uint64_t>(seed), 0.5));
      for (const Cell c : complex.map().cells())
        ASSERT_EQ(check_cell(complex.map(), c, outer), "")
            << oracle::name_of(static_cast<oracle::SceneKind>(kind)) << ", seed " << seed << ", cell " << c.value;
    }
  }
  EXPECT_GT(outer, sanitized() ? 500U : 1000U);
}

TEST(ExitTable, IsEmptyForPolygons) {
  RectangleOptions squares;
  const CellComplex complex(generate_rectangle(squares));
  EXPECT_TRUE(complex.map().shape(complex.map().cells().front()).exits().empty());
}

}  // namespace dartcast::test::exit_table_test
