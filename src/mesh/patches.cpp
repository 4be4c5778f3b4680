// Selects patches by name, or divides walls into patches where they are sharp.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "base/elementary.hpp"
#include "base/vec3_parts.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"
#include "mesh/baffles.hpp"
#include "mesh/faces.hpp"
#include "mesh/periodic_pairs.hpp"

namespace dartcast {
namespace {

std::string patch_name(const MeshData& mesh, std::int32_t tag) {
  const auto name = mesh.patch_names.find(tag);
  return name == mesh.patch_names.end() ? std::to_string(tag) : name->second;
}

/// Takes the patch faces out of the mesh.
MeshData take_patch_faces(MeshData& mesh) {
  MeshData out;
  std::swap(out.patch_faces, mesh.patch_faces);
  std::swap(out.patch_offsets, mesh.patch_offsets);
  std::swap(out.patch_tags, mesh.patch_tags);
  std::swap(out.patch_source, mesh.patch_source);
  return out;
}

/// The free cells alone, whose boundary is the walls. `source`: their numbers in the file.
MeshData free_cells(const MeshData& mesh) {
  MeshData out;
  out.points = mesh.points;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (!mesh.free.empty() && mesh.free[c] == 0) continue;
    out.add_cell(mesh.types[c], mesh.cell(c));
    out.source.push_back(mesh.source.empty() ? static_cast<std::uint32_t>(c) : mesh.source[c]);
  }
  out.baffle_tags = mesh.baffle_tags;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    if (is_baffle(mesh, mesh.patch_tags[f])) out.add_patch_face(mesh.patch_face(f), mesh.patch_tags[f]);
  }
  return out;
}

/// Twice the projected area of a face, or the normal of an edge in the plane, over the square of the face's size. No
/// product of coordinates overflows or vanishes. Outwards.
Vec3 wall_normal(const MeshData& mesh, std::span<const std::uint32_t> face) {
  const Vec3& first = mesh.points[face[0]];
  double size = 0.0;
  for (const std::uint32_t v : face) size = std::max(size, largest_component(mesh.points[v] - first));
  if (!(size > 0.0)) return {};
  const auto at = [&](std::size_t k) { return (mesh.points[face[k]] - first) * (1.0 / size); };
  if (face.size() == 2) return {at(1).y, -at(1).x, 0.0};
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < face.size(); ++k) sum += cross(at(k), at(k + 1));
  return sum;
}

/// A place where walls meet: an edge, or in the plane a point (low = high).
struct WallSide {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t wall;
};

std::vector<WallSide> sides_of(const BoundaryFaces& walls) {
  std::vector<WallSide> sides;
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    const auto face = walls.face(w);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t other = face.size() == 2 ? face[k] : face[(k + 1) % face.size()];
      sides.push_back({std::min(face[k], other), std::max(face[k], other), w});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const WallSide& a, const WallSide& b) {
    return std::tie(a.low, a.high, a.wall) < std::tie(b.low, b.high, b.wall);
  });
  return sides;
}

/// Walls that are connected without a sharp edge in between.
class SmoothParts {
 public:
  SmoothParts(const MeshData& mesh, const BoundaryFaces& walls, double degrees) : parent_(walls.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::vector<Vec3> normals;
    for (std::size_t w = 0; w < walls.size(); ++w) normals.push_back(wall_normal(mesh, walls.face(w)));
    const double limit = degrees * (std::numbers::pi / 180.0);
    const std::vector<WallSide> sides = sides_of(walls);
    for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
      for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
      if (j - i != 2) continue;
      const Vec3& n = normals[sides[i].wall];
      const Vec3& m = normals[sides[i + 1].wall];
      if (polar_angle(norm(cross(n, m)), dot(n, m)) <= limit) parent_[root(sides[i].wall)] = root(sides[i + 1].wall);
    }
  }

  [[nodiscard]] std::uint32_t root(std::uint32_t w) {
    while (parent_[w] != w) w = parent_[w] = parent_[parent_[w]];
    return w;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// The tags of the named patches.
std::set<std::int32_t> tags_of_patches(const MeshData& mesh, std::span<const std::string> names) {
  std::map<std::string, std::set<std::int32_t>> known;
  for (const auto& [tag, name] : mesh.patch_names) known[name].insert(tag);
  for (const std::int32_t tag : mesh.patch_tags) known[patch_name(mesh, tag)].insert(tag);
  std::set<std::int32_t> tags;
  for (const std::string& name : names) {
    const auto found = known.find(name);
    if (found == known.end()) {
      std::vector<std::string> all;
      for (const auto& entry : known) all.push_back(entry.first);
      throw InvalidMesh(fmt::format("the mesh has no patch '{}'; its patches are: {}", name,
                                    all.empty() ? "none" : fmt::format("{}", fmt::join(all, ", "))));
    }
    tags.insert(found->second.begin(), found->second.end());
  }
  return tags;
}

}  // namespace

void select_patches(MeshData& mesh, std::span<const std::string> names) {
  std::vector<std::string> all_names(names.begin(), names.end());
  for (const PeriodicPair& pair : mesh.periodic) all_names.insert(all_names.end(), {pair.a, pair.b});
  std::set<std::int32_t> kept = tags_of_patches(mesh, all_names);
  for (const std::int32_t tag : mesh.baffle_tags) {
    if (kept.insert(tag).second) mesh.patch_names[tag] = "";
  }
  std::erase_if(mesh.patch_order, [&](std::int32_t tag) { return kept.count(tag) == 0; });
  const MeshData all = take_patch_faces(mesh);
  for (std::size_t f = 0; f < all.patch_tags.size(); ++f) {
    if (kept.count(all.patch_tags[f]) == 0) continue;
    mesh.add_patch_face(all.patch_face(f), all.patch_tags[f]);
    if (!all.patch_source.empty()) mesh.patch_source.push_back(all.patch_source[f]);
  }
}

void select_walls(MeshData& mesh, std::span<const std::string> names) {
  if (names.empty()) return;
  const std::set<std::int32_t> tags = tags_of_patches(mesh, names);
  list_both_sides(mesh, tags);
  for (const std::int32_t tag : tags) {
    if (!is_baffle(mesh, tag)) mesh.baffle_tags.push_back(tag);
  }
  end_pairs(mesh, names);
}

void divide_walls(MeshData& mesh, double degrees) {
  const MeshData free = free_cells(mesh);
  const BoundaryFaces walls = match_faces(free, true).boundary;
  SmoothParts parts(free, walls, degrees);
  std::vector<std::uint32_t> order(walls.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto cell = [&](std::uint32_t w) { return free.source[walls.cells[w]]; };
    if (cell(a) != cell(b)) return cell(a) < cell(b);
    const auto x = walls.face(a);
    const auto y = walls.face(b);
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  });
  take_patch_faces(mesh);
  mesh.patch_order.clear();
  mesh.patch_names.clear();
  mesh.baffle_tags.clear();
  mesh.periodic.clear();
  std::map<std::uint32_t, std::int32_t> tags;
  for (const std::uint32_t w : order) {
    const auto [found, fresh] = tags.try_emplace(parts.root(w), static_cast<std::int32_t>(tags.size() + 1));
    if (fresh) mesh.patch_names[found->second] = fmt::format("patch{}", found->second);
    mesh.add_patch_face(walls.face(w), found->second);
    if (fresh && !free.baffle_tags.empty()) mesh.baffle_tags.push_back(found->second);
  }
}

}  // namespace dartcast
