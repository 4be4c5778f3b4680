// Cuts a part out of a mesh.
//
// Phases: mark the points of the part's own cells; take all cells with a marked point, and all their points, in their
// order; copy what belongs to these; name the faces that have lost the cell behind them.
#include "parts/mesh_part.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/faces.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t none = 0xffffffffU;

// Calls visit(number) for each entry of a cell's connectivity that is a point, and other(number) for the counts of a
// polyhedron, in their order.
template <class Visit, class Other>
void for_each_entry(const MeshData& mesh, std::size_t c, Visit&& visit, Other&& other) {
  const auto corners = mesh.cell(c);
  if (mesh.types[c] != CellType::polyhedron) {
    for (const std::uint32_t p : corners) visit(p);
    return;
  }
  other(corners[0]);
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < corners[0]; ++f) {
    const std::uint32_t count = corners[at++];
    other(count);
    for (std::uint32_t k = 0; k < count; ++k) visit(corners[at++]);
  }
}

template <class Visit>
void for_each_point(const MeshData& mesh, std::size_t c, Visit&& visit) {
  for_each_entry(mesh, c, visit, [](std::uint32_t) {});
}

// The values of some items.
std::vector<DataArray> taken(const std::vector<DataArray>& arrays, std::span<const std::uint32_t> which) {
  std::vector<DataArray> result;
  for (const DataArray& a : arrays) {
    DataArray& some = result.emplace_back(DataArray{a.name, a.components, {}});
    for (const std::uint32_t i : which) {
      const auto first = a.values.begin() + static_cast<std::ptrdiff_t>(i * a.components);
      some.values.insert(some.values.end(), first, first + static_cast<std::ptrdiff_t>(a.components));
    }
  }
  return result;
}

class PartBuilder {
 public:
  PartBuilder(const MeshData& whole, std::span<const std::uint32_t> parts, std::uint32_t part)
      : whole_(whole), parts_(parts), part_(part) {}

  MeshPart build() {
    choose();
    copy_points();
    copy_cells();
    copy_patches();
    name_unknown_faces();
    return std::move(out_);
  }

 private:
  void choose() {
    std::vector<bool> near(whole_.points.size());
    for (std::size_t c = 0; c < parts_.size(); ++c) {
      if (parts_[c] == part_) for_each_point(whole_, c, [&](std::uint32_t p) { near[p] = true; });
    }
    number_.assign(whole_.points.size(), none);
    for (std::uint32_t c = 0; c < parts_.size(); ++c) {
      bool touches = false;
      for_each_point(whole_, c, [&](std::uint32_t p) { touches = touches || near[p]; });
      if (!touches) continue;
      out_.cells.push_back(c);
      for_each_point(whole_, c, [&](std::uint32_t p) { number_[p] = 0; });
    }
  }

  void copy_points() {
    for (std::uint32_t p = 0; p < number_.size(); ++p) {
      if (number_[p] == none) continue;
      number_[p] = static_cast<std::uint32_t>(out_.points.size());
      out_.points.push_back(p);
      out_.mesh.points.push_back(whole_.points[p]);
    }
    out_.mesh.point_data = taken(whole_.point_data, out_.points);
  }

  void copy_cells() {
    MeshData& mesh = out_.mesh;
    std::array<std::uint32_t, 5> count{};  // cells of the whole in each pool
    std::size_t next = 0;
    std::vector<std::uint32_t> corners;
    for (std::uint32_t c = 0; c < parts_.size(); ++c) {
      const std::uint32_t pool = CombinatorialMap::pool_of(whole_.types[c]);
      const Cell handle(pool, count[pool]++);
      if (next == out_.cells.size() || out_.cells[next] != c) continue;
      ++next;
      corners.clear();
      for_each_entry(
          whole_, c, [&](std::uint32_t p) { corners.push_back(number_[p]); },
          [&](std::uint32_t n) { corners.push_back(n); });
      mesh.add_cell(whole_.types[c], corners);
      mesh.source.push_back(whole_.source.empty() ? c : whole_.source[c]);
      if (!whole_.regions.empty()) mesh.regions.push_back(whole_.regions[c]);
      if (!whole_.free.empty()) mesh.free.push_back(whole_.free[c]);
      out_.owners.push_back(parts_[c]);
      out_.handles.push_back(handle);
    }
    mesh.region_names = whole_.region_names;
    mesh.cell_data = taken(whole_.cell_data, out_.cells);
  }

