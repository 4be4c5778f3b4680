// Draws boxes and kinds of cubes, and lists the cells. A face between two cubes is one square, or two triangles where a
// cube on either side needs that.
#include "support/patchwork.hpp"

#include <algorithm>
#include <vector>

namespace dartcast::test {

namespace {

using Place = std::array<std::uint32_t, 3>;
using Numbers = std::vector<std::uint32_t>;
enum class CubeKind : std::uint8_t { hexahedron, polyhedron, pyramids, tetrahedra, prisms };

struct Cube {
  CubeKind kind = CubeKind::hexahedron;
  unsigned axis = 0;         // of prisms
  std::uint32_t box = none;  // that it is part of
  static constexpr std::uint32_t none = 0xffffffffU;
};

class Patchwork {
 public:
  Patchwork(Place n, Random& random) : n_(n), random_(random), cubes_(std::size_t{n[0]} * n[1] * n[2]) {
    for (auto& of_axis : diagonals_) of_axis.assign(std::size_t{n[0] + 1} * (n[1] + 1) * (n[2] + 1), whole);
  }

  MeshData make() {
    for (std::uint32_t k = 0; k <= n_[2]; ++k)
      for (std::uint32_t j = 0; j <= n_[1]; ++j)
        for (std::uint32_t i = 0; i <= n_[0]; ++i) mesh_.points.push_back({double(i), double(j), double(k)});
    for_each(n_, [&](const Place& at) { draw_box(at); });
    for_each(n_, [&](const Place& at) { draw_kind(at); });
    for_each(n_, [&](const Place& at) { add_cube(at); });
    for (const Numbers& box : boxes_) add_polyhedron(box);
    return std::move(mesh_);
  }

 private:
  static constexpr std::int8_t whole = -1;

  template <class Visit>
  static void for_each(const Place& n, Visit&& visit) {
    for (std::uint32_t k = 0; k < n[2]; ++k)
      for (std::uint32_t j = 0; j < n[1]; ++j)
        for (std::uint32_t i = 0; i < n[0]; ++i) visit(Place{i, j, k});
  }
  [[nodiscard]] std::uint32_t point(const Place& at, const Place& shift) const {
    return at[0] + shift[0] + (n_[0] + 1) * (at[1] + shift[1] + (n_[1] + 1) * (at[2] + shift[2]));
  }
  Cube& cube(const Place& at) { return cubes_[at[0] + std::size_t{n_[0]} * (at[1] + std::size_t{n_[1]} * at[2])]; }
  // How the face below or above a cube along an axis is divided.
  std::int8_t& diagonal(const Place& at, unsigned axis, unsigned above) {
    Place shift{};
    shift[axis] = above;
    return diagonals_[axis][point(at, shift)];
  }

  void draw_box(const Place& at) {
    if (random_.below(40) != 0) return;
    const Place size = {1 + random_.below(3), 1 + random_.below(3), 1 + random_.below(3)};
    const auto place = [&](const Place& shift) { return Place{at[0] + shift[0], at[1] + shift[1], at[2] + shift[2]}; };
    bool fits = true;
    for_each(size, [&](const Place& s) {
      const Place p = place(s);
      fits = fits && p[0] < n_[0] && p[1] < n_[1] && p[2] < n_[2] && cube(p).box == Cube::none;
    });
    if (!fits) return;
    for_each(size, [&](const Place& s) { cube(place(s)).box = static_cast<std::uint32_t>(boxes_.size()); });
    boxes_.push_back({0});
  }

  void draw_kind(const Place& at) {
    Cube& c = cube(at);
    if (c.box != Cube::none) return;
    constexpr std::array<CubeKind, 8> kinds = {CubeKind::hexahedron, CubeKind::hexahedron, CubeKind::hexahedron,
                                               CubeKind::hexahedron, CubeKind::polyhedron, CubeKind::pyramids,
                                               CubeKind::tetrahedra, CubeKind::prisms};
    c.kind = kinds[random_.below(8)];
    c.axis = random_.below(3);
    if (c.kind == CubeKind::tetrahedra) {
      for (unsigned axis = 0; axis < 3; ++axis)
        for (unsigned above = 0; above < 2; ++above)
          divide(at, axis, above, static_cast<std::int8_t>(random_.below(2)));
    } else if (c.kind == CubeKind::prisms) {
      const std::int8_t below = diagonal(at, c.axis, 0);
      const std::int8_t above = diagonal(at, c.axis, 1);
      if (below != whole && above != whole && below != above) {
        c.kind = CubeKind::pyramids;
      } else {
        const std::int8_t both = below != whole ? below : above != whole ? above : std::int8_t{0};
        divide(at, c.axis, 0, both);
        divide(at, c.axis, 1, both);
      }
    }
  }
  void divide(const Place& at, unsigned axis, unsigned above, std::int8_t by) {
    std::int8_t& d = diagonal(at, axis, above);
    if (d == whole) d = by;
  }

