// Lists the rows of a hexahedron: its corners as each face and turn sees them, then the triangles that may be left by.
#include "topology/cell_rows.hpp"

#include <algorithm>

namespace dartcast::detail {

namespace {

using FaceCorners = std::array<std::uint8_t, 4>;

bool is_hexahedron(const Shape& shape) {
  if (shape.dimension() != 3 || shape.point_count() != 8 || shape.face_count() != 6) return false;
  for (std::uint16_t face = 0; face < 6; ++face) {
    if (shape.degree(face) != 4 || shape.triangle_count(face) != 2) return false;
  }
  return true;
}

std::uint8_t local(const Shape& shape, std::uint16_t dart) { return static_cast<std::uint8_t>(shape.origin(dart)); }

// The darts of a face from its first corner on turn around the outward normal. Entered by it, a walk sees them turn the
// other way: a_i is the origin of this dart.
std::uint16_t dart_at(const Shape& shape, std::uint16_t face, unsigned i, unsigned turn) {
  return static_cast<std::uint16_t>(shape.first_dart(face) + (turn + 4 - i) % 4);
}

// The way out by the triangle of a face that holds corners u and v. `corners`: of the face, in the order of the next
// row.
CellWay way_out(const Shape& shape, std::uint16_t face, const FaceCorners& corners, std::uint8_t u, std::uint8_t v) {
  CellWay way;
  way.face = static_cast<std::uint8_t>(face);
  const auto first_triangle = shape.triangle(face, 0);
  const auto holds = [&](std::uint8_t x) {
    return first_triangle[0] == x || first_triangle[1] == x || first_triangle[2] == x;
  };
  way.triangle = holds(u) && holds(v) ? 0 : 1;
  const auto first = static_cast<std::uint8_t>(shape.corners(way.face)[0]);
  const auto turn = static_cast<unsigned>(std::find(corners.begin(), corners.end(), first) - corners.begin());
  way.beyond = static_cast<std::uint8_t>(turn + 32U * shape.triangle_from_other_side(way.face, way.triangle));
  way.word = static_cast<std::uint8_t>(2U + shape.point_count() + face);
  way.face_shift = static_cast<std::uint8_t>(3U * way.face);
  way.wall_shift = static_cast<std::uint8_t>(18U + way.face);
  return way;
}

// Whether the face's diagonal ends at corner u: its fan begins at u or at the corner opposite to it.
bool ends_diagonal(const Shape& shape, std::uint8_t face, std::uint8_t u) {
  const auto corners = shape.corners(face);
  return corners[0] == u || corners[2] == u;
}

CellRow row_of(const Shape& shape, std::uint16_t face, unsigned turn) {
  CellRow row;
  std::array<std::uint16_t, 4> lateral_face{};
  std::uint16_t far_face = 0;
  for (unsigned i = 0; i < 4; ++i) {
    const std::uint16_t dart = dart_at(shape, face, i, turn);
    const std::uint16_t opposite = shape.phi1(shape.phi1(shape.phi2(dart)));  // edge, in the same lateral face
    row.near[i] = local(shape, dart);
    row.far[i] = local(shape, opposite);
    lateral_face[(i + 3) % 4] = shape.face_of(opposite);  // its dart leads from a_i to a_(i-1)
    far_face = shape.face_of(shape.phi2(opposite));
  }
  const FaceCorners& a = row.near;
  const FaceCorners& b = row.far;
  for (unsigned i = 0; i < 4; ++i) {
    const unsigned j = (i + 1) % 4;
    const FaceCorners lateral = {a[i], a[j], b[j], b[i]};
    row.ways[2 * i] = way_out(shape, lateral_face[i], lateral, a[i], a[j]);
    row.ways[2 * i + 1] = way_out(shape, lateral_face[i], lateral, b[i], b[j]);
    row.diagonals |= (ends_diagonal(shape, row.ways[2 * i].face, a[j]) ? 1U : 0U) << i;
  }
  row.ways[8] = way_out(shape, far_face, b, b[1], b[2]);
  row.ways[9] = way_out(shape, far_face, b, b[3], b[0]);
  row.diagonals |= (ends_diagonal(shape, row.ways[8].face, b[1]) ? 1U : 0U) << 4U;
  return row;
}

}  // namespace

CellRows::CellRows(const Shape& shape) {
  if (!is_hexahedron(shape)) return;
  for (std::uint16_t face = 0; face < 6; ++face) {
    for (unsigned turn = 0; turn < 4; ++turn) rows_.push_back(row_of(shape, face, turn));
  }
}

}  // namespace dartcast::detail
