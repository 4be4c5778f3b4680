// A box of cubes, each a hexahedron, or cut into tetrahedra, prisms or pyramids.
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/ids.hpp"
#include "generators/block_size.hpp"
#include "generators/box_window.hpp"
#include "generators/generate_blocked.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

// Corners of a cube: 0 to 7 as in a hexahedron, 8 its middle.
constexpr std::uint8_t cube_middle = 8;
constexpr std::array<std::array<std::uint32_t, 3>, 8> corner_steps = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

// The sides xmin, xmax, ymin, ymax, zmin, zmax, counterclockwise seen from the outside. A side that is cut in two is
// cut from its first to its third corner. These are the lowest and the highest, so that neighbours agree.
constexpr std::array<std::array<std::uint8_t, 4>, 6> cube_sides = {
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
constexpr std::array<const char*, 6> side_names = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
constexpr unsigned z_sides = 0b110000;
constexpr unsigned all_sides = 0b111111;

struct BoxPart {
  CellType type;
  std::vector<std::uint8_t> corners;
};
using Pattern = std::vector<BoxPart>;

const Pattern whole = {{CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}}};
const Pattern two_prisms = {{CellType::prism, {0, 1, 2, 4, 5, 6}}, {CellType::prism, {0, 2, 3, 4, 6, 7}}};
// Kuhn's subdivision: one tetrahedron for each order of the axes, all around the diagonal from 0 to 6.
const Pattern six_tetrahedra = {{CellType::tetrahedron, {0, 1, 2, 6}}, {CellType::tetrahedron, {0, 5, 1, 6}},
                                {CellType::tetrahedron, {0, 2, 3, 6}}, {CellType::tetrahedron, {0, 3, 7, 6}},
                                {CellType::tetrahedron, {0, 4, 5, 6}}, {CellType::tetrahedron, {0, 7, 4, 6}}};

// A cube cut from its middle: a pyramid on each whole side, two tetrahedra on each side in the mask `cut`.
Pattern from_middle(unsigned cut) {
  Pattern pattern;
  for (unsigned s = 0; s < 6; ++s) {
    const auto& q = cube_sides[s];
    if (((cut >> s) & 1U) == 0) {
      pattern.push_back({CellType::pyramid, {q[0], q[3], q[2], q[1], cube_middle}});
    } else {
      pattern.push_back({CellType::tetrahedron, {q[0], q[2], q[1], cube_middle}});
      pattern.push_back({CellType::tetrahedron, {q[0], q[3], q[2], cube_middle}});
    }
  }
  return pattern;
}

void check(const BoxOptions& o) {
  for (const std::uint32_t n : o.cells) {
    if (n == 0) throw InvalidArgument("box: no cells along an axis; give at least 1 along each");
  }
  const Vec3 size = block_size(o);
  if (!is_finite(o.origin) || !is_finite(size) || !is_finite(o.origin + size)) {
    throw InvalidArgument("box: origin and size must be finite numbers");
  }
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) throw InvalidArgument("box: size must be positive along each axis");
  if (!(o.blocked_share >= 0 && o.blocked_share <= 1)) throw InvalidArgument("box: blocked_share must be in [0, 1]");
  if (!(o.jitter >= 0 && o.jitter <= 1)) throw InvalidArgument("box: jitter must be in [0, 1]");
  if (o.type == CellType::polyhedron) {
    throw InvalidArgument("box: no polyhedra; take another type, or the octahedra generator");
  }
  std::uint64_t max_per_cube = cells_per_cube(o.type);
  if (o.mixed) max_per_cube = 12;
  std::uint64_t room = Cell::index_mask / max_per_cube;
  for (const std::uint32_t n : o.cells) room /= n;
  if (room == 0) {
    throw InvalidArgument(
        fmt::format("box: {} x {} x {} cubes of up to {} cells are more than the {} cells a mesh may have", o.cells[0],
                    o.cells[1], o.cells[2], max_per_cube, Cell::index_mask));
  }
}

// Lattice, patterns and marks of the cubes of one box in a window while they are built.
class BoxBuilder {
 public:
  BoxBuilder(const BoxOptions& options, const BoxWindow& window)
      : o_(options), size_(block_size(options)), n_(options.cells), w_(window) {
    cubes_ = window.cubes();
    for (unsigned cut = 0; cut <= all_sides; ++cut) middle_patterns_.push_back(from_middle(cut));
  }

