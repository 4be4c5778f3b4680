#include "dartcast/geometry/interior.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "dartcast/mesh/cell_types.hpp"

namespace dartcast {

namespace {

using Faces = std::vector<std::vector<std::uint32_t>>;

Faces faces_of(const MeshData& mesh, std::uint32_t c) {
  Faces faces;
  for_each_face(mesh, c,
                [&](std::span<const std::uint32_t> corners) { faces.emplace_back(corners.begin(), corners.end()); });
  return faces;
}

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> v) {
  std::sort(v.begin(), v.end());
  return v;
}

Vec3 mean(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& corners) {
  Vec3 sum;
  for (const std::uint32_t v : corners) sum += points[v];
  return sum * (1.0 / static_cast<double>(corners.size()));
}

struct Triangle {
  Vec3 a, b, c;  // counterclockwise seen from the outside
};

// The fan of a face: from its point, or from its lowest-numbered vertex.
std::vector<Triangle> fan(const std::vector<Vec3>& points, std::vector<std::uint32_t> face, bool has_point) {
  std::vector<Triangle> triangles;
  const std::size_t k = face.size();
  if (has_point) {
    const Vec3 m = mean(points, face);
    for (std::size_t i = 0; i < k; ++i) triangles.push_back({m, points[face[i]], points[face[(i + 1) % k]]});
    return triangles;
  }
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  for (std::size_t i = 1; i + 1 < k; ++i) triangles.push_back({points[face[0]], points[face[i]], points[face[i + 1]]});
  return triangles;
}

bool all_positive(const Vec3& apex, const std::vector<Triangle>& triangles) {
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const Triangle& t) { return orient3d(apex, t.a, t.b, t.c) == Sign::positive; });
}

// A point strictly behind all triangles, found by moving away from the nearest one; `start` where there is none. What
// it returns is only a proposal: the validity check decides.
Vec3 kernel_point(const Vec3& start, const std::vector<Triangle>& triangles, double size) {
  constexpr int steps = 400;
  Vec3 x = start;
  Vec3 best = start;
  double best_distance = -size;
  for (int k = 0; k < steps; ++k) {
    double nearest = 2.0 * size;
    Vec3 inward;
    for (const Triangle& t : triangles) {
      Vec3 n = cross((t.c - t.a) * (1.0 / size), (t.b - t.a) * (1.0 / size));  // of a magnitude that can be squared
      const double length = norm(n);
      if (!(length > 0.0)) continue;
      n *= 1.0 / length;
      const double distance = dot(n, x - t.a);
      if (distance < nearest) {
        nearest = distance;
        inward = n;
      }
    }
    if (nearest > best_distance) {
      best_distance = nearest;
      best = x;
    }
    x += inward * (0.25 * size / (k + 2.0));
  }
  return best;
}

// Weights over the corners, summing to 1, that give x: the equal weights and the least correction.
std::vector<double> weights_for(const Vec3& x, const std::vector<Vec3>& points,
                                const std::vector<std::uint32_t>& corners) {
  const Vec3 m = mean(points, corners);
  const auto n = static_cast<Eigen::Index>(corners.size());
  Eigen::Matrix3Xd centred(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 d = points[corners[static_cast<std::size_t>(i)]] - m;
    centred.col(i) << d.x, d.y, d.z;
  }
  const Eigen::Vector3d offset(x.x - m.x, x.y - m.y, x.z - m.z);
  const Eigen::Matrix3d gram = centred * centred.transpose();
  const Eigen::VectorXd correction = centred.transpose() * gram.ldlt().solve(offset);
  std::vector<double> weights(corners.size());
  for (Eigen::Index i = 0; i < n; ++i)
    weights[static_cast<std::size_t>(i)] = 1.0 / static_cast<double>(n) + correction(i);
  return weights;
}

class Solver {
 public:
  Solver(const MeshData& mesh, const Map& plain) : mesh_(mesh), plain_(plain) { number_cells(); }

  InteriorSolution solve(std::span<const Cell> cells) {
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
  // The plain map has a cell for each of the mesh, in the mesh's order within each type.
  void number_cells() {
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c)
      number_[static_cast<std::size_t>(mesh_.types[c])].push_back(c);
    cell_.resize(mesh_.cell_count());
    for (std::uint32_t p = 0; p < number_.size(); ++p) {
      for (std::uint32_t i = 0; i < number_[p].size(); ++i) cell_[number_[p][i]] = Cell(p, i);
    }
  }

