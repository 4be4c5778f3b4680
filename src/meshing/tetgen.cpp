// TetGen: the surfaces and the box go into a .smesh file, and Medit's .mesh comes back.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/medit.hpp"
#include "meshing/run_program.hpp"
#include "meshing/tetrahedra.hpp"

namespace dartcast {
namespace {

std::array<Vec3, 8> corners_of(const OuterBox& box) {
  const Vec3 &a = box.low, &b = box.high;
  return {{{a.x, a.y, a.z},
           {b.x, a.y, a.z},
           {b.x, b.y, a.z},
           {a.x, b.y, a.z},
           {a.x, a.y, b.z},
           {b.x, a.y, b.z},
           {b.x, b.y, b.z},
           {a.x, b.y, b.z}}};
}

std::string smesh_of(const ClosedSurfaces& surfaces, const OuterBox& box) {
  static constexpr std::array<std::array<int, 4>, 6> sides = {
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  const std::size_t n = surfaces.points.size();
  std::string text = fmt::format("{} 3 0 0\n", n + 8);
  const auto out = std::back_inserter(text);
  std::size_t i = 0;
  const auto add = [&](const Vec3& p) { fmt::format_to(out, "{} {:.17g} {:.17g} {:.17g}\n", i++, p.x, p.y, p.z); };
  for (const Vec3& p : surfaces.points) add(p);
  for (const Vec3& p : corners_of(box)) add(p);
  fmt::format_to(out, "{} 0\n", surfaces.triangles.size() + sides.size());
  for (const TriangleCorners& t : surfaces.triangles) fmt::format_to(out, "3 {} {} {}\n", t[0], t[1], t[2]);
  for (const auto& s : sides) fmt::format_to(out, "4 {} {} {} {}\n", n + s[0], n + s[1], n + s[2], n + s[3]);
  return text + "0\n0\n";
}

Tetrahedra read_result(const std::filesystem::path& file, const ClosedSurfaces& surfaces) {
  const MeshData mesh = parse_medit(read_bytes(file)).mesh;
  Tetrahedra result;
  result.points = mesh.points;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto corners = mesh.cell(c);
    if (mesh.types[c] != CellType::tetrahedron) throw Error("tetgen has made other cells than tetrahedra");
    result.cells.push_back({corners[0], corners[1], corners[2], corners[3]});
  }
  const bool kept = result.points.size() >= surfaces.points.size() &&
                    std::equal(surfaces.points.begin(), surfaces.points.end(), result.points.begin());
  if (!kept) throw Error("tetgen has moved points of the surface");
  return result;
}

}  // namespace

OuterBox outer_box(const ClosedSurfaces& surfaces, double factor) {
  OuterBox box{surfaces.points.front(), surfaces.points.front()};
  const auto widen = [](double& low, double& high, double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  };
  for (const Vec3& p : surfaces.points) {
    widen(box.low.x, box.high.x, p.x);
    widen(box.low.y, box.high.y, p.y);
    widen(box.low.z, box.high.z, p.z);
  }
  const Vec3 margin = (box.high - box.low) * (0.5 * (factor - 1.0));
  const OuterBox outer = {box.low - margin, box.high + margin};
  const bool around = outer.low.x < box.low.x && outer.low.y < box.low.y && outer.low.z < box.low.z &&
                      outer.high.x > box.high.x && outer.high.y > box.high.y && outer.high.z > box.high.z;
  if (!around) throw Error("the box is too close to the surface for doubles: give a larger one");
  return outer;
}

// TetGen 1.5 ends with failed assertions on some surfaces, most of all on symmetric ones. So there are three tries. The
// first asks for well shaped tetrahedra. The second takes any, for surfaces with triangles nearly in one plane. The
// third moves the sides of the box outwards by less than a hundredth, each by another length. Then no sphere through
// corners of the box is symmetric.
Tetrahedra run_tetgen(const ClosedSurfaces& surfaces, const SurfaceScene& scene, std::uint64_t memory) {
  const TemporaryFolder folder;
  const OuterBox box = outer_box(surfaces, scene.box);
  const Vec3 size = box.high - box.low;
  const OuterBox uneven = {box.low - Vec3{0.0011 * size.x, 0.0017 * size.y, 0.0023 * size.z},
                           box.high + Vec3{0.0031 * size.x, 0.0037 * size.y, 0.0041 * size.z}};
  // The volume of a regular tetrahedron with edges of this length.
  const double largest = 0.11785 * scene.size * scene.size * scene.size;
  const std::string volume = scene.size > 0.0 ? fmt::format("a{:.17g}", largest) : "";
  struct Attempt {
    std::string flags;
    const OuterBox& box;
  };
  std::string reason;
  for (const Attempt& attempt : {Attempt{"-pYMgQq1.4", box}, Attempt{"-pYMgQ", box}, Attempt{"-pYMgQ", uneven}}) {
    write_bytes(folder.path() / "scene.smesh", smesh_of(surfaces, attempt.box));
    const ProgramEnd end =
        run_program({"tetgen", attempt.flags + volume, "scene.smesh"}, folder, scene.seconds, memory);
    if (!end.found) throw Error("tetgen is not installed: install the package tetgen");
    if (end.well()) return read_result(folder.path() / "scene.1.mesh", surfaces);
    if (!end.in_time) throw Error(fmt::format("tetgen took more than {} s", scene.seconds));
    reason = fmt::format("tetgen failed with status {}: {}", end.status, end.last_words);
  }
  throw Error(reason);
}

}  // namespace dartcast
