// Checks a surface in space, and turns its faces to one orientation.
#include "surface/check_surface.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dartcast/predicates.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/structure.hpp"
#include "surface/ears.hpp"
#include "surface/surface_warnings.hpp"
#include "surface/unfold.hpp"

namespace dartcast {
namespace {

std::size_t surface_source(const MeshData& mesh, std::size_t c) { return mesh.source.empty() ? c : mesh.source[c]; }

// A face at an edge. If both faces of an edge run forward, or both backward, they do not agree.
struct EdgeUse {
  std::uint32_t low, high;
  std::uint32_t cell;
  bool forward;

  [[nodiscard]] bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

std::vector<EdgeUse> edge_uses(const MeshData& mesh) {
  std::vector<EdgeUse> uses;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> e) {
      uses.push_back({std::min(e[0], e[1]), std::max(e[0], e[1]), c, e[0] < e[1]});
    });
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.cell, a.forward) < std::tie(b.low, b.high, b.cell, b.forward);
  });
  return uses;
}

struct FaceNeighbour {
  std::uint32_t from, to;
  bool agrees;
};

// Both directions across each edge of two faces. An edge of more faces is a defect.
std::vector<FaceNeighbour> neighbours_of(const MeshData& mesh, MeshReport& report) {
  const std::vector<EdgeUse> uses = edge_uses(mesh);
  std::vector<FaceNeighbour> pairs;
  Finding crowded{"face_shared", 0, {}, "edges of three faces or more, or twice of one; one of the faces is named"};
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].same_edge(uses[i])) ++end;
    const EdgeUse& a = uses[i];
    if (end - i == 2 && a.cell != uses[i + 1].cell) {
      const EdgeUse& b = uses[i + 1];
      pairs.push_back({a.cell, b.cell, a.forward != b.forward});
      pairs.push_back({b.cell, a.cell, a.forward != b.forward});
    } else if (end - i > 1) {
      crowded.add(surface_source(mesh, a.cell));
    }
    i = end;
  }
  add_finding(report.defects, crowded);
  std::sort(pairs.begin(), pairs.end(), [](const FaceNeighbour& a, const FaceNeighbour& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  });
  return pairs;
}

enum class Turn : std::uint8_t { unknown, keep, turn };

Turn other_way(Turn t) { return t == Turn::keep ? Turn::turn : Turn::keep; }

void agree_on_orientation(MeshData& mesh, MeshReport& report) {
  const std::vector<FaceNeighbour> pairs = neighbours_of(mesh, report);
  if (!report.valid()) return;
  std::vector<std::size_t> first(mesh.cell_count() + 1, 0);
  for (const FaceNeighbour& p : pairs) ++first[p.from + 1U];
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  std::vector<Turn> turns(mesh.cell_count(), Turn::unknown);
  Finding one_sided{
      "not_orientable", 0, {}, "faces that agree with their neighbours in no orientation: cut the surface"};
  std::vector<std::uint32_t> open;
  for (std::uint32_t start = 0; start < mesh.cell_count(); ++start) {
    if (turns[start] != Turn::unknown) continue;
    ++report.parts;
    turns[start] = Turn::keep;
    open.push_back(start);
    while (!open.empty()) {
      const std::uint32_t c = open.back();
      open.pop_back();
      for (std::size_t i = first[c]; i < first[c + 1U]; ++i) {
        Turn& other = turns[pairs[i].to];
        const Turn wanted = pairs[i].agrees ? turns[c] : other_way(turns[c]);
        if (other == Turn::unknown) {
          other = wanted;
          open.push_back(pairs[i].to);
        } else if (other != wanted && c < pairs[i].to) {
          one_sided.add(surface_source(mesh, c));
        }
      }
    }
  }
  add_finding(report.defects, one_sided);
  if (!report.valid()) return;
  Finding turned{"orientation", 0, {}, "faces ran against their neighbours; their corners have been reordered"};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (turns[c] != Turn::turn) continue;
    turned.add(surface_source(mesh, c));
    std::reverse(mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(mesh.offsets[c]),
                 mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(mesh.offsets[c + 1]));
  }
  add_finding(report.repairs, turned);
}