  void copy_patches() {
    MeshData& mesh = out_.mesh;
    std::set<std::int32_t> known;
    std::vector<std::uint32_t> corners;
    for (std::size_t f = 0; f < whole_.patch_tags.size(); ++f) {
      const std::int32_t tag = whole_.patch_tags[f];
      if (known.insert(tag).second) mesh.patch_order.push_back(tag);
      corners.clear();
      for (const std::uint32_t p : whole_.patch_face(f)) corners.push_back(number_[p]);
      if (std::find(corners.begin(), corners.end(), none) == corners.end()) mesh.add_patch_face(corners, tag);
    }
    mesh.patch_names = whole_.patch_names;
  }

  // Those on the boundary of the part that are not on the boundary of the whole, or have a cell behind them there.
  void name_unknown_faces() {
    MeshData& mesh = out_.mesh;
    std::int32_t tag = std::numeric_limits<std::int32_t>::max();
    while (mesh.patch_names.contains(tag) || std::count(mesh.patch_order.begin(), mesh.patch_order.end(), tag) > 0)
      --tag;
    mesh.patch_names[tag] = unknown_patch;
    mesh.patch_order.push_back(tag);
    const BoundaryFaces around = match_faces(mesh).boundary;
    std::set<std::vector<std::uint32_t>> of_whole;
    const BoundaryFaces all = match_faces(whole_).boundary;
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (number_[all.face(f)[0]] != none) of_whole.insert(sorted(all.face(f)));
    }
    for (std::size_t f = 0; f < around.size(); ++f) {
      std::vector<std::uint32_t> corners;
      for (const std::uint32_t p : around.face(f)) corners.push_back(out_.points[p]);
      if (!of_whole.contains(sorted(corners))) mesh.add_patch_face(around.face(f), tag);
    }
  }

  static std::vector<std::uint32_t> sorted(std::span<const std::uint32_t> corners) {
    std::vector<std::uint32_t> result(corners.begin(), corners.end());
    std::sort(result.begin(), result.end());
    return result;
  }

  const MeshData& whole_;
  std::span<const std::uint32_t> parts_;
  std::uint32_t part_;
  std::vector<std::uint32_t> number_;  // of a point of the whole in the part
  MeshPart out_;
};

}  // namespace

MeshPart mesh_part(const MeshData& whole, std::span<const std::uint32_t> parts, std::uint32_t part) {
  return PartBuilder(whole, parts, part).build();
}

MeshData own_mesh(const MeshPart& part, std::uint32_t rank) {
  const MeshData& all = part.mesh;
  MeshData own;
  own.points = all.points;
  own.region_names = all.region_names;
  own.point_data = all.point_data;
  std::vector<std::uint32_t> which;
  for (std::uint32_t c = 0; c < all.cell_count(); ++c) {
    if (part.owners[c] != rank) continue;
    which.push_back(c);
    own.add_cell(all.types[c], all.cell(c));
    own.source.push_back(all.source[c]);
    if (!all.regions.empty()) own.regions.push_back(all.regions[c]);
    if (!all.free.empty()) own.free.push_back(all.free[c]);
  }
  own.cell_data = taken(all.cell_data, which);
  return own;
}

PartCells part_cells(const MeshPart& part, unsigned rank) {
  std::array<std::vector<PartCells::Entry>, 5> cells;
  for (std::size_t c = 0; c < part.cells.size(); ++c)
    cells[part.handles[c].pool()].push_back({part.handles[c], part.owners[c]});
  return {rank, std::move(cells)};
}

}  // namespace dartcast
