// Counts and sizes of a mesh, for the verb info.
#include "output/info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "complex/periodic_faces.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/map_edits.hpp"
#include "mesh/mesh_scale.hpp"
#include "output/mesh_report_text.hpp"

namespace dartcast {

namespace {

using Counts = std::map<std::string, std::size_t>;

void count_cells(const MeshData& mesh, MeshInfo& info) {
  for (const CellType type : mesh.types) ++info.cells[std::string(cell_type_names[static_cast<std::size_t>(type)])];
  for (const std::int32_t tag : mesh.regions) {
    const auto name = mesh.region_names.find(tag);
    ++info.regions[name == mesh.region_names.end() ? std::to_string(tag) : name->second];
  }
}

/// Adds a face as triangles around its first corner; an edge of the plane as it is.
void add_place(const CellComplex& complex, const CellView& view, std::uint16_t face, PatchPlace& sum) {
  const auto corners = view.shape().corners(face);
  const auto at = [&](std::size_t k) { return complex.positions()[view.vertex(corners[k]).value]; };
  const auto add = [&](double size, const Vec3& middle) {
    sum.size += size;
    sum.centre += middle * size;
  };
  if (corners.size() == 2) return add(norm(at(1) - at(0)), (at(0) + at(1)) * 0.5);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec3 a = at(0), b = at(k), c = at(k + 1);
    add(0.5 * norm(cross(b - a, c - a)), (a + b + c) * (1.0 / 3.0));
  }
}

void count_walls(const CellComplex& complex, MeshInfo& info) {
  const CombinatorialMap& map = complex.map();
  info.wall_faces = map.wall_face_count();
  info.inner_walls = inner_walls(map).size() / 2;
  if (const detail::PeriodicFaces* pairs = complex.periodic()) {
    for (std::size_t i = 0; i < pairs->pairs().size(); ++i)
      info.periodic.push_back({pairs->pairs()[i], pairs->face_count(i)});
  }
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    if (!view.is_free()) continue;
    ++info.free_cells;
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      if (!view.is_wall(f)) continue;
      const Patch patch = map.patch({c, f});
      if (patch.value == 0) continue;
      const std::string& name = map.patch_names()[patch.value];
      ++info.patches[name];
      add_place(complex, view, f, info.patch_places[name]);
    }
  }
  for (auto& [name, place] : info.patch_places) {
    if (place.size > 0.0) place.centre = place.centre * (1.0 / place.size);
  }
}

void find_bounds(const std::vector<Vec3>& points, MeshInfo& info) {
  if (points.empty()) return;
  info.low = info.high = points.front();
  for (const Vec3& p : points) {
    info.low = {std::min(info.low.x, p.x), std::min(info.low.y, p.y), std::min(info.low.z, p.z)};
    info.high = {std::max(info.high.x, p.x), std::max(info.high.y, p.y), std::max(info.high.z, p.z)};
  }
}

ArrayInfo array_info(const DataArray& array) {
  ArrayInfo info{array.name, array.components, {}, 0};
  constexpr double limit = std::numeric_limits<double>::max();
  std::vector<std::array<double, 2>> ranges(array.components, {limit, -limit});
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const double x = array.values[i];
    if (!std::isfinite(x)) {
      ++info.not_finite;
      continue;
    }
    auto& [low, high] = ranges[i % array.components];
    low = std::min(low, x);
    high = std::max(high, x);
  }
  const bool all_known = std::all_of(ranges.begin(), ranges.end(), [](const auto& r) { return r[0] <= r[1]; });
  if (all_known) info.ranges = std::move(ranges);
  return info;
}

std::vector<ArrayInfo> array_infos(const std::vector<DataArray>& arrays) {
  std::vector<ArrayInfo> infos;
  infos.reserve(arrays.size());
  for (const DataArray& array : arrays) infos.push_back(array_info(array));
  return infos;
}

nlohmann::ordered_json arrays_json(const std::vector<ArrayInfo>& arrays) {
  auto list = nlohmann::ordered_json::array();
  for (const ArrayInfo& a : arrays) {
    list.push_back({{"name", a.name}, {"components", a.components}, {"ranges", a.ranges}});
    if (a.not_finite > 0) list.back()["not_finite"] = a.not_finite;
  }
  return list;
}

std::string arrays_text(const char* where, const std::vector<ArrayInfo>& arrays) {
  std::string text;
  for (const ArrayInfo& a : arrays) {
    text += fmt::format("{} array {}: {} component{}", where, a.name, a.components, a.components == 1 ? "" : "s");
    for (const auto& [low, high] : a.ranges) text += fmt::format(", {} to {}", low, high);
    if (a.not_finite > 0) text += fmt::format(", {} values not finite", a.not_finite);
    text += '\n';
  }
  return text;
}

std::string list(const Counts& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text;
}