void check_surface_points(const MeshData& mesh, MeshReport& report) {
  Finding not_finite{"not_finite", 0, {}, "points with a coordinate that is not a finite number"};
  Finding out{"out_of_range", 0, {}, "points with a coordinate too large for exact signs (above 2^300, 2e+90)"};
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (!in_exact_range(mesh.points[p])) (is_finite(mesh.points[p]) ? out : not_finite).add(p);
  }
  add_finding(report.defects, not_finite);
  add_finding(report.defects, out);
}

/// The triangles to divide a face into; none: it stays. Faces of which no division is known stay, too.
std::vector<TriangleCorners> division_of(const MeshData& mesh, std::size_t c) {
  const auto face = mesh.cell(c);
  if (face.size() == 3) return {};
  const auto lowest = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  if (do_not_overlap(mesh.points, face, fan_from(face, lowest))) return {};
  std::vector<TriangleCorners> triangles = ears(mesh.points, face);
  if (!do_not_overlap(mesh.points, face, triangles)) triangles.clear();
  return triangles;
}

template <class T>
void take_rows(std::vector<T>& values, std::span<const std::uint32_t> rows, std::size_t components = 1) {
  if (values.empty()) return;
  std::vector<T> taken;
  for (const std::uint32_t row : rows) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(row * components);
    taken.insert(taken.end(), from, from + static_cast<std::ptrdiff_t>(components));
  }
  values = std::move(taken);
}

void divide_faces(MeshData& mesh, MeshReport& report) {
  Finding divided{"not_convex", 0, {}, "faces that are not convex; they have been divided into triangles"};
  std::map<std::uint32_t, std::vector<TriangleCorners>> divisions;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    std::vector<TriangleCorners> triangles = division_of(mesh, c);
    if (triangles.empty()) continue;
    divided.add(surface_source(mesh, c));
    divisions[c] = std::move(triangles);
  }
  if (divisions.empty()) return;
  MeshData out;
  std::vector<std::uint32_t> rows;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    const auto division = divisions.find(c);
    if (division == divisions.end()) {
      out.add_cell(mesh.types[c], mesh.cell(c));
    } else {
      for (const TriangleCorners& t : division->second) out.add_cell(CellType::triangle, t);
    }
    rows.resize(out.cell_count(), c);
  }
  if (mesh.source.empty()) {
    mesh.source = rows;
  } else {
    take_rows(mesh.source, rows);
  }
  mesh.types = std::move(out.types);
  mesh.offsets = std::move(out.offsets);
  mesh.connectivity = std::move(out.connectivity);
  take_rows(mesh.regions, rows);
  take_rows(mesh.free, rows);
  for (DataArray& array : mesh.cell_data) take_rows(array.values, rows, array.components);
  report.repairs.push_back(divided);
}

void check_areas(const MeshData& mesh, MeshReport& report) {
  Finding flat{"flat", 0, {}, "faces with a triangle without area in their fan: remove them, or move their corners"};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto corners = mesh.cell(c);
    const std::size_t n = corners.size();
    const auto apex = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
    const auto at = [&](std::size_t i) { return mesh.points[corners[(apex + i) % n]]; };
    bool found = false;
    for (std::size_t i = 1; i + 1 < n && !found; ++i) found = !detail::has_area(at(0), at(i), at(i + 1));
    if (found) flat.add(surface_source(mesh, c));
  }
  add_finding(report.defects, flat);
}

}  // namespace

MeshReport check_and_repair_surface(MeshData& mesh) {
  MeshReport report;
  report.dimension = 2;
  report.surface = true;
  report.points = mesh.points.size();
  check_arrays(mesh, report);
  if (!report.valid()) return report;
  const auto count_cells = [&] {
    report.cells.clear();
    for (const CellType t : mesh.types) ++report.cells[std::string(cell_type_names[static_cast<std::size_t>(t)])];
  };
  count_cells();
  if (mesh.dimension() != 2) {
    report.defects.push_back({"structure", 1, {0}, "cells of space, not faces of a surface: take the mesh's boundary"});
    return report;
  }
  check_and_repair_structure(mesh, report);
  if (!report.valid()) return report;
  check_surface_points(mesh, report);
  if (!report.valid()) return report;
  divide_faces(mesh, report);
  count_cells();
  agree_on_orientation(mesh, report);
  check_areas(mesh, report);
  if (report.valid()) add_surface_warnings(mesh, report);
  return report;
}

}  // namespace dartcast