  MeshData build() {
    add_points();
    if (o_.mixed) choose_cuts();
    const std::vector<std::uint8_t> blocked = blocked_cubes();
    const std::size_t per_cube = o_.mixed ? 6 : pattern(0, {0, 0, 0}).size();
    const std::size_t corners = corner_count(o_.mixed ? CellType::pyramid : o_.type);
    mesh_.types.reserve(cubes_ * per_cube);
    mesh_.offsets.reserve(cubes_ * per_cube + 1);
    mesh_.connectivity.reserve(cubes_ * per_cube * corners);
    std::size_t cube = 0;
    for (std::uint32_t k = w_.low[2]; k < w_.high[2]; ++k) {
      for (std::uint32_t j = w_.low[1]; j < w_.high[1]; ++j) {
        for (std::uint32_t i = w_.low[0]; i < w_.high[0]; ++i, ++cube) {
          add_cube(cube, {i, j, k});
          if (!blocked.empty()) mesh_.free.resize(mesh_.types.size(), blocked[cube] == 0 ? 1 : 0);
        }
      }
    }
    for (std::int32_t s = 0; s < 6; ++s) mesh_.patch_names[s + 1] = side_names[static_cast<std::size_t>(s)];
    return std::move(mesh_);
  }

 private:
  using Place = std::array<std::uint32_t, 3>;

  [[nodiscard]] std::uint32_t point(const Place& p) const {
    const std::uint32_t x = w_.high[0] - w_.low[0] + 1;
    const std::uint32_t y = w_.high[1] - w_.low[1] + 1;
    return p[0] - w_.low[0] + x * (p[1] - w_.low[1] + y * (p[2] - w_.low[2]));
  }