nlohmann::ordered_json periodic_json(const std::vector<PeriodicInfo>& periodic) {
  auto json = nlohmann::ordered_json::array();
  for (const auto& [pair, faces] : periodic) {
    json.push_back(pair_json(pair));
    json.back()["faces"] = faces;
  }
  return json;
}

}  // namespace

std::size_t MeshInfo::cell_count() const {
  std::size_t sum = 0;
  for (const auto& entry : cells) sum += entry.second;
  return sum;
}

MeshInfo mesh_info(const MeshData& mesh, std::string name, Threads threads) {
  MeshInfo info;
  info.name = std::move(name);
  info.dimension = mesh.dimension();
  info.points = mesh.points.size();
  count_cells(mesh, info);
  find_bounds(mesh.points, info);
  const MeshScale scale = mesh_scale(mesh, threads);
  if (scale.edge_count > 0) info.smallest_edge = scale.smallest_edge;
  info.mean_edge = scale.mean_edge();
  const CellComplex complex(mesh, threads);
  count_walls(complex, info);
  info.shapes = complex.map().shapes().size();
  info.simplices = complex.simplex_count();
  info.steiner_points = complex.steiner_point_count();
  info.bytes = complex.bytes();
  info.point_arrays = array_infos(mesh.point_data);
  info.cell_arrays = array_infos(mesh.cell_data);
  return info;
}

std::string info_json(const MeshInfo& i) {
  auto places = nlohmann::ordered_json::object();
  for (const auto& [name, p] : i.patch_places)
    places[name] = {{"size", p.size}, {"centre", {p.centre.x, p.centre.y, p.centre.z}}};
  nlohmann::ordered_json json = {{"name", i.name},
                                 {"dimension", i.dimension},
                                 {"points", i.points},
                                 {"cells", i.cells},
                                 {"regions", i.regions},
                                 {"patches", i.patches},
                                 {"patch_places", places},
                                 {"free_cells", i.free_cells},
                                 {"bounds", {{i.low.x, i.low.y, i.low.z}, {i.high.x, i.high.y, i.high.z}}},
                                 {"smallest_edge", i.smallest_edge},
                                 {"mean_edge", i.mean_edge},
                                 {"wall_faces", i.wall_faces},
                                 {"inner_walls", i.inner_walls},
                                 {"shapes", i.shapes},
                                 {"simplices", i.simplices},
                                 {"interior_points", i.steiner_points},
                                 {"bytes", i.bytes},
                                 {"point_arrays", arrays_json(i.point_arrays)},
                                 {"cell_arrays", arrays_json(i.cell_arrays)}};
  if (!i.periodic.empty()) json["periodic"] = periodic_json(i.periodic);
  for (const Finding& f : i.warnings)
    json["warnings"].push_back({{"kind", f.kind}, {"count", f.count}, {"message", f.message}});
  if (i.bytes > 0 && i.cell_count() > 0)
    json["bytes_per_cell"] = static_cast<double>(i.bytes) / static_cast<double>(i.cell_count());
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string info_text(const MeshInfo& i) {
  std::string out = fmt::format("{}\n{} points; {}; {} free\n", i.name, i.points, list(i.cells), i.free_cells);
  if (!i.regions.empty()) out += fmt::format("regions: {}\n", list(i.regions));
  const bool plane = i.dimension == 2;
  out += fmt::format("wall {}: {}{}{}\n", plane ? "edges" : "faces", i.wall_faces,
                     i.patches.empty() ? "" : ", by patch: ", list(i.patches));
  if (i.inner_walls > 0) out += fmt::format("inner walls: {}, each one of these from both sides\n", i.inner_walls);
  for (const auto& [pair, faces] : i.periodic) out += pair_text(pair, faces);
  for (const auto& [name, p] : i.patch_places) {
    out += fmt::format("patch {}: {} {:.6g}, centre ({:.6g}, {:.6g}, {:.6g})\n", name, plane ? "length" : "area",
                       p.size, p.centre.x, p.centre.y, p.centre.z);
  }
  out += plane ? fmt::format("bounds: ({}, {}) to ({}, {}) in the plane z = 0\n", i.low.x, i.low.y, i.high.x, i.high.y)
               : fmt::format("bounds: ({}, {}, {}) to ({}, {}, {})\n", i.low.x, i.low.y, i.low.z, i.high.x, i.high.y,
                             i.high.z);
  out += fmt::format("edges of cells: smallest {:.6g}, mean {:.6g}\n", i.smallest_edge, i.mean_edge);
  out += fmt::format("{} shapes, {} simplices, {} interior points\n", i.shapes, i.simplices, i.steiner_points);
  out += arrays_text("point", i.point_arrays) + arrays_text("cell", i.cell_arrays);
  for (const Finding& warning : i.warnings) out += fmt::format("warning: {} {}\n", warning.count, warning.message);
  const double per_cell = static_cast<double>(i.bytes) / static_cast<double>(std::max<std::size_t>(1, i.cell_count()));
  return out + fmt::format("memory: {} bytes, {:.1f} per cell\n", i.bytes, per_cell);
}

}  // namespace dartcast