  // The polygons of a cube's face, counterclockwise as seen from outside.
  std::vector<Numbers> polygons(const Place& at, unsigned axis, unsigned above) {
    const auto corner = [&](std::uint32_t u, std::uint32_t v) {
      Place shift{};
      shift[axis] = above;
      shift[(axis + 1) % 3] = u;
      shift[(axis + 2) % 3] = v;
      return point(at, shift);
    };
    const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
    std::vector<Numbers> found;
    switch (diagonal(at, axis, above)) {
      case whole: found = {{a, b, c, d}}; break;
      case 0: found = {{a, b, c}, {a, c, d}}; break;
      default: found = {{a, b, d}, {b, c, d}}; break;
    }
    if (above == 0)
      for (Numbers& polygon : found) std::reverse(polygon.begin(), polygon.end());
    return found;
  }

  void add_cube(const Place& at) {
    const Cube& c = cube(at);
    Numbers faces = {0};  // as in a polyhedron
    bool squares = true;
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned above = 0; above < 2; ++above) {
        if (c.box != Cube::none && is_inside(at, axis, above)) continue;
        for (const Numbers& polygon : polygons(at, axis, above)) {
          Numbers& all = c.box != Cube::none ? boxes_[c.box] : faces;
          ++all[0];
          all.push_back(static_cast<std::uint32_t>(polygon.size()));
          all.insert(all.end(), polygon.begin(), polygon.end());
          squares = squares && polygon.size() == 4;
        }
      }
    }
    if (c.box != Cube::none) return;
    if (c.kind == CubeKind::prisms && squares_beside(at, c.axis)) return add_prisms(at, c.axis);
    if (c.kind == CubeKind::hexahedron && squares) return add_hexahedron(at);
    if (c.kind == CubeKind::hexahedron || c.kind == CubeKind::polyhedron) return add_polyhedron(faces);
    add_cones(at, faces);
  }

  bool is_inside(const Place& at, unsigned axis, unsigned above) {
    if (above == 0 && at[axis] == 0) return false;
    Place beyond = at;
    beyond[axis] += above == 0 ? ~0U : 1U;
    return beyond[axis] < n_[axis] && cube(beyond).box == cube(at).box;
  }
  bool squares_beside(const Place& at, unsigned axis) {
    for (unsigned other = 0; other < 3; ++other)
      for (unsigned above = 0; above < 2; ++above)
        if (other != axis && diagonal(at, other, above) != whole) return false;
    return true;
  }

  void add_hexahedron(const Place& at) {
    const auto p = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return point(at, {i, j, k}); };
    mesh_.add_cell(CellType::hexahedron, Numbers{p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0), p(0, 0, 1), p(1, 0, 1),
                                                 p(1, 1, 1), p(0, 1, 1)});
  }
  void add_prisms(const Place& at, unsigned axis) {
    const std::vector<Numbers> above = polygons(at, axis, 1);
    const std::uint32_t below = point(at, {0, 0, 0}) - point(at, {axis == 0, axis == 1, axis == 2});
    for (const Numbers& t : above)
      mesh_.add_cell(CellType::prism, Numbers{t[0] + below, t[1] + below, t[2] + below, t[0], t[1], t[2]});
  }
  void add_polyhedron(const Numbers& faces) { mesh_.add_cell(CellType::polyhedron, faces); }
  // A pyramid or a tetrahedron on each face, with the middle as the apex.
  void add_cones(const Place& at, const Numbers& faces) {
    const auto apex = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back({at[0] + 0.5, at[1] + 0.5, at[2] + 0.5});
    for (std::size_t i = 1; i < faces.size(); i += faces[i] + 1) {
      Numbers cone(faces.rend() - static_cast<std::ptrdiff_t>(i + 1 + faces[i]),
                   faces.rend() - static_cast<std::ptrdiff_t>(i + 1));
      cone.push_back(apex);
      mesh_.add_cell(cone.size() == 5 ? CellType::pyramid : CellType::tetrahedron, cone);
    }
  }

  Place n_;
  Random& random_;
  std::vector<Cube> cubes_;
  std::array<std::vector<std::int8_t>, 3> diagonals_;  // of the faces across each axis, by their lowest points
  std::vector<Numbers> boxes_;                         // faces, as in polyhedra
  MeshData mesh_;
};

}  // namespace

MeshData patchwork(std::array<std::uint32_t, 3> cubes, Random& random) { return Patchwork(cubes, random).make(); }

}  // namespace dartcast::test
