// From closed surfaces to a mesh with regions: read and check, let a program make tetrahedra, check what it has made.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "formats/checked_file.hpp"
#include "formats/read_memory.hpp"
#include "meshing/closed_surfaces.hpp"
#include "meshing/tetrahedra.hpp"

namespace dartcast {
namespace {

void check_range(const SurfaceScene& scene) {
  const auto require = [](bool holds, std::string_view text) {
    if (!holds) throw InvalidArgument(fmt::format("surfaces: {}", text));
  };
  require(!scene.surfaces.empty(), "name at least one");
  require(std::isfinite(scene.box) && scene.box > 1.0, "box must be more than 1");
  require(std::isfinite(scene.size) && scene.size >= 0.0, "size must be 0 or more");
  require(std::isfinite(scene.cap_tolerance) && scene.cap_tolerance >= 0.0, "cap_tolerance must be 0 or more");
  require(scene.angle > 0.0 && scene.angle <= 180.0, "angle must be more than 0 and at most 180 degrees");
  require(scene.seconds > 0.0, "seconds must be more than 0");
  for (const NamedSurface& s : scene.surfaces) {
    require(!s.region.empty(), "each needs a region");
    require(s.region != scene.outside, fmt::format("the region {} is that outside", s.region));
  }
}

Tetrahedra run_mesher(const ClosedSurfaces& surfaces, const SurfaceScene& scene, const ReadOptions& options,
                      std::string& format) {
  const std::uint64_t memory = allowed_memory(options.max_memory);
  format = "tetrahedra by tetgen";
  if (scene.mesher != Mesher::gmsh) enter_stage(options, "tetgen fills the surface");
  if (scene.mesher == Mesher::tetgen) return run_tetgen(surfaces, scene, memory);
  std::string reason;
  if (scene.mesher == Mesher::any) {
    try {
      return run_tetgen(surfaces, scene, memory);
    } catch (const Error& e) {
      reason = e.what();
    }
  }
  format = "tetrahedra by gmsh";
  enter_stage(options, "gmsh fills the surface");
  try {
    return run_gmsh(surfaces, scene, memory);
  } catch (const Error& e) {
    throw Error(reason.empty() ? e.what() : fmt::format("{}; {}", reason, e.what()));
  }
}

}  // namespace

MeshFile mesh_surfaces(const SurfaceScene& scene, const ReadOptions& options) {
  check_range(scene);
  enter_stage(options, "checking the surface");
  ClosedSurfaces surfaces = read_closed_surfaces(scene, options);
  MeshFile out{{}, std::move(surfaces.report)};
  out.report.file = scene.surfaces.front().file.string();
  if (!out.report.valid()) return out;
  try {
    std::string format;
    Tetrahedra made = run_mesher(surfaces, scene, options, format);
    enter_stage(options, "checking the tetrahedra");
    out.mesh = mesh_with_regions(surfaces, scene, std::move(made));
    const std::vector<Finding> repairs = std::move(out.report.repairs);
    const std::vector<Finding> warnings = std::move(out.report.warnings);
    out.report = check_and_repair(out.mesh);
    out.report.repairs.insert(out.report.repairs.begin(), repairs.begin(), repairs.end());
    out.report.warnings.insert(out.report.warnings.begin(), warnings.begin(), warnings.end());
    out.report.format = format;
    out.report.file = scene.surfaces.front().file.string();
  } catch (const Error& e) {
    out.report.defects.push_back({"mesher", 1, {}, e.what()});
  }
  return out;
}

}  // namespace dartcast
