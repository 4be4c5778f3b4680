// The implicit simplices of a mesh, written out: slow, simple, and without any code of the library.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::oracle {

using Triangle = std::array<std::uint32_t, 3>;
using Tetrahedron = std::array<std::uint32_t, 4>;

inline constexpr std::uint32_t none = 0xffffffffU;

/// Points that cells and faces are coned or fanned from instead of their lowest-numbered vertex: numbers of vertices
/// beyond the mesh's own points. Faces are named by the cell and their place in the mesh's order, from both sides.
struct InteriorVertices {
  std::map<std::uint32_t, std::uint32_t> of_cell;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> of_face;
};

struct Simplex {
  Tetrahedron vertex;  ///< positive in a valid cell
  std::uint32_t cell = none;
  std::array<std::uint32_t, 4> beyond = {none, none, none,
                                         none};  ///< the simplex beyond the facet opposite to vertex i
  std::array<std::uint32_t, 4> wall = {none, none, none,
                                       none};  ///< the wall triangle there; a facet may be one in free cells only
};

/// A triangle of a wall's fan, counterclockwise seen from outside of the free cell.
struct WallTriangle {
  Triangle vertex;
  std::uint32_t cell = none;  ///< the free cell
  std::uint32_t face = none;  ///< in the mesh's order
  std::array<bool, 3> mesh_edge =
      {};  ///< whether the edge from corner i to the next is an edge of the mesh, not a diagonal of the fan
};

/// Corners of the faces of a cell in the mesh's order, counterclockwise seen from the outside.
std::vector<std::vector<std::uint32_t>> faces_of(const MeshData& mesh, std::size_t cell);

/// Fan of a face from its lowest-numbered vertex, or from `point` where there is one.
std::vector<Triangle> fan(const std::vector<std::uint32_t>& face, std::uint32_t point = none);

class Triangulation {
 public:
  explicit Triangulation(const MeshData& mesh, const InteriorVertices& interior = {});

  [[nodiscard]] const std::vector<Simplex>& simplices() const { return simplices_; }
  [[nodiscard]] const std::vector<WallTriangle>& walls() const { return walls_; }
  [[nodiscard]] bool is_free(std::uint32_t cell) const { return free_[cell]; }
  [[nodiscard]] std::size_t mesh_point_count() const { return mesh_point_count_; }

  /// The simplex of a cell with these vertices in any order; none if there is none.
  [[nodiscard]] std::uint32_t find(std::uint32_t cell, Tetrahedron vertices) const;

  /// Dimension of the cell of the mesh whose inside holds the inside of the hull of these vertices (1 to 4 of one
  /// simplex of `cell`): 0 a vertex, 1 an edge, 2 a face, 3 the cell.
  [[nodiscard]] int dimension(std::uint32_t cell, const std::vector<std::uint32_t>& vertices) const;

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  void add_cell(const MeshData& mesh, std::uint32_t cell, const InteriorVertices& interior);
  void add_simplex(std::uint32_t cell, const Triangle& t, std::uint32_t apex);
  [[nodiscard]] std::uint32_t face_with(std::uint32_t cell, const Triangle& outward) const;
  void connect();
  void add_wall(std::uint32_t simplex, std::uint32_t facet);

  std::size_t mesh_point_count_;
  std::vector<bool> free_;
  std::vector<Simplex> simplices_;
  std::vector<WallTriangle> walls_;
  std::vector<std::vector<std::vector<std::uint32_t>>> faces_;  // per cell: sorted corners, and the face's point
  std::vector<std::map<Triangle, std::uint32_t>> fans_;         // per cell: triangles, and their faces
  std::set<Edge> edges_;
  std::map<std::pair<std::uint32_t, Tetrahedron>, std::uint32_t> by_vertices_;
};

}  // namespace dartcast::oracle
