// Cuts parts out of a mesh.
//
// Phases of a cut: Take the points of the cells, in their order. Copy all that belongs to these. Name the faces that
// have lost the cell behind them.
#include "parts/part_cutter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "mesh/baffles.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t none = 0xffffffffU;

// By the numbers that the map gives them.
std::vector<std::int32_t> patch_order_of(const MeshData& mesh) {
  std::vector<std::int32_t> order = mesh.patch_order;
  std::set<std::int32_t> known(order.begin(), order.end());
  for (const std::int32_t tag : mesh.patch_tags) {
    if (known.insert(tag).second) order.push_back(tag);
  }
  return order;
}

}  // namespace

std::vector<std::uint32_t> sorted_corners(std::span<const std::uint32_t> face) {
  std::vector<std::uint32_t> result(face.begin(), face.end());
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<DataArray> taken(const std::vector<DataArray>& arrays, std::span<const std::uint32_t> which) {
  std::vector<DataArray> result;
  for (const DataArray& a : arrays) {
    DataArray& some = result.emplace_back(DataArray{a.name, a.components, {}});
    some.values.reserve(which.size() * a.components);
    for (const std::uint32_t i : which) {
      const auto first = a.values.begin() + static_cast<std::ptrdiff_t>(i * a.components);
      some.values.insert(some.values.end(), first, first + static_cast<std::ptrdiff_t>(a.components));
    }
  }
  return result;
}

std::vector<Cell> handles_of(const MeshData& whole) {
  std::array<std::uint32_t, 5> count{};  // cells in each pool
  std::vector<Cell> handles;
  handles.reserve(whole.cell_count());
  for (const CellType type : whole.types) {
    const std::uint32_t pool = CombinatorialMap::pool_of(type);
    handles.emplace_back(pool, count[pool]++);
  }
  return handles;
}

std::int32_t unknown_tag_of(const MeshData& mesh) {
  for (const auto& [tag, name] : mesh.patch_names) {
    if (name == unknown_patch) return tag;
  }
  std::set<std::int32_t> known(mesh.patch_order.begin(), mesh.patch_order.end());
  known.insert(mesh.patch_tags.begin(), mesh.patch_tags.end());
  std::int32_t tag = std::numeric_limits<std::int32_t>::max();
  while (mesh.patch_names.contains(tag) || known.contains(tag)) --tag;
  return tag;
}

PartCutter::PartCutter(const MeshData& whole, std::span<const std::uint32_t> owners, std::uint32_t parts)
    : PartCutter(whole, nullptr, owners, parts) {
  if (!whole.periodic.empty())
    throw InvalidArgument(
        fmt::format("a mesh with periodic pairs (\"{}\" and \"{}\") cannot be divided into parts: share the particles "
                    "instead, or make walls of the pairs (`walls` in a scene)",
                    whole.periodic.front().a, whole.periodic.front().b));
}

PartCutter::PartCutter(const MeshPart& from, std::span<const std::uint32_t> owners)
    : PartCutter(from.mesh, &from, owners, from.parts) {}

PartCutter::PartCutter(const MeshData& mesh, const MeshPart* from, std::span<const std::uint32_t> owners,
                       std::uint32_t parts)
    : mesh_(mesh),
      from_(from),
      owners_(owners),
      parts_(parts),
      handles_(from != nullptr ? from->handles : handles_of(mesh)),
      cells_of_part_(parts,
                     [&](auto add) {
                       for (std::uint32_t c = 0; c < owners.size(); ++c) add(owners[c], c);
                     }),
      cells_at_point_(mesh.points.size(),
                      [&](auto add) {
                        for (std::uint32_t c = 0; c < mesh.cell_count(); ++c)
                          for_each_point(mesh, c, [&](std::uint32_t p) { add(p, c); });
                      }),
      patch_faces_(mesh.points.size(),
                   [&](auto add) {
                     for (std::uint32_t f = 0; f < mesh.patch_tags.size(); ++f) add(mesh.patch_face(f)[0], f);
                   }),
      boundary_(match_faces(mesh).boundary),
      boundary_of_cell_(mesh.cell_count(),
                        [&](auto add) {
                          for (std::uint32_t f = 0; f < boundary_.size(); ++f) add(boundary_.cells[f], f);
                        }),
      patch_order_(patch_order_of(mesh)),
      unknown_tag_(unknown_tag_of(mesh)),
      number_(mesh.points.size(), none) {
  std::erase(patch_order_, unknown_tag_);
  patch_order_.push_back(unknown_tag_);
}

std::vector<std::uint32_t> PartCutter::cells_of(std::uint32_t part) const {
  std::vector<std::uint32_t> points;
  for (const std::uint32_t c : cells_of_part_[part])
    for_each_point(mesh_, c, [&](std::uint32_t p) { points.push_back(p); });
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<std::uint32_t> cells;
  for (const std::uint32_t p : points) {
    const auto around = cells_at_point_[p];
    cells.insert(cells.end(), around.begin(), around.end());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

MeshPart PartCutter::cut(std::span<const std::uint32_t> cells, std::uint32_t part) {
  MeshPart out;
  out.part = part;
  out.parts = parts_;
  copy_points(cells, out);
  copy_cells(cells, out);
  copy_patches(out);
  name_unknown_faces(out);
  for (const std::uint32_t p : out.points) number_[p] = none;
  if (from_ == nullptr) return out;
  for (std::uint32_t& p : out.points) p = from_->points[p];
  for (std::uint32_t& c : out.cells) c = from_->cells[c];
  return out;
}

void PartCutter::copy_points(std::span<const std::uint32_t> cells, MeshPart& out) {
  for (const std::uint32_t c : cells) for_each_point(mesh_, c, [&](std::uint32_t p) { out.points.push_back(p); });
  std::sort(out.points.begin(), out.points.end());
  out.points.erase(std::unique(out.points.begin(), out.points.end()), out.points.end());
  out.mesh.points.reserve(out.points.size());
  for (const std::uint32_t p : out.points) {
    number_[p] = static_cast<std::uint32_t>(out.mesh.points.size());
    out.mesh.points.push_back(mesh_.points[p]);
  }
  out.mesh.point_data = taken(mesh_.point_data, out.points);
}

void PartCutter::copy_cells(std::span<const std::uint32_t> cells, MeshPart& out) const {
  MeshData& mesh = out.mesh;
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t c : cells) {
    corners.clear();
    for_each_entry(
        mesh_, c, [&](std::uint32_t p) { corners.push_back(number_[p]); },
        [&](std::uint32_t n) { corners.push_back(n); });
    mesh.add_cell(mesh_.types[c], corners);
    mesh.source.push_back(mesh_.source.empty() ? c : mesh_.source[c]);
    if (!mesh_.regions.empty()) mesh.regions.push_back(mesh_.regions[c]);
    if (!mesh_.free.empty()) mesh.free.push_back(mesh_.free[c]);
    out.cells.push_back(c);
    out.owners.push_back(owners_[c]);
    out.handles.push_back(handles_[c]);
  }
  mesh.region_names = mesh_.region_names;
  mesh.cell_data = taken(mesh_.cell_data, cells);
}

// Faces in their order, so that one that is listed twice has the same patch as in the whole.
void PartCutter::copy_patches(MeshPart& out) const {
  std::vector<std::uint32_t> faces;
  for (const std::uint32_t p : out.points) {
    for (const std::uint32_t f : patch_faces_[p]) {
      const auto face = mesh_.patch_face(f);
      if (std::all_of(face.begin(), face.end(), [&](std::uint32_t q) { return number_[q] != none; }))
        faces.push_back(f);
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t f : faces) {
    corners.clear();
    for (const std::uint32_t p : mesh_.patch_face(f)) corners.push_back(number_[p]);
    out.mesh.add_patch_face(corners, mesh_.patch_tags[f]);
  }
  out.mesh.patch_names = mesh_.patch_names;
  out.mesh.patch_names[unknown_tag_] = unknown_patch;
  out.mesh.patch_order = patch_order_;
  out.mesh.baffle_tags = mesh_.baffle_tags;
}

// Those on the boundary of the part that are not on the boundary of the mesh, or have a cell behind them there.
void PartCutter::name_unknown_faces(MeshPart& out) const {
  const BoundaryFaces around = match_faces(out.mesh).boundary;
  const Baffles baffles(out.mesh);
  std::vector<std::uint32_t> corners;
  for (std::size_t f = 0; f < around.size(); ++f) {
    corners.clear();
    for (const std::uint32_t p : around.face(f)) corners.push_back(out.points[p]);
    if (!baffles.contains(around.face(f)) && !is_outer(out.cells[around.cells[f]], sorted_corners(corners)))
      out.mesh.add_patch_face(around.face(f), unknown_tag_);
  }
}

bool PartCutter::is_outer(std::uint32_t cell, std::span<const std::uint32_t> sorted_face) const {
  const auto faces = boundary_of_cell_[cell];
  return std::any_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
    const auto corners = sorted_corners(boundary_.face(f));
    return std::equal(corners.begin(), corners.end(), sorted_face.begin(), sorted_face.end());
  });
}

}  // namespace dartcast
