// Squares of a lattice in the plane, cut into triangles or merged into polygons.
#include "generators/generate_squares.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/ids.hpp"

namespace dartcast {
namespace {

constexpr std::uint32_t merged = 0xffffffffU;

std::array<double, 2> size_of(const RectangleOptions& o) {
  return o.size.value_or(std::array{static_cast<double>(o.cells[0]), static_cast<double>(o.cells[1])});
}

// Lattice, cuts and marks of one rectangle while it is built.
class SquaresBuilder {
 public:
  SquaresBuilder(const RectangleOptions& options, std::span<const std::uint8_t> blocked)
      : o_(options), size_(size_of(options)), nx_(options.cells[0]), ny_(options.cells[1]), blocked_(blocked) {}

  MeshData build() {
    choose_merges();
    add_points();
    Random random(o_.seed, 3);
    for (std::uint32_t j = 0; j < ny_; ++j) {
      for (std::uint32_t i = 0; i < nx_; ++i) {
        const bool cut = o_.mixed ? random.below(2) == 0 : o_.type == CellType::triangle;
        add_square(i, j, cut);
      }
    }
    for (std::uint32_t j = 1; j < ny_; ++j) {
      for (std::uint32_t i = 1; i < nx_; ++i) {
        if (point(i, j) == merged) add_hexagon(i, j);
      }
    }
    add_sides();
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::uint32_t& point(std::uint32_t i, std::uint32_t j) {
    return number_[i + (std::size_t{nx_} + 1) * j];
  }

  [[nodiscard]] bool is_blocked(std::uint32_t i, std::uint32_t j) const {
    return !blocked_.empty() && blocked_[i + std::size_t{nx_} * j] != 0;
  }

  // With every square cut from its lowest corner to its highest, (i + j) mod 3 is a different number at the three
  // corners of each triangle. Around the points with 0 there are hexagons that do not overlap.
  void choose_merges() {
    number_.assign((std::size_t{nx_} + 1) * (std::size_t{ny_} + 1), 0);
    if (!o_.mixed && o_.type != CellType::polygon) return;
    Random random(o_.seed, 4);
    for (std::uint32_t j = 1; j < ny_; ++j) {
      for (std::uint32_t i = 1; i < nx_; ++i) {
        const bool mark = is_blocked(i, j);
        const bool alike =
            is_blocked(i - 1, j - 1) == mark && is_blocked(i, j - 1) == mark && is_blocked(i - 1, j) == mark;
        if ((i + j) % 3 != 0 || !alike) continue;
        if (!o_.mixed || random.below(2) == 0) point(i, j) = merged;
      }
    }
  }

  static double coordinate(double origin, double size, std::uint32_t i, std::uint32_t n) {
    return origin + (i == n ? size : size * i / n);
  }

  void add_points() {
    Random random(o_.seed, 1);
    const auto shift = [&](double edge) { return o_.jitter * (random.uniform() - 0.5) * edge; };
    for (std::uint32_t j = 0; j <= ny_; ++j) {
      for (std::uint32_t i = 0; i <= nx_; ++i) {
        Vec3 p = {coordinate(o_.origin[0], size_[0], i, nx_), coordinate(o_.origin[1], size_[1], j, ny_), 0.0};
        if (i > 0 && j > 0 && i < nx_ && j < ny_ && o_.jitter > 0) {
          p.x += shift(size_[0] / nx_);
          p.y += shift(size_[1] / ny_);
        }
        if (point(i, j) == merged) continue;
        point(i, j) = static_cast<std::uint32_t>(mesh_.points.size());
        mesh_.points.push_back(p);
      }
    }
  }

  void add_cell(CellType type, std::span<const std::uint32_t> corners, bool blocked) {
    mesh_.add_cell(type, corners);
    if (!blocked_.empty()) mesh_.free.push_back(blocked ? 0 : 1);
  }

  // The part of a square that hexagons leave.
  void add_square(std::uint32_t i, std::uint32_t j, bool cut) {
    const std::array<std::uint32_t, 4> p = {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)};
    if (p[0] == merged || p[2] == merged) return;
    const bool blocked = is_blocked(i, j);
    if (!cut && p[1] != merged && p[3] != merged) {
      add_cell(CellType::quadrilateral, p, blocked);
      return;
    }
    if (p[1] != merged) add_cell(CellType::triangle, std::array{p[0], p[1], p[2]}, blocked);
    if (p[3] != merged) add_cell(CellType::triangle, std::array{p[0], p[2], p[3]}, blocked);
  }