  // A cell that is to have a point of its own: no longer coned from a corner, all its fans must be positive.
  void add_cell(std::uint32_t c) {
    if (with_point_.insert(c).second) chosen_.push_back(c);
  }

  // A face whose triangles are not all positive seen from the mean of the cell's corners, but would be with a point.
  void choose_face_points(std::uint32_t c) {
    const Faces faces = faces_of(mesh_, c);
    const Vec3 m = mean(mesh_.points, corners_of(faces));
    for (const auto& face : faces) {
      if (face.size() == 3 || all_positive(m, fan(mesh_.points, face, false))) continue;
      if (!all_positive(m, fan(mesh_.points, face, true))) continue;
      auto& sides = face_points_[sorted(face)];
      sides = cells_at(c, face);
      for (const auto& side : sides) add_cell(side.first);
    }
  }

  static std::vector<std::uint32_t> corners_of(const Faces& faces) {
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
    const Faces faces = faces_of(mesh_, c);
    const auto found = std::find_if(faces.begin(), faces.end(), [&](const auto& f) { return sorted(f) == key; });
    return static_cast<std::uint16_t>(found - faces.begin());
  }

  Vertex add_vertex(const std::vector<std::uint32_t>& corners, const std::vector<double>& weights) {
    auto& w = solution_.weights;
    w.corner.insert(w.corner.end(), corners.begin(), corners.end());
    w.weight.insert(w.weight.end(), weights.begin(), weights.end());
    w.offsets.push_back(w.corner.size());
    return Vertex(static_cast<std::uint32_t>(mesh_.points.size() + w.count() - 1));
  }

  void add_face_point(const std::vector<std::uint32_t>& corners, const std::vector<Side>& sides) {
    const std::vector<double> equal(corners.size(), 1.0 / static_cast<double>(corners.size()));
    const Vertex point = add_vertex(corners, equal);
    for (const auto& [cell, face] : sides) solution_.points.of_faces.push_back({cell, face, point});
  }

  void add_cell_point(std::uint32_t c) {
    const Faces faces = faces_of(mesh_, c);
    std::vector<Triangle> triangles;
    for (const auto& face : faces) {
      const auto of_face = fan(mesh_.points, face, face_points_.count(sorted(face)) != 0);
      triangles.insert(triangles.end(), of_face.begin(), of_face.end());
    }
    const auto corners = corners_of(faces);
    const Vec3 m = mean(mesh_.points, corners);
    std::vector<double> weights(corners.size(), 1.0 / static_cast<double>(corners.size()));
    if (!all_positive(m, triangles)) {
      double size = 0.0;
      for (const std::uint32_t v : corners) size = std::max(size, norm(mesh_.points[v] - m));
      const Vec3 x = kernel_point(m, triangles, size);
      if (all_positive(x, triangles)) weights = weights_for(x, mesh_.points, corners);
    }
    solution_.points.of_cells.emplace_back(c, add_vertex(corners, weights));
  }

  const MeshData& mesh_;
  const Map& plain_;
  std::array<std::vector<std::uint32_t>, 5> number_;  // by pool and index: the cell's number in the mesh
  std::vector<Cell> cell_;                            // and back
  std::set<std::uint32_t> with_point_;
  std::vector<std::uint32_t> chosen_;  // the same, in the order found
  std::map<std::vector<std::uint32_t>, std::vector<Side>> face_points_;
  InteriorSolution solution_;
};

}  // namespace

InteriorSolution find_interior_points(const MeshData& mesh, const Map& plain, std::span<const Cell> cells) {
  return Solver(mesh, plain).solve(cells);
}

void compute_interior(const InteriorWeights& weights, std::span<Vec3> positions) {
  const std::size_t first = positions.size() - weights.count();
  for (std::size_t i = 0; i < weights.count(); ++i) {
    Vec3 sum;
    for (std::size_t k = weights.offsets[i]; k < weights.offsets[i + 1]; ++k) {
      sum += positions[weights.corner[k]] * weights.weight[k];
    }
    positions[first + i] = sum;
  }
}

}  // namespace dartcast