  [[nodiscard]] bool outermost(const Place& p) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] == 0 || p[a] + 1 == n_[a]) return true;
    }
    return false;
  }

  static double coordinate(double origin, double size, std::uint32_t i, std::uint32_t n) {
    return origin + (i == n ? size : size * i / n);
  }

  // The lattice's inner points have three random numbers each, in their order.
  [[nodiscard]] Vec3 lattice_point(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    const Vec3 p = {coordinate(o_.origin.x, size_.x, i, n_[0]), coordinate(o_.origin.y, size_.y, j, n_[1]),
                    coordinate(o_.origin.z, size_.z, k, n_[2])};
    const bool inner = i > 0 && j > 0 && k > 0 && i < n_[0] && j < n_[1] && k < n_[2];
    if (!inner || o_.jitter == 0) return p;
    Random random(o_.seed, 1);
    random.skip(3 * (i - 1 + std::uint64_t{n_[0] - 1} * (j - 1 + std::uint64_t{n_[1] - 1} * (k - 1))));
    const auto shift = [&](double edge) { return o_.jitter * (random.uniform() - 0.5) * edge; };
    const double dx = shift(size_.x / n_[0]);
    const double dy = shift(size_.y / n_[1]);
    const double dz = shift(size_.z / n_[2]);
    return {p.x + dx, p.y + dy, p.z + dz};
  }

  void add_points() {
    mesh_.points.reserve(point(w_.high) + std::size_t{1});
    for (std::uint32_t k = w_.low[2]; k <= w_.high[2]; ++k) {
      for (std::uint32_t j = w_.low[1]; j <= w_.high[1]; ++j) {
        for (std::uint32_t i = w_.low[0]; i <= w_.high[0]; ++i) mesh_.points.push_back(lattice_point(i, j, k));
      }
    }
  }

  // One mark per cube; empty if nothing is to be blocked.
  [[nodiscard]] std::vector<std::uint8_t> blocked_cubes() const {
    std::vector<std::uint8_t> blocked;
    if (!o_.blocked_layer && o_.blocked_share == 0.0) return blocked;
    blocked.reserve(cubes_);
    for (std::uint32_t k = w_.low[2]; k < w_.high[2]; ++k) {
      for (std::uint32_t j = w_.low[1]; j < w_.high[1]; ++j) {
        for (std::uint32_t i = w_.low[0]; i < w_.high[0]; ++i)
          blocked.push_back(o_.blocked_layer && outermost({i, j, k}) ? 1 : 0);
      }
    }
    block_share(blocked, o_.blocked_share, o_.seed);
    return blocked;
  }

  // Mixed boxes: a third of the cubes each wishes to be whole, prisms or tetrahedra. The wish fixes which of its sides
  // are cut in two.
  void choose_cuts() {
    Random random(o_.seed, 3);
    constexpr std::array<std::uint8_t, 3> wishes = {0, z_sides, all_sides};
    wishes_.resize(cubes_);
    for (auto& wish : wishes_) wish = wishes[random.below(3)];
  }

  // The sides of a cube that it or its neighbours wish to be cut.
  [[nodiscard]] unsigned cut_sides(std::size_t cube, const Place& p) const {
    unsigned cut = wishes_[cube];
    std::size_t step = 1;
    for (unsigned a = 0; a < 3; ++a) {
      if (p[a] > 0) cut |= (wishes_[cube - step] >> 1U) & (1U << (2 * a));
      if (p[a] + 1 < n_[a]) cut |= (wishes_[cube + step] & (1U << (2 * a))) << 1U;
      step *= n_[a];
    }
    return cut;
  }

  [[nodiscard]] const Pattern& pattern(std::size_t cube, const Place& p) const {
    if (o_.mixed) {
      const unsigned cut = cut_sides(cube, p);
      if (cut != wishes_[cube]) return middle_patterns_[cut];
      return cut == 0 ? whole : (cut == z_sides ? two_prisms : six_tetrahedra);
    }
    if (o_.type == CellType::tetrahedron) return six_tetrahedra;
    if (o_.type == CellType::prism) return two_prisms;
    return o_.type == CellType::pyramid ? middle_patterns_[0] : whole;
  }

  void add_cube(std::size_t cube, const Place& p) {
    std::array<std::uint32_t, 9> points{};
    for (std::size_t c = 0; c < 8; ++c) {
      points[c] = point({p[0] + corner_steps[c][0], p[1] + corner_steps[c][1], p[2] + corner_steps[c][2]});
    }
    const Pattern& pieces = pattern(cube, p);
    if (pieces[0].corners.back() == cube_middle) {
      Vec3 sum;
      for (std::size_t c = 0; c < 8; ++c) sum += mesh_.points[points[c]];
      points[cube_middle] = static_cast<std::uint32_t>(mesh_.points.size());
      mesh_.points.push_back(sum * 0.125);
    }
    std::array<std::uint32_t, 8> corners{};
    for (const BoxPart& piece : pieces) {
      for (std::size_t c = 0; c < piece.corners.size(); ++c) corners[c] = points[piece.corners[c]];
      mesh_.add_cell(piece.type, {corners.data(), piece.corners.size()});
    }
    if (outermost(p)) add_patches(pieces, points, p);
  }

  void add_patches(const Pattern& pieces, const std::array<std::uint32_t, 9>& points, const Place& p) {
    for (std::size_t s = 0; s < 6; ++s) {
      const std::size_t axis = s / 2;
      const std::uint32_t step = s % 2;
      if (step == 0 ? p[axis] != 0 : p[axis] + 1 != n_[axis]) continue;
      const auto on_side = [&](std::uint8_t c) { return c != cube_middle && corner_steps[c][axis] == step; };
      for (const BoxPart& piece : pieces) {
        for (const auto& numbers : standard_faces(piece.type)) {
          std::vector<std::uint32_t> face;
          for (const std::uint8_t f : numbers) {
            if (on_side(piece.corners[f])) face.push_back(points[piece.corners[f]]);
          }
          if (face.size() == numbers.size()) mesh_.add_patch_face(face, static_cast<std::int32_t>(s) + 1);
        }
      }
    }
  }

  const BoxOptions& o_;
  const Vec3 size_;
  const std::array<std::uint32_t, 3> n_;
  const BoxWindow w_;
  std::size_t cubes_ = 0;
  std::vector<std::uint8_t> wishes_;
  std::vector<Pattern> middle_patterns_;
  MeshData mesh_;
};

}  // namespace

MeshData generate_box(const BoxOptions& options) { return generate_box_window(options, {{0, 0, 0}, options.cells}); }

MeshData generate_box_window(const BoxOptions& options, const BoxWindow& window) {
  check(options);
  return BoxBuilder(options, window).build();
}

std::uint32_t cells_per_cube(CellType type) {
  return type == CellType::hexahedron ? 1 : (type == CellType::prism ? 2 : 6);
}

BoxOptions bar_options() {
  BoxOptions options;
  options.cells = {5, 5, 28};
  options.blocked_layer = true;
  return options;
}

MeshData generate_bar() { return generate_box(bar_options()); }

}  // namespace dartcast