  void add_hexagon(std::uint32_t i, std::uint32_t j) {
    const std::array<std::uint32_t, 6> corners = {point(i - 1, j - 1), point(i, j - 1), point(i + 1, j),
                                                  point(i + 1, j + 1), point(i, j + 1), point(i - 1, j)};
    add_cell(CellType::polygon, corners, is_blocked(i, j));
  }

  void add_sides() {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::int32_t tag) {
      mesh_.add_patch_face(std::array{a, b}, tag);
    };
    for (std::uint32_t j = 0; j < ny_; ++j) add(point(0, j + 1), point(0, j), 1);
    for (std::uint32_t j = 0; j < ny_; ++j) add(point(nx_, j), point(nx_, j + 1), 2);
    for (std::uint32_t i = 0; i < nx_; ++i) add(point(i, 0), point(i + 1, 0), 3);
    for (std::uint32_t i = 0; i < nx_; ++i) add(point(i + 1, ny_), point(i, ny_), 4);
    mesh_.patch_names = {{1, "xmin"}, {2, "xmax"}, {3, "ymin"}, {4, "ymax"}};
  }

  const RectangleOptions& o_;
  const std::array<double, 2> size_;
  const std::uint32_t nx_, ny_;
  const std::span<const std::uint8_t> blocked_;
  std::vector<std::uint32_t> number_;  // per point of the lattice: in the mesh; merged: left out
  MeshData mesh_;
};

}  // namespace

MeshData generate_squares(const RectangleOptions& options, std::span<const std::uint8_t> blocked) {
  return SquaresBuilder(options, blocked).build();
}

void check_squares(const RectangleOptions& o, const char* generator) {
  const auto refuse = [&](const std::string& why) { throw InvalidArgument(fmt::format("{}: {}", generator, why)); };
  if (o.cells[0] == 0 || o.cells[1] == 0) refuse("no cells along an axis; give at least 1 along each");
  const std::array<double, 2> size = size_of(o);
  for (std::size_t a = 0; a < 2; ++a) {
    if (!std::isfinite(o.origin[a]) || !std::isfinite(size[a]) || !std::isfinite(o.origin[a] + size[a]))
      refuse("origin and size must be finite numbers");
    if (!(size[a] > 0)) refuse("size must be positive along each axis");
  }
  if (!(o.blocked_share >= 0 && o.blocked_share <= 1)) refuse("blocked_share must be in [0, 1]");
  if (!o.mixed && dimension(o.type) != 2) refuse("cells of space; take triangles, quadrilaterals or polygons");
  const double limit = o.mixed || o.type == CellType::polygon ? largest_polygon_jitter : largest_square_jitter;
  if (!(o.jitter >= 0 && o.jitter <= limit)) refuse(fmt::format("jitter must be in [0, {}] for these cells", limit));
  const std::uint64_t max_per_square = !o.mixed && o.type == CellType::quadrilateral ? 1 : 2;
  if (Cell::index_mask / max_per_square / o.cells[0] / o.cells[1] == 0) {
    refuse(fmt::format("{} x {} squares of up to {} cells are more than the {} cells a mesh may have", o.cells[0],
                       o.cells[1], max_per_square, Cell::index_mask));
  }
}

}  // namespace dartcast
