// The form that a cell had before vertices were put on its edges and its faces were split. Private to editing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// Corners, edges from corner to corner, and sides of one or more faces. Faces that may lie in one plane are one side
/// if they look like a subdivision. This is a disc with a vertex inside, from which separate paths lead to a vertex on
/// each edge. Every other face is a side. Vertices, faces and darts have their numbers in the cell's shape.
class Outline {
 public:
  static constexpr std::uint16_t none = 0xffffU;

  /// Starts at a corner, so that edge i leads from corner i to the next.
  struct Side {
    std::vector<std::uint16_t> faces;
    std::vector<std::uint16_t> corner_of;           ///< for each face the corner in whose part it lies; one face: none
    std::vector<std::uint16_t> corners;             ///< counterclockwise seen from the outside
    std::vector<std::vector<std::uint16_t>> edges;  ///< the darts of each
    std::vector<std::uint16_t> edge_middles;        ///< one on each edge; none: there is no vertex
    /// The vertices of the paths from the middle to each of these. Empty: one face, with nothing inside.
    std::vector<std::vector<std::uint16_t>> spokes;
  };

  /// `positions`: of the cell's corners. If several vertices could be a middle, the nearest to it is taken. Throws
  /// EditRefused if a side would have fewer than three corners. Cost: linear in the darts, on average.
  Outline(const CombinatorialMap& map, Cell c, std::span<const Vec3> positions);

  [[nodiscard]] const std::vector<Side>& sides() const { return sides_; }
  [[nodiscard]] std::uint16_t side_of(std::uint16_t dart) const { return number_[class_[shape_.face_of(dart)]]; }
  /// The number, in its side, of the edge that a dart of the rim lies on.
  [[nodiscard]] std::uint16_t edge_of(std::uint16_t dart) const { return edge_of_[dart]; }
  /// Whether the dart lies along a spoke.
  [[nodiscard]] bool is_cut(std::uint16_t dart) const { return cut_[dart]; }
  /// Vertices at which three sides meet.
  [[nodiscard]] std::vector<std::uint16_t> corners() const;

 private:
  void join_coplanar(const CombinatorialMap& map, Cell c);
  bool trace(const CombinatorialMap& map, Cell c);
  std::optional<Side> side_with(std::vector<std::uint16_t> faces);
  bool trace_rim(Side& side);
  bool find_spokes(Side& side);
  bool give_out(Side& side);
  [[nodiscard]] bool on_rim(std::uint16_t d) const {
    return class_[shape_.face_of(d)] != class_[shape_.face_of(shape_.phi2(d))];
  }
  [[nodiscard]] bool is_corner(std::uint16_t v) const { return rims_at_[v] >= 3; }
  [[nodiscard]] std::uint16_t nearest(std::span<const std::uint16_t> vertices, const Vec3& x) const;
  [[nodiscard]] std::vector<std::uint16_t> reach(std::uint16_t from) const;
  [[nodiscard]] std::uint16_t dart_between(std::uint16_t from, std::uint16_t to) const;

  const Shape& shape_;
  std::span<const Vec3> positions_;
  std::vector<std::uint16_t> class_;    // of each face: the lowest face of its side
  std::vector<std::uint16_t> dart_at_;  // of each vertex: one that starts there
  std::vector<std::uint16_t> rims_at_;  // of each vertex: edges there between two sides
  std::vector<std::uint16_t> edge_of_;
  std::vector<bool> cut_;              // darts of spokes
  std::vector<std::uint16_t> number_;  // of the side, by class
  std::vector<Side> sides_;
};

}  // namespace dartcast::detail
