// Reads surfaces to mesh around. First each file by itself: triangles, orientation, caps, holes, patches. Then all of
// them together: no two triangles may cross or touch.
#include "meshing/closed_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "formats/checked_file.hpp"
#include "formats/parsed_surface.hpp"
#include "formats/read_memory.hpp"
#include "meshing/holes.hpp"
#include "meshing/mend_crossings.hpp"
#include "surface/check_surface.hpp"
#include "surface/ears.hpp"

namespace dartcast {
namespace {

/// The pairs of triangles that are looked for at most.
constexpr std::size_t most_pairs = 10000;

/// The same surface in triangles, each with its face's number in the file; none if a face names no point.
MeshData in_triangles(MeshData mesh) {
  const auto known = [&](std::uint32_t p) { return p < mesh.points.size(); };
  if (!std::all_of(mesh.connectivity.begin(), mesh.connectivity.end(), known)) return mesh;
  MeshData out;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for (const TriangleCorners& t : ears(mesh.points, mesh.cell(c))) {
      out.add_cell(CellType::triangle, t);
      out.source.push_back(static_cast<std::uint32_t>(c));
      if (!mesh.regions.empty()) out.regions.push_back(mesh.regions[c]);
    }
  }
  out.points = std::move(mesh.points);
  out.region_names = std::move(mesh.region_names);
  return out;
}

/// Points at one place become one if that is asked for: .stl has no numbers, other formats mean what they say.
MeshFile read_one(const std::filesystem::path& file, const SurfaceScene& scene, const ReadOptions& options) {
  return checked_file(file, "surface", [&](MeshFile& out) {
    ParsedSurface parsed = parse_surface(file, options.max_memory);
    check_memory(memory_of_mesh(parsed.mesh), options.max_memory);
    out.mesh = in_triangles(std::move(parsed.mesh));
    out.report = check_and_repair_surface(out.mesh);
    out.report.repairs.insert(out.report.repairs.begin(), parsed.repairs.begin(), parsed.repairs.end());
    out.report.warnings.insert(out.report.warnings.end(), parsed.warnings.begin(), parsed.warnings.end());
    std::erase_if(out.report.warnings, [](const Finding& w) { return w.kind == "open_border"; });
    if (!out.report.valid()) return;
    if (scene.repair) join_borders(out.mesh, out.report);
    if (scene.cap) close_holes(out.mesh, out.report, scene.cap_tolerance);
    if (scene.repair && out.report.valid() && holes_of(out.mesh).empty()) mend_crossings(out.mesh, out.report);
    if (out.report.valid()) add_finding(out.report.defects, open_holes(out.mesh));
  });
}

/// Divides triangles at edges if their normals differ by more than an angle. The part of each, in the order of its
/// first triangle.
std::vector<std::uint32_t> smooth_parts(const MeshData& mesh, double degrees) {
  const std::size_t n = mesh.cell_count();
  std::vector<Vec3> normals;
  for (std::size_t c = 0; c < n; ++c) {
    const Vec3 area = vector_area(mesh.points, mesh.cell(c));
    const double length = norm(area);
    normals.push_back(length > 0.0 ? area * (1.0 / length) : Vec3{});
  }
  std::vector<std::uint32_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const double least = sine_cosine_of_turns(degrees / 360.0).cosine;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
  for (std::uint32_t c = 0; c < n; ++c) {
    const auto t = mesh.cell(c);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
      const auto [at, added] = first.try_emplace({edge.first, edge.second}, c);
      if (added || dot(normals[c], normals[at->second]) < least) continue;
      const std::uint32_t a = root(c), b = root(at->second);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::uint32_t c = 0; c < n; ++c) parent[c] = root(c);
  return parent;
}

class Collector {
 public:
  explicit Collector(const SurfaceScene& scene) : scene_(scene) {}

  void add(std::size_t number, MeshFile file) {
    MeshReport& report = out_.report;
    const std::string name = scene_.surfaces.size() > 1 ? file.report.file + ": " : "";
    const auto take = [&](std::vector<Finding>& to, std::vector<Finding>& from) {
      for (Finding& f : from) {
        f.message = name + f.message;
        to.push_back(std::move(f));
      }
    };
    take(report.repairs, file.report.repairs);
    take(report.warnings, file.report.warnings);
    take(report.defects, file.report.defects);
    if (has_triangles()) add_triangles(number, file.mesh);
  }

