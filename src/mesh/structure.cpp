// Checks the arrays of a mesh, ids and corners; drops unused points and stray patch faces.
#include "mesh/structure.hpp"

#include <algorithm>
#include <string>

#include "mesh/cell_types.hpp"
#include "mesh/collapsed.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

constexpr std::uint32_t unused = 0xffffffffU;

bool ascends(const std::vector<std::size_t>& offsets, std::size_t items, std::size_t end) {
  return offsets.size() == items + 1 && offsets.front() == 0 && offsets.back() == end &&
         std::is_sorted(offsets.begin(), offsets.end());
}

bool has_size(const DataArray& array, std::size_t items) {
  return array.components > 0 && array.values.size() / array.components == items &&
         array.values.size() % array.components == 0;
}

/// Calls visit(point) for each corner of cell c; false if the cell's stream of numbers is not well formed.
template <class Visit>
bool visit_corners(const MeshData& mesh, std::size_t c, Visit&& visit) {
  const auto cell = mesh.cell(c);
  if (mesh.types[c] != CellType::polyhedron) {
    const bool polygon = mesh.types[c] == CellType::polygon;
    if (polygon ? cell.size() < 3 || cell.size() > polyhedron_limit : cell.size() != corner_count(mesh.types[c]))
      return false;
    for (const std::uint32_t v : cell) visit(v);
    return true;
  }
  if (cell.size() < 2 || cell[0] < 4 || cell[0] > polyhedron_limit) return false;
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < cell[0]; ++f) {
    if (at >= cell.size() || cell[at] < 3 || cell[at] > polyhedron_limit || cell[at] >= cell.size() - at) return false;
    for (std::uint32_t k = 0; k < cell[at]; ++k) visit(cell[at + 1 + k]);
    at += cell[at] + 1;
  }
  return at == cell.size();
}

bool repeats(std::vector<std::uint32_t>& corners) {
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

bool too_many_corners(const MeshData& mesh, std::size_t c, std::vector<std::uint32_t>& work) {
  if (mesh.types[c] != CellType::polyhedron || mesh.cell(c).size() <= polyhedron_limit) return false;
  work.clear();
  for_each_face(mesh, c,
                [&](std::span<const std::uint32_t> face) { work.insert(work.end(), face.begin(), face.end()); });
  std::sort(work.begin(), work.end());
  return std::unique(work.begin(), work.end()) - work.begin() > static_cast<std::ptrdiff_t>(polyhedron_limit);
}

std::uint32_t patch_source_of(const MeshData& mesh, std::size_t f) {
  return mesh.patch_source.empty() ? static_cast<std::uint32_t>(f) : mesh.patch_source[f];
}

void check_patch_faces(const MeshData& mesh, MeshReport& report) {
  const bool plane = mesh.dimension() == 2;
  Finding size{"structure",
               0,
               {},
               plane ? "patch edges that do not have two corners"
                     : "patch faces with fewer than three corners or more than 1000"};
  Finding range{"id_out_of_range", 0, {}, "patch faces that name points which do not exist"};
  Finding repeated{"repeated_corner", 0, {}, "patch faces that name a point twice"};
  std::vector<std::uint32_t> work;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    work.assign(mesh.patch_face(f).begin(), mesh.patch_face(f).end());
    const std::uint32_t place = patch_source_of(mesh, f);
    if (plane ? work.size() != 2 : work.size() < 3 || work.size() > polyhedron_limit) {
      size.add(place);
    } else if (*std::max_element(work.begin(), work.end()) >= mesh.points.size()) {
      range.add(place);
    } else if (repeats(work)) {
      repeated.add(place);
    }
  }
  add_finding(report.defects, size);
  add_finding(report.defects, range);
  add_finding(report.defects, repeated);
}

/// Keeps the patch faces for which keep[f] holds.
void filter_patch_faces(MeshData& mesh, const std::vector<bool>& keep) {
  std::vector<std::uint32_t> faces;
  std::vector<std::size_t> offsets = {0};
  std::vector<std::int32_t> tags;
  std::vector<std::uint32_t> source;
  for (std::size_t f = 0; f < keep.size(); ++f) {
    if (!keep[f]) continue;
    source.push_back(patch_source_of(mesh, f));
    faces.insert(faces.end(), mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f]),
                 mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f + 1]));
    offsets.push_back(faces.size());
    tags.push_back(mesh.patch_tags[f]);
  }
  mesh.patch_faces = std::move(faces);
  mesh.patch_offsets = std::move(offsets);
  mesh.patch_tags = std::move(tags);
  mesh.patch_source = std::move(source);
}

