// All walls of a complex with the boxes around their ways in the last move, for steps of many points: most are near none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/threads.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

/// The vertices of a wall's triangle.
using WallCorners = std::array<std::uint32_t, 3>;

/// A point's way, and a wall's triangle.
struct WayAndWall {
  std::uint32_t way;
  WallCorners corners;
};

/// In space.
class MovingWalls {
 public:
  /// Which complex, after how many edits: the walls of another are listed anew.
  struct Version {
    std::uint64_t environment = 0;
    std::uint64_t edits = 0;
    bool operator==(const Version&) const = default;
  };

  /// Lists the walls, if those of another version are known. Cost: linear in the cells.
  void list(const CellComplex& complex, const Version& version);
  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }

  /// Brings the boxes to the last move. Precondition: list(). Cost: linear in the walls.
  void update(const CellComplex& complex, Threads threads);

  /// Appends the triangles of all walls whose box meets that of the way with this number. Precondition: update().
  void find_near(const Vec3& from, const Vec3& to, std::uint32_t way, std::vector<WayAndWall>& pairs) const;

 private:
  std::optional<Version> version_;
  // For each wall, and one more: the first of its triangles, and of its points.
  struct First {
    std::uint32_t triangle, point;
  };
  std::vector<First> first_;
  std::vector<WallCorners> triangles_;
  std::vector<std::uint32_t> points_;
  std::optional<BoxTree> tree_;
};

namespace detail {

/// Moves the pairs that a filter does not prove apart to the front, in their order, and returns their number. It is the first
/// part of filtered_touch(), for four pairs at a time, and proves the same. The points go from their states' positions to the
/// targets, vertices from before to after. Cost: 90 instructions a pair.
std::size_t keep_undecided(std::span<WayAndWall> pairs, const ParticleState* states, const Vec3* targets,
                           const Vec3* before, const Vec3* after, InstructionSet set = best_instruction_set());

namespace portable {
std::size_t undecided_pairs(std::span<WayAndWall> pairs, const ParticleState* states, const Vec3* targets,
                            const Vec3* before, const Vec3* after);
}  // namespace portable
namespace avx2 {
std::size_t undecided_pairs(std::span<WayAndWall> pairs, const ParticleState* states, const Vec3* targets,
                            const Vec3* before, const Vec3* after);
}  // namespace avx2

}  // namespace detail

}  // namespace dartcast