  ClosedSurfaces finish() {
    if (has_triangles()) add_finding(out_.report.defects, crossings());
    return std::move(out_);
  }

 private:
  // A surface with holes is one of triangles all the same: its crossings are worth knowing.
  [[nodiscard]] bool has_triangles() const {
    return std::all_of(out_.report.defects.begin(), out_.report.defects.end(),
                       [](const Finding& d) { return d.kind == "open" || d.kind == "cap"; });
  }

  void add_triangles(std::size_t number, const MeshData& mesh) {
    std::vector<std::uint32_t> place(mesh.points.size(), unused);
    for (const std::uint32_t p : mesh.connectivity) place[p] = 0;
    for (std::size_t p = 0; p < place.size(); ++p) {
      if (place[p] == unused) continue;
      place[p] = static_cast<std::uint32_t>(out_.points.size());
      out_.points.push_back(mesh.points[p]);
    }
    const std::vector<std::int32_t> patches = patches_of(number, mesh);
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      const auto t = mesh.cell(c);
      out_.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
      out_.surface.push_back(static_cast<std::uint32_t>(number));
      out_.source.push_back(mesh.source[c]);
      out_.patch.push_back(patches[c]);
    }
  }

  // The groups of the file and caps; the other triangles by where they are sharp.
  std::vector<std::int32_t> patches_of(std::size_t number, const MeshData& mesh) {
    const std::string prefix = scene_.surfaces.size() > 1 ? scene_.surfaces[number].region + "_" : "";
    std::map<std::string, std::int32_t> tags;
    const auto tag_of = [&](const std::string& name) {
      const auto [at, added] = tags.try_emplace(name, next_tag_);
      if (added) out_.patch_names[next_tag_++] = prefix + name;
      return at->second;
    };
    const std::vector<std::uint32_t> part = smooth_parts(mesh, scene_.angle);
    const auto grouped = [&](std::size_t c) { return !mesh.regions.empty() && mesh.regions[c] != 0; };
    std::map<std::uint32_t, std::size_t> parts;
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      if (!grouped(c)) parts.try_emplace(part[c], parts.size() + 1);
    }
    std::vector<std::int32_t> patches;
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      if (grouped(c)) {
        const auto name = mesh.region_names.find(mesh.regions[c]);
        patches.push_back(tag_of(name == mesh.region_names.end() ? std::to_string(mesh.regions[c]) : name->second));
      } else {
        patches.push_back(tag_of(parts.size() == 1 ? "wall" : fmt::format("wall_{}", parts.at(part[c]))));
      }
    }
    return patches;
  }

  [[nodiscard]] std::string named(std::uint32_t t) const {
    const std::string face = fmt::format("face {}", out_.source[t]);
    return scene_.surfaces.size() == 1 ? face
                                       : fmt::format("{} of {}", face, scene_.surfaces[out_.surface[t]].file.string());
  }

  [[nodiscard]] Finding crossings() const {
    const auto pairs = crossing_pairs(out_.points, out_.triangles, most_pairs);
    Finding finding{"self_intersection", 0, {}, ""};
    if (pairs.empty()) return finding;
    for (const auto& [a, b] : pairs) finding.add(out_.source[a]);
    const auto& [a, b] = pairs.front();
    Vec3 centre;
    for (const std::uint32_t p : out_.triangles[a]) centre += out_.points[p] * (1.0 / 3.0);
    finding.message = fmt::format(
        "pairs of triangles that cross or touch{}, the first one of {} and {}, around ({:.4g}, {:.4g}, {:.4g}); {}mend "
        "the surface in a program such as MeshLab",
        pairs.size() == most_pairs ? ", or more" : "", named(a), named(b), centre.x, centre.y, centre.z,
        scene_.repair ? "--repair (repair = true) does not help: " : "try --repair (repair = true), or ");
    return finding;
  }

  static constexpr std::uint32_t unused = 0xffffffffU;

  const SurfaceScene& scene_;
  ClosedSurfaces out_;
  std::int32_t next_tag_ = 1;
};

}  // namespace

ClosedSurfaces read_closed_surfaces(const SurfaceScene& scene, const ReadOptions& options) {
  Collector collector(scene);
  for (std::size_t s = 0; s < scene.surfaces.size(); ++s)
    collector.add(s, read_one(scene.surfaces[s].file, scene, options));
  return collector.finish();
}

}  // namespace dartcast
