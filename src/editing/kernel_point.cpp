// The middle of the largest ball behind some planes, by the dual simplex method.
#include "editing/kernel_point.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <vector>

namespace dartcast::detail {

namespace {

using Row = Eigen::Vector4d;

// A row (n, 1) with limit h means n x + r <= h: the ball of radius r around x is behind the plane. A row (n, 0) means
// that x is behind it.
struct HalfSpace {
  Row row;
  double limit;
};

// The surface is scaled to the unit ball around `middle`, so that the kernel is inside the cube of planes put first.
class BallProgram {
 public:
  explicit BallProgram(std::span<const ConeTriangle> triangles) {
    for (const ConeTriangle& t : triangles) middle_ += (t.a + t.b + t.c) * (1.0 / 3.0);
    middle_ *= 1.0 / static_cast<double>(triangles.size());
    for (const ConeTriangle& t : triangles) {
      for (const Vec3& x : {t.a, t.b, t.c}) size_ = std::max(size_, norm(x - middle_));
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) planes_.push_back({sign * Row::Unit(axis), 1.0});
    }
    for (const ConeTriangle& t : triangles) add(t);
  }

  // Nothing if a triangle has no plane.
  [[nodiscard]] std::optional<Vec3> solve() {
    if (flat_ || planes_.size() <= cube) return {};
    start();
    // Far more steps than are ever necessary, unless rounding leads in circles.
    constexpr int max_exchanges = 300;
    for (int i = 0; i < max_exchanges; ++i) {
      if (!exchange(i < max_exchanges / 2)) break;
    }
    return middle_ + Vec3{x_[0], x_[1], x_[2]} * size_;
  }

 private:
  static constexpr std::size_t cube = 6;
  // Planes are unit vectors, distances are in units of the surface: a few thousand roundings.
  static constexpr double tolerance = 1e-12;

  void add(const ConeTriangle& t) {
    const double scale = 1.0 / size_;
    const Vec3 a = (t.a - middle_) * scale;
    Vec3 n = cross((t.b - t.a) * scale, (t.c - t.a) * scale);
    const double length = norm(n);
    flat_ = flat_ || !(length > 0.0);
    n *= 1.0 / length;
    planes_.push_back({Row(n.x, n.y, n.z, 1.0), dot(n, a)});
  }

  // The start: one triangle, and the planes of the cube that stand against it.
  void start() {
    basis_[0] = cube;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double n = planes_[cube].row[static_cast<Eigen::Index>(axis)];
      basis_[axis + 1] = 2 * axis + (n > 0.0 ? 1 : 0);
    }
  }

  // The dual simplex method: x lies on four planes. It replaces one of these by the plane that x is farthest beyond
  // (or, to avoid circles, by the first such plane). False if x is behind all planes.
  bool exchange(bool farthest) {
    Eigen::Matrix4d rows;
    Row limits;
    for (Eigen::Index k = 0; k < 4; ++k) {
      rows.row(k) = planes_[basis_[static_cast<std::size_t>(k)]].row;
      limits[k] = planes_[basis_[static_cast<std::size_t>(k)]].limit;
    }
    const Eigen::PartialPivLU<Eigen::Matrix4d> equations(rows);
    const Eigen::PartialPivLU<Eigen::Matrix4d> dual(rows.transpose());
    x_ = equations.solve(limits);
    std::size_t entering = planes_.size();
    double limit = tolerance;
    for (std::size_t i = 0; i < planes_.size() && (farthest || entering == planes_.size()); ++i) {
      const double beyond = planes_[i].row.dot(x_) - planes_[i].limit;
      if (!(beyond > limit)) continue;
      limit = beyond;
      entering = i;
    }
    if (entering == planes_.size()) return false;
    const Row weights = dual.solve(Row::Unit(3));
    const Row change = dual.solve(planes_[entering].row);
    std::size_t leaving = 4;
    double lowest = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto e = static_cast<Eigen::Index>(k);
      if (!(change[e] > tolerance)) continue;
      const double ratio = weights[e] / change[e];
      if (leaving != 4 && !(ratio < lowest)) continue;
      lowest = ratio;
      leaving = k;
    }
    if (leaving == 4) return false;
    basis_[leaving] = entering;
    return true;
  }

  Vec3 middle_;
  double size_ = 0.0;
  bool flat_ = false;
  std::vector<HalfSpace> planes_;
  std::array<std::size_t, 4> basis_{};
  Row x_ = Row::Zero();
};

}  // namespace

std::optional<Vec3> kernel_point(std::span<const ConeTriangle> triangles) {
  const std::optional<Vec3> x = BallProgram(triangles).solve();
  return x && all_positive(*x, triangles) ? x : std::nullopt;
}

}  // namespace dartcast::detail
