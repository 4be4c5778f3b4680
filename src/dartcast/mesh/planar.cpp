#include "dartcast/mesh/planar.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include "dartcast/mesh/box_tree.hpp"
#include "dartcast/mesh/plane.hpp"

namespace dartcast {
namespace {

/// The axis along which all points are the same, z first; -1: none.
int flat_axis(const MeshData& mesh) {
  const Vec3 first = mesh.points[0];
  bool same[3] = {true, true, true};
  for (const Vec3& p : mesh.points) {
    same[0] = same[0] && p.x == first.x;
    same[1] = same[1] && p.y == first.y;
    same[2] = same[2] && p.z == first.z;
  }
  return same[2] ? 2 : (same[1] ? 1 : (same[0] ? 0 : -1));
}

std::span<std::uint32_t> face_of(MeshData& mesh, std::size_t f) {
  return {mesh.patch_faces.data() + mesh.patch_offsets[f], mesh.patch_offsets[f + 1] - mesh.patch_offsets[f]};
}

void orient_faces(MeshData& mesh, int axis, MeshReport& report) {
  Finding turned{"orientation", 0, {}, "faces ran clockwise and have been reversed"};
  Finding flat{"flat", 0, {}, "faces without area; remove them from the mesh"};
  Finding bent{"inverted", 0, {}, "faces that are not convex or cross themselves; remesh them"};
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto face = face_of(mesh, f);
    std::size_t positive = 0;
    std::size_t negative = 0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto at = [&](std::size_t i) { return drop(mesh.points[face[i % face.size()]], axis); };
      const Sign s = orient2d(at(k), at(k + 1), at(k + 2));
      positive += s == Sign::positive ? 1 : 0;
      negative += s == Sign::negative ? 1 : 0;
    }
    if (positive > 0 && negative > 0) bent.add(f);
    if (positive == 0 && negative == 0) flat.add(f);
    if (positive > 0 || negative == 0) continue;
    std::reverse(face.begin(), face.end());
    turned.add(f);
  }
  add_finding(report.repairs, turned);
  add_finding(report.defects, flat);
  add_finding(report.defects, bent);
}

/// A side of a face, from its smaller end.
struct Side {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t face;
};

/// The sides that one face alone uses; those used by three or more are a defect.
std::vector<Side> boundary_sides(MeshData& mesh, MeshReport& report) {
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto face = face_of(mesh, f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto [low, high] = std::minmax(face[k], face[(k + 1) % face.size()]);
      sides.push_back({low, high, f});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  Finding crowded{"face_shared", 0, {}, "sides used by three or more faces; the first such face is named"};
  std::vector<Side> boundary;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    if (j - i == 1) boundary.push_back(sides[i]);
    if (j - i > 2) crowded.add(sides[i].face);
  }
  add_finding(report.defects, crowded);
  return boundary;
}

/// Whether point v lies on the inside of side s, exactly.
bool hangs_on(const MeshData& mesh, const Side& s, std::uint32_t v, int axis) {
  if (v == s.low || v == s.high) return false;
  const Vec2 a = drop(mesh.points[s.low], axis);
  const Vec2 b = drop(mesh.points[s.high], axis);
  const Vec2 p = drop(mesh.points[v], axis);
  if (orient2d(a, b, p) != Sign::zero) return false;
  const auto between = [](double x, double y, double t) { return (x < t && t < y) || (y < t && t < x); };
  return between(a.x, b.x, p.x) || between(a.y, b.y, p.y);
}

void find_hanging_points(const MeshData& mesh, const std::vector<Side>& boundary, int axis, MeshReport& report) {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> ends;
  for (const Side& s : boundary) {
    const Box low = {mesh.points[s.low], mesh.points[s.low]};
    boxes.push_back(join(low, {mesh.points[s.high], mesh.points[s.high]}));
    ends.push_back(s.low);
    ends.push_back(s.high);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const BoxTree tree(std::move(boxes));
  Finding hanging{"non_conforming", 0, {}, "points that lie on the side of a face without being its corner"};
  std::size_t budget = 200 * boundary.size() + 1000;
  for (const std::uint32_t v : ends) {
    tree.query({mesh.points[v], mesh.points[v]}, [&](std::uint32_t s) {
      if (budget == 0) return false;
      --budget;
      if (!hangs_on(mesh, boundary[s], v, axis)) return true;
      hanging.add(v);
      return false;
    });
  }
  add_finding(report.warnings, hanging);
  if (budget == 0) {
    report.warnings.push_back({"unfinished", 1, {0}, "too many sides overlap for all hanging points to be found"});
  }
}

}  // namespace

void inspect_planar(MeshData& mesh, MeshReport& report) {
  report.dimension = 2;
  const int axis = flat_axis(mesh);
  if (axis < 0) {
    report.defects.push_back({"no_volume",
                              mesh.patch_tags.size(),
                              {0},
                              "a surface in space without volume cells; mesh the volume inside it first"});
    return;
  }
  orient_faces(mesh, axis, report);
  find_hanging_points(mesh, boundary_sides(mesh, report), axis, report);
}

}  // namespace dartcast
