// Straight lines on a triangle mesh, traced in space with 50 digits: points and directions, no map and no weights.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

struct Point3 {
  Real x, y, z;
  friend Point3 operator+(const Point3& a, const Point3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point3 operator-(const Point3& a, const Point3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point3 operator*(const Point3& a, const Real& s) { return {a.x * s, a.y * s, a.z * s}; }
};
inline Real inner(const Point3& a, const Point3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point3 outer(const Point3& a, const Point3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real size(const Point3& a) { return sqrt(inner(a, a)); }
inline Point3 point3(const Vec3& v) { return {v.x, v.y, v.z}; }
inline double distance(const Point3& a, const Vec3& b) { return size(a - point3(b)).convert_to<double>(); }

class GeodesicOracle {
 public:
  explicit GeodesicOracle(const MeshData& mesh) {
    for (const Vec3& p : mesh.points) points_.push_back(point3(p));
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      const auto corners = mesh.cell(c);
      const auto n = corners.size();
      const auto apex = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
      for (std::size_t i = 1; i + 1 < n; ++i)
        triangles_.push_back({corners[apex], corners[(apex + i) % n], corners[(apex + i + 1) % n]});
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (unsigned i = 0; i < 3; ++i) by_edge_[{triangles_[t][i], triangles_[t][(i + 1) % 3]}] = t;
    }
  }

  struct Path {
    Point3 end;
    Point3 direction;
    int crossings = 0;
    Real clearance = 1e9;  // of the path from vertices, on the edges that it crosses
    bool left = false;     // over an open border
  };

  // From the point of a triangle, given by its corners, with weights, along what a displacement has in its plane.
  [[nodiscard]] Path trace(std::array<std::uint32_t, 3> corners, const std::array<double, 3>& weights,
                           const Vec3& displacement) const {
    std::size_t t = find(corners);
    Path path;
    path.end = {0, 0, 0};
    Real sum = 0;
    for (unsigned i = 0; i < 3; ++i) {
      path.end = path.end + points_[corners[i]] * Real(weights[i]);
      sum += weights[i];
    }
    path.end = path.end * (1 / sum);
    const Point3 n = normal(t);
    const Point3 way = point3(displacement) - n * inner(n, point3(displacement));
    Real left = size(way);
    path.direction = way * (1 / left);
    int entry = -1;
    while (true) {
      int leave = -1;
      Real least = 0;
      for (int i = 0; i < 3; ++i) {
        if (i == entry) continue;
        const Point3 out = outward(t, i);
        const Real speed = inner(out, path.direction);
        if (speed <= 0) continue;
        const Real way_out = inner(out, points_[triangles_[t][static_cast<unsigned>(i)]] - path.end) / speed;
        if (leave < 0 || way_out < least) {
          leave = i;
          least = way_out;
        }
      }
      if (leave < 0) throw std::logic_error("no way out of a triangle");
      if (least >= left) {
        path.end = path.end + path.direction * left;
        return path;
      }
      left -= least;
      path.end = path.end + path.direction * least;
      const std::uint32_t a = triangles_[t][static_cast<unsigned>(leave)];
      const std::uint32_t b = triangles_[t][static_cast<unsigned>(leave + 1) % 3];
      for (const std::uint32_t v : {a, b}) path.clearance = std::min(path.clearance, size(points_[v] - path.end));
      const auto next = by_edge_.find({b, a});
      path.left = next == by_edge_.end();
      if (path.left) return path;
      ++path.crossings;
      cross(path, a, b, t, next->second);
      t = next->second;
      entry = triangles_[t][0] == b ? 0 : triangles_[t][1] == b ? 1 : 2;
    }
  }

 private:
  [[nodiscard]] std::size_t find(const std::array<std::uint32_t, 3>& corners) const {
    return by_edge_.at({corners[0], corners[1]});
  }
  [[nodiscard]] Point3 normal(std::size_t t) const {
    const auto& v = triangles_[t];
    const Point3 n = outer(points_[v[1]] - points_[v[0]], points_[v[2]] - points_[v[0]]);
    return n * (1 / size(n));
  }
  [[nodiscard]] Point3 outward(std::size_t t, int edge) const {
    const auto i = static_cast<unsigned>(edge);
    return outer(points_[triangles_[t][(i + 1) % 3]] - points_[triangles_[t][i]], normal(t));
  }
  // Turns the direction about the edge, by the angle between the planes.
  void cross(Path& path, std::uint32_t a, std::uint32_t b, std::size_t from, std::size_t to) const {
    const Point3 edge = points_[b] - points_[a];
    const Point3 axis = edge * (1 / size(edge));
    const Point3 out = outer(axis, normal(from));
    const Point3 in = outer(axis, normal(to));
    path.direction = axis * inner(path.direction, axis) + in * inner(path.direction, out);
    path.direction = path.direction * (1 / size(path.direction));
  }

  std::vector<Point3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> by_edge_;
};

}  // namespace dartcast::test
