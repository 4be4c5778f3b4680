// Boundary faces that lie against each other without being one face.
#include "mesh/conformity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/vec3_parts.hpp"
#include "dartcast/predicates.hpp"
#include "mesh/box_tree.hpp"
#include "mesh/plane.hpp"

namespace dartcast {
namespace {

constexpr double flatness = 1e-9;  // off the plane because of rounding, relative to the size of the face
constexpr std::size_t pairs_a_face = 200;

using FaceTriangle = std::array<std::uint32_t, 3>;

/// A triangle of a face's fan, with its box and normal, which many tests use.
struct FacePiece {
  FaceTriangle corners;
  Vec3 normal;
  double size;
};

/// Normal of largest component 1, so that no product of coordinates overflows later.
Vec3 normal_of(const MeshData& mesh, const FaceTriangle& t) {
  const auto& p = mesh.points;
  Vec3 u = p[t[1]] - p[t[0]];
  Vec3 v = p[t[2]] - p[t[0]];
  if (largest_component(u) > 0.0) u = u * (1.0 / largest_component(u));
  if (largest_component(v) > 0.0) v = v * (1.0 / largest_component(v));
  const Vec3 n = cross(u, v);
  return largest_component(n) > 0.0 ? n * (1.0 / largest_component(n)) : n;
}

int main_axis(const Vec3& n) {
  const Vec3 a = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  if (a.x >= a.y && a.x >= a.z) return 0;
  return a.y >= a.z ? 1 : 2;
}

/// Whether all of t lies on or to the right of an edge of s, s being counterclockwise (turn positive) in the plane.
bool separates(const MeshData& mesh, const FaceTriangle& s, const FaceTriangle& t, int axis, Sign turn) {
  const auto at = [&](std::uint32_t v) { return drop(mesh.points[v], axis); };
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = s[k];
    const std::uint32_t b = s[(k + 1) % 3];
    bool outside = true;
    for (const std::uint32_t v : t) {
      if (v == a || v == b || !outside) continue;
      outside = orient2d(at(a), at(b), at(v)) != turn;
    }
    if (outside) return true;
  }
  return false;
}

/// Whether the insides of two triangles, seen along `axis`, have a point in common. Two convex polygons have none
/// exactly if an edge of one has the other on its far side.
bool areas_overlap(const MeshData& mesh, const FaceTriangle& s, const FaceTriangle& t, int axis) {
  const auto turn = [&](const FaceTriangle& x) {
    return orient2d(drop(mesh.points[x[0]], axis), drop(mesh.points[x[1]], axis), drop(mesh.points[x[2]], axis));
  };
  const Sign turn_s = turn(s);
  const Sign turn_t = turn(t);
  if (turn_s == Sign::zero || turn_t == Sign::zero) return false;
  return !separates(mesh, s, t, axis, turn_s) && !separates(mesh, t, s, axis, turn_t);
}

double size_of(const MeshData& mesh, const FaceTriangle& t) {
  const auto& p = mesh.points;
  return std::max(largest_component(p[t[1]] - p[t[0]]), largest_component(p[t[2]] - p[t[0]]));
}

/// Whether the two ranges of coordinates have more than an end in common.
bool ranges_overlap(double a, double b, double c, double x, double y, double z) {
  return std::min({a, b, c}) < std::max({x, y, z}) && std::min({x, y, z}) < std::max({a, b, c});
}

bool boxes_overlap(const MeshData& mesh, const FaceTriangle& s, const FaceTriangle& t, int axis) {
  const auto at = [&](std::uint32_t v) { return drop(mesh.points[v], axis); };
  const Vec2 a = at(s[0]), b = at(s[1]), c = at(s[2]), x = at(t[0]), y = at(t[1]), z = at(t[2]);
  return ranges_overlap(a.x, b.x, c.x, x.x, y.x, z.x) && ranges_overlap(a.y, b.y, c.y, x.y, y.y, z.y);
}

bool lie_against(const MeshData& mesh, const FacePiece& f, const FacePiece& g) {
  const auto& p = mesh.points;
  const FaceTriangle& s = f.corners;
  const FaceTriangle& t = g.corners;
  const double thickness = 3.0 * flatness * std::max(f.size, g.size);
  for (const std::uint32_t v : t) {
    if (std::abs(dot(f.normal, p[v] - p[s[0]])) > thickness) return false;
  }
  const int axis = main_axis(f.normal);
  if (!boxes_overlap(mesh, s, t, axis)) return false;
  const bool facing = dot(f.normal, g.normal) < 0.0;
  const auto on_plane = [&](std::uint32_t v) { return orient3d(p[s[0]], p[s[1]], p[s[2]], p[v]) == Sign::zero; };
  if (!facing && !(on_plane(t[0]) && on_plane(t[1]) && on_plane(t[2]))) return false;
  return areas_overlap(mesh, s, t, axis);
}

/// Triangle k of a face's fan from its lowest-numbered corner.
FaceTriangle fan_triangle(std::span<const std::uint32_t> face, std::size_t k) {
  const auto low = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  return {face[low], face[(low + k + 1) % face.size()], face[(low + k + 2) % face.size()]};
}

/// The fans of all faces, one after another: face f of n corners has its n - 2 pieces from offsets[f] - 2 f on.
std::vector<FacePiece> make_pieces(const MeshData& mesh, const BoundaryFaces& boundary) {
  std::vector<FacePiece> pieces;
  pieces.reserve(boundary.corners.size() - 2 * boundary.size());
  for (std::size_t f = 0; f < boundary.size(); ++f) {
    for (std::size_t k = 0; k + 2 < boundary.face(f).size(); ++k) {
      const FaceTriangle t = fan_triangle(boundary.face(f), k);
      pieces.push_back({t, normal_of(mesh, t), size_of(mesh, t)});
    }
  }
  return pieces;
}

bool pieces_lie_against(const MeshData& mesh, std::span<const FacePiece> f, std::span<const FacePiece> g) {
  for (const FacePiece& s : f) {
    for (const FacePiece& t : g) {
      if (lie_against(mesh, s, t)) return true;
    }
  }
  return false;
}

Box box_of(const MeshData& mesh, std::span<const std::uint32_t> face) {
  Box box = {mesh.points[face[0]], mesh.points[face[0]]};
  for (const std::uint32_t v : face) box = join(box, {mesh.points[v], mesh.points[v]});
  const double margin = flatness * largest_component(box.high - box.low);
  const Vec3 m = {margin, margin, margin};
  return {box.low - m, box.high + m};
}

/// Marks faces that overlap in space.
void mark_overlaps(const MeshData& mesh, const BoundaryFaces& boundary, Conformity& out, std::vector<bool>& marked) {
  std::vector<Box> boxes(boundary.size());
  for (std::size_t f = 0; f < boxes.size(); ++f) boxes[f] = box_of(mesh, boundary.face(f));
  const BoxTree tree(boxes);
  const std::vector<FacePiece> pieces = make_pieces(mesh, boundary);
  const auto pieces_of = [&](std::size_t f) {
    return std::span(pieces).subspan(boundary.offsets[f] - 2 * f, boundary.face(f).size() - 2);
  };
  std::size_t budget = pairs_a_face * boundary.size() + 1000;
  for (std::uint32_t f = 0; f < boundary.size() && out.complete; ++f) {
    const auto own = pieces_of(f);
    tree.query(boxes[f], [&](std::uint32_t g) {
      if (g <= f || boundary.cells[g] == boundary.cells[f]) return true;
      const std::size_t cost = own.size() * pieces_of(g).size();
      if (budget < cost) return out.complete = false;
      budget -= cost;
      if (marked[f] && marked[g]) return true;
      if (pieces_lie_against(mesh, own, pieces_of(g))) marked[f] = marked[g] = true;
      return true;
    });
  }
}

/// Marks triangles that have their corners in a row in a larger face, and that face: warped faces are not coplanar.
void mark_shared_corners(const BoundaryFaces& boundary, std::vector<bool>& marked) {
  struct Row {
    FaceTriangle corners;
    std::uint32_t face;
  };
  std::vector<Row> rows;
  for (std::uint32_t f = 0; f < boundary.size(); ++f) {
    const auto face = boundary.face(f);
    for (std::size_t k = 0; k < (face.size() == 3 ? 1 : face.size()); ++k) {
      Row row = {{face[k], face[(k + 1) % face.size()], face[(k + 2) % face.size()]}, f};
      std::sort(row.corners.begin(), row.corners.end());
      rows.push_back(row);
    }
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.face < b.face;
  });
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].corners != rows[i - 1].corners || rows[i].face == rows[i - 1].face) continue;
    if (boundary.cells[rows[i].face] == boundary.cells[rows[i - 1].face]) continue;
    marked[rows[i].face] = marked[rows[i - 1].face] = true;
  }
}

}  // namespace

Conformity find_unmatched_faces(const MeshData& mesh, const BoundaryFaces& boundary) {
  Conformity out;
  std::vector<bool> marked(boundary.size(), false);
  mark_shared_corners(boundary, marked);
  mark_overlaps(mesh, boundary, out, marked);
  for (std::uint32_t f = 0; f < boundary.size(); ++f) {
    if (marked[f]) out.faces.push_back(f);
  }
  return out;
}

}  // namespace dartcast