/// Drops patch faces and says so; `stray` is added to the report's warnings.
void drop_patch_faces(MeshData& mesh, const std::vector<bool>& keep, MeshReport& report) {
  Finding stray{"patch_faces", 0, {}, "faces of named groups that are no face of any cell; they have been dropped"};
  for (std::size_t f = 0; f < keep.size(); ++f) {
    if (!keep[f]) stray.add(patch_source_of(mesh, f));
  }
  if (stray.count == 0) return;
  filter_patch_faces(mesh, keep);
  add_finding(report.warnings, stray);
}

/// New number of each point, or `unused`.
std::vector<std::uint32_t> number_used_points(const MeshData& mesh) {
  std::vector<std::uint32_t> number(mesh.points.size(), unused);
  const auto use = [&](std::uint32_t v) { number[v] = 0; };
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) visit_corners(mesh, c, use);
  std::uint32_t next = 0;
  for (std::uint32_t& n : number) {
    if (n != unused) n = next++;
  }
  return number;
}

void renumber_cells(MeshData& mesh, const std::vector<std::uint32_t>& number) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    std::uint32_t* cell = mesh.connectivity.data() + mesh.offsets[c];
    if (mesh.types[c] != CellType::polyhedron) {
      for (std::size_t k = 0; k < mesh.cell(c).size(); ++k) cell[k] = number[cell[k]];
      continue;
    }
    std::size_t at = 1;
    for (std::uint32_t f = 0; f < cell[0]; ++f) {
      const std::uint32_t n = cell[at++];
      for (std::uint32_t k = 0; k < n; ++k, ++at) cell[at] = number[cell[at]];
    }
  }
}

std::vector<std::uint32_t> sorted_face(std::span<const std::uint32_t> face) {
  std::vector<std::uint32_t> corners(face.begin(), face.end());
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

void check_arrays(const MeshData& mesh, MeshReport& report) {
  const std::size_t cells = mesh.types.size();
  const auto refuse = [&](const char* kind, const char* message) { report.defects.push_back({kind, 1, {0}, message}); };
  if (cells >= (std::size_t{1} << 29U)) refuse("too_large", "more than 2^29 cells");
  if (mesh.points.size() >= unused) refuse("too_large", "more than 2^32 - 2 points");
  if (!ascends(mesh.offsets, cells, mesh.connectivity.size())) {
    refuse("structure", "offsets do not ascend from 0 to the size of connectivity, one per cell and one more");
  }
  if (!ascends(mesh.patch_offsets, mesh.patch_tags.size(), mesh.patch_faces.size())) {
    refuse("structure", "patch_offsets do not ascend from 0 to the size of patch_faces, one per face and one more");
  }
  const auto one_each = [&](std::size_t size) { return size == 0 || size == cells; };
  if (!mesh.patch_source.empty() && mesh.patch_source.size() != mesh.patch_tags.size())
    refuse("structure", "patch_source does not have one value per patch face");
  if (!one_each(mesh.regions.size()) || !one_each(mesh.free.size()) || !one_each(mesh.source.size())) {
    refuse("structure", "regions, free or source do not have one value per cell");
  }
  if (cells == 0) refuse("empty", "no cells");
  const auto all = [&](auto&& holds) { return std::all_of(mesh.types.begin(), mesh.types.end(), holds); };
  if (!all([](CellType type) { return static_cast<std::size_t>(type) < cell_type_names.size(); })) {
    refuse("structure", "a cell's type is not one of those known");
  } else if (!all([&](CellType type) { return dimension(type) == mesh.dimension(); })) {
    refuse("structure", "cells of the plane and cells of space in one mesh; leave one kind out");
  }
  for (const DataArray& array : mesh.point_data) {
    if (!has_size(array, mesh.points.size()))
      refuse("structure", "an array of point_data does not have one item per point");
  }
  for (const DataArray& array : mesh.cell_data) {
    if (!has_size(array, cells)) refuse("structure", "an array of cell_data does not have one item per cell");
  }
}

void check_and_repair_structure(MeshData& mesh, MeshReport& report) {
  MeshReport first;
  check_structure(mesh, first);
  const auto is_repeated = [](const Finding& defect) { return defect.kind == "repeated_corner"; };
  if (!first.valid() && std::all_of(first.defects.begin(), first.defects.end(), is_repeated)) {
    retype_collapsed(mesh, report);
    first.defects.clear();
    check_structure(mesh, first);
  }
  report.defects.insert(report.defects.end(), first.defects.begin(), first.defects.end());
}

void check_structure(const MeshData& mesh, MeshReport& report) {
  Finding size{
      "structure",
      0,
      {},
      "cells with a number of corners that their type does not have, or polygons with fewer than 3 or more than 1000"};
  Finding polyhedron{"polyhedron",
                     0,
                     {},
                     "polyhedra with fewer than 4 faces, a face of fewer than 3 corners, more than 1000 "
                     "faces or corners, or numbers that do not fit together"};
  Finding range{"id_out_of_range", 0, {}, "cells that name points which do not exist"};
  Finding repeated{"repeated_corner", 0, {}, "cells that name a point twice; give each its proper type, or remove it"};
  std::vector<std::uint32_t> work;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const std::size_t place = mesh.source.empty() ? c : mesh.source[c];
    bool in_range = true;
    const bool well_formed =
        visit_corners(mesh, c, [&](std::uint32_t v) { in_range = in_range && v < mesh.points.size(); });
    if (!well_formed) {
      (mesh.types[c] == CellType::polyhedron ? polyhedron : size).add(place);
    } else if (!in_range) {
      range.add(place);
    } else if (too_many_corners(mesh, c, work)) {
      polyhedron.add(place);
    } else if (repeats_corner(mesh, c)) {
      repeated.add(place);
    }
  }
  add_finding(report.defects, size);
  add_finding(report.defects, polyhedron);
  add_finding(report.defects, range);
  add_finding(report.defects, repeated);
  check_patch_faces(mesh, report);
}

