// Finds Steiner points for cells of a mesh without a positive pulling triangulation.
#include "complex/steiner_points.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "complex/cone_point.hpp"
#include "dartcast/error.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {

namespace {

using detail::all_positive;
using detail::ConeTriangle;
using detail::fan;
using detail::mean;

using CornerLists = std::vector<std::vector<std::uint32_t>>;

CornerLists faces_of(const MeshData& mesh, std::uint32_t c) {
  CornerLists faces;
  for_each_face(mesh, c,
                [&](std::span<const std::uint32_t> corners) { faces.emplace_back(corners.begin(), corners.end()); });
  return faces;
}

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> v) {
  std::sort(v.begin(), v.end());
  return v;
}

class SteinerSolver {
 public:
  SteinerSolver(const MeshData& mesh, const CombinatorialMap& plain) : mesh_(mesh), plain_(plain) { number_cells(); }

  SteinerSolution solve(std::span<const Cell> cells) {
    for (const Cell c : cells) add_cell(number_[c.pool()][c.index()]);
    for (std::size_t i = 0; i < chosen_.size(); ++i) choose_face_points(chosen_[i]);
    for (const auto& [corners, sides] : face_points_) add_face_point(corners, sides);
    for (const std::uint32_t c : with_point_) add_cell_point(c);
    std::sort(solution_.points.of_faces.begin(), solution_.points.of_faces.end(), [](const auto& a, const auto& b) {
      return std::pair{a.cell, a.face} < std::pair{b.cell, b.face};
    });
    return std::move(solution_);
  }

 private:
  // The plain map has one cell for each cell of the mesh, in the mesh's order within each type.
  void number_cells() {
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c)
      number_[CombinatorialMap::pool_of(mesh_.types[c])].push_back(c);
    cell_.resize(mesh_.cell_count());
    for (std::uint32_t p = 0; p < number_.size(); ++p) {
      for (std::uint32_t i = 0; i < number_[p].size(); ++i) cell_[number_[p][i]] = Cell(p, i);
    }
  }

  // Takes a cell that needs a Steiner point. It is no longer coned from a corner, so all its fans must be positive.
  void add_cell(std::uint32_t c) {
    if (with_point_.insert(c).second) chosen_.push_back(c);
  }

  // A face whose triangles are not all positive as seen from the mean of the cell's corners, but would be with a point.
  void choose_face_points(std::uint32_t c) {
    if (plain_.dimension() == 2) return;
    const CornerLists faces = faces_of(mesh_, c);
    const Vec3 m = mean(mesh_.points, corners_of(faces));
    for (const auto& face : faces) {
      if (face.size() == 3 || all_positive(m, fan(mesh_.points, face))) continue;
      if (!all_positive(m, fan(mesh_.points, face, mean(mesh_.points, face)))) continue;
      auto& sides = face_points_[sorted(face)];
      sides = cells_at(c, face);
      for (const auto& side : sides) add_cell(side.first);
    }
  }

  static std::vector<std::uint32_t> corners_of(const CornerLists& faces) {
    std::set<std::uint32_t> corners;
    for (const auto& face : faces) corners.insert(face.begin(), face.end());
    return {corners.begin(), corners.end()};
  }

  using Side = std::pair<std::uint32_t, std::uint16_t>;  // cell and face, in the mesh's numbers

  [[nodiscard]] std::vector<Side> cells_at(std::uint32_t c, const std::vector<std::uint32_t>& face) const {
    const auto key = sorted(face);
    std::vector<Side> sides = {{c, index_of(c, key)}};
    const CellView v = plain_.view(cell_[c]);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      std::vector<std::uint32_t> corners;
      for (const std::uint16_t k : v.shape().corners(f)) corners.push_back(v.vertex(k).value);
      if (sorted(corners) != key || !v.neighbour(f).valid()) continue;
      const Cell other = v.neighbour(f);
      const std::uint32_t number = number_[other.pool()][other.index()];
      sides.emplace_back(number, index_of(number, key));
    }
    return sides;
  }

  [[nodiscard]] std::uint16_t index_of(std::uint32_t c, const std::vector<std::uint32_t>& key) const {
    const CornerLists faces = faces_of(mesh_, c);
    const auto found = std::find_if(faces.begin(), faces.end(), [&](const auto& f) { return sorted(f) == key; });
    return static_cast<std::uint16_t>(found - faces.begin());
  }

  Vertex add_vertex(const std::vector<std::uint32_t>& corners, const std::vector<double>& weights) {
    const std::size_t number = mesh_.points.size() + solution_.weights.count();
    if (number >= Vertex::invalid_value)
      throw InvalidMesh("more than 2^32 - 2 vertices, with those that cells need inside: split the mesh");
    const Vertex v(static_cast<std::uint32_t>(number));
    solution_.weights.add(v, corners, weights);
    return v;
  }

  void add_face_point(const std::vector<std::uint32_t>& corners, const std::vector<Side>& sides) {
    const std::vector<double> equal(corners.size(), 1.0 / static_cast<double>(corners.size()));
    const Vertex point = add_vertex(corners, equal);
    for (const auto& [cell, face] : sides) solution_.points.of_faces.push_back({cell, face, point});
  }

  void add_cell_point(std::uint32_t c) {
    const CornerLists faces = faces_of(mesh_, c);
    if (plain_.dimension() == 2) {  // the mean of a convex polygon's corners is inside
      const auto all = corners_of(faces);
      const std::vector<double> equal(all.size(), 1.0 / static_cast<double>(all.size()));
      solution_.points.of_cells.emplace_back(c, add_vertex(all, equal));
      return;
    }
    std::vector<ConeTriangle> triangles;
    for (const auto& face : faces) {
      std::optional<Vec3> point;
      if (face_points_.count(sorted(face)) != 0) point = mean(mesh_.points, face);
      detail::add_fan(triangles, face, point, [&](std::uint32_t v) { return mesh_.points[v]; });
    }
    const auto corners = corners_of(faces);
    const Vertex point = add_vertex(corners, detail::cone_weights(mesh_.points, corners, triangles));
    solution_.points.of_cells.emplace_back(c, point);
  }

  const MeshData& mesh_;
  const CombinatorialMap& plain_;
  std::array<std::vector<std::uint32_t>, 5> number_;  // by pool and index: the cell's number in the mesh
  std::vector<Cell> cell_;                            // the cell by its number
  std::set<std::uint32_t> with_point_;
  std::vector<std::uint32_t> chosen_;  // the same, in the order found
  std::map<std::vector<std::uint32_t>, std::vector<Side>> face_points_;
  SteinerSolution solution_;
};

}  // namespace

SteinerSolution find_steiner_points(const MeshData& mesh, const CombinatorialMap& plain, std::span<const Cell> cells) {
  return SteinerSolver(mesh, plain).solve(cells);
}

}  // namespace dartcast