std::vector<std::uint32_t> drop_unused_points(MeshData& mesh, MeshReport& report) {
  const std::vector<std::uint32_t> number = number_used_points(mesh);
  Finding dropped{"unused_points", 0, {}, "points that no cell uses; they have been dropped"};
  std::vector<std::uint32_t> old;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == unused) {
      dropped.add(p);
    } else {
      old.push_back(p);
    }
  }
  if (dropped.count == 0) return old;
  std::vector<bool> keep(mesh.patch_tags.size(), true);
  for (std::size_t f = 0; f < keep.size(); ++f) {
    for (std::size_t i = mesh.patch_offsets[f]; i < mesh.patch_offsets[f + 1]; ++i) {
      keep[f] = keep[f] && number[mesh.patch_faces[i]] != unused;
    }
  }
  drop_patch_faces(mesh, keep, report);
  renumber_cells(mesh, number);
  for (std::uint32_t& v : mesh.patch_faces) v = number[v];
  for (std::size_t p = 0; p < old.size(); ++p) mesh.points[p] = mesh.points[old[p]];
  mesh.points.resize(old.size());
  for (DataArray& array : mesh.point_data) {
    for (std::size_t p = 0; p < old.size(); ++p) {
      std::copy_n(array.values.begin() + static_cast<std::ptrdiff_t>(old[p] * array.components), array.components,
                  array.values.begin() + static_cast<std::ptrdiff_t>(p * array.components));
    }
    array.values.resize(old.size() * array.components);
  }
  add_finding(report.repairs, dropped);
  return old;
}

void for_each_patch_face_of_cells(const MeshData& mesh,
                                  const std::function<void(std::size_t face, std::size_t cell)>& visit) {
  struct Key {
    std::vector<std::uint32_t> corners;
    std::size_t face;
  };
  std::vector<Key> keys;
  std::vector<bool> starts(mesh.points.size(), false);
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t begin = mesh.patch_offsets[f];
    keys.push_back({sorted_face({mesh.patch_faces.data() + begin, mesh.patch_offsets[f + 1] - begin}), f});
    starts[keys.back().corners[0]] = true;
  }
  if (keys.empty()) return;
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.corners < b.corners; });
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      if (!starts[*std::min_element(face.begin(), face.end())]) return;
      const auto corners = sorted_face(face);
      auto at = std::lower_bound(keys.begin(), keys.end(), corners,
                                 [](const Key& key, const auto& wanted) { return key.corners < wanted; });
      for (; at != keys.end() && at->corners == corners; ++at) visit(at->face, c);
    });
  }
}

void drop_stray_patch_faces(MeshData& mesh, MeshReport& report) {
  std::vector<bool> keep(mesh.patch_tags.size(), false);
  for_each_patch_face_of_cells(mesh, [&](std::size_t face, std::size_t /*cell*/) { keep[face] = true; });
  drop_patch_faces(mesh, keep, report);
}

}  // namespace dartcast
