// Gmsh: each shell of the surfaces is a discrete surface of a .msh file; a script adds the box and names the volumes
// between shells. Points come back with all bits in a binary .msh file, in an order of Gmsh's own.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/gmsh.hpp"
#include "meshing/run_program.hpp"
#include "meshing/tetrahedra.hpp"

namespace dartcast {
namespace {

/// The connected parts of all surfaces: per triangle a number from 0.
std::vector<std::size_t> shells_of(const ClosedSurfaces& surfaces, std::size_t& count) {
  std::vector<std::uint32_t> parent(surfaces.points.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const TriangleCorners& t : surfaces.triangles) {
    parent[root(t[0])] = root(t[1]);
    parent[root(t[1])] = root(t[2]);
  }
  std::map<std::uint32_t, std::size_t> number;
  std::vector<std::size_t> shell;
  for (const TriangleCorners& t : surfaces.triangles)
    shell.push_back(number.try_emplace(root(t[0]), number.size()).first->second);
  count = number.size();
  return shell;
}

/// How often each shell goes around the point: 1 or -1 inside it, 0 outside. Rounded: it only says where Gmsh should
/// make volumes, and the result is checked.
std::vector<long> turns_around(const ClosedSurfaces& surfaces, const std::vector<std::size_t>& shell, std::size_t count,
                               const Vec3& x) {
  std::vector<double> angle(count, 0.0);
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t) {
    const auto& corners = surfaces.triangles[t];
    const Vec3 a = surfaces.points[corners[0]] - x, b = surfaces.points[corners[1]] - x,
               c = surfaces.points[corners[2]] - x;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    angle[shell[t]] += 2.0 * polar_angle(dot(cross(a, b), c), below);
  }
  std::vector<long> turns;
  for (const double full : angle) turns.push_back(std::lround(full / (4.0 * 3.141592653589793)));
  return turns;
}

std::string msh_of(const ClosedSurfaces& surfaces, const std::vector<std::size_t>& shell) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", surfaces.points.size());
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < surfaces.points.size(); ++i) {
    const Vec3& p = surfaces.points[i];
    fmt::format_to(out, "{} {:.17g} {:.17g} {:.17g}\n", i + 1, p.x, p.y, p.z);
  }
  fmt::format_to(out, "$EndNodes\n$Elements\n{}\n", surfaces.triangles.size());
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t) {
    const auto& c = surfaces.triangles[t];
    fmt::format_to(out, "{} 2 2 {} {} {} {} {}\n", t + 1, shell[t] + 1, shell[t] + 1, c[0] + 1, c[1] + 1, c[2] + 1);
  }
  return text + "$EndElements\n";
}

/// The shells directly inside each shell, and last those directly inside the box.
std::vector<std::vector<std::size_t>> nesting(const ClosedSurfaces& surfaces, const std::vector<std::size_t>& shell,
                                              std::size_t count) {
  std::vector<std::vector<std::size_t>> around(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto first = std::find(shell.begin(), shell.end(), k) - shell.begin();
    const Vec3& point = surfaces.points[surfaces.triangles[static_cast<std::size_t>(first)][0]];
    const std::vector<long> turns = turns_around(surfaces, shell, count, point);
    for (std::size_t other = 0; other < count; ++other) {
      if (other != k && turns[other] != 0) around[k].push_back(other);
    }
  }
  std::vector<std::vector<std::size_t>> inside(count + 1);
  for (std::size_t k = 0; k < count; ++k) {
    // The innermost shell around k is the one with the most shells around itself.
    const auto innermost = std::max_element(around[k].begin(), around[k].end(), [&](std::size_t a, std::size_t b) {
      return around[a].size() < around[b].size();
    });
    inside[innermost == around[k].end() ? count : *innermost].push_back(k);
  }
  return inside;
}

std::string geo_of(const ClosedSurfaces& surfaces, const SurfaceScene& scene, const std::vector<std::size_t>& shell,
                   std::size_t count) {
  const OuterBox box = outer_box(surfaces, scene.box);
  const double coarse = scene.size > 0.0 ? scene.size : norm(box.high - box.low) / 10.0;
  std::string text = "Merge \"scene.msh\";\nMesh.SaveAll = 1;\n";
  const auto out = std::back_inserter(text);
  if (scene.size > 0.0) fmt::format_to(out, "Mesh.CharacteristicLengthMax = {:.17g};\n", scene.size);
  for (std::size_t k = 0; k < count; ++k) fmt::format_to(out, "Surface Loop({0}) = {{{0}}};\n", k + 1);
  const std::size_t n = count + 1;  // names of the box's parts begin here
  for (std::size_t i = 0; i < 8; ++i) {
    const bool x = i % 4 == 1 || i % 4 == 2, y = i % 4 >= 2, z = i >= 4;
    fmt::format_to(out, "Point({}) = {{{:.17g}, {:.17g}, {:.17g}, {:.17g}}};\n", surfaces.points.size() + 1 + i,
                   x ? box.high.x : box.low.x, y ? box.high.y : box.low.y, z ? box.high.z : box.low.z, coarse);
  }
  static constexpr std::array<std::array<int, 2>, 12> lines = {
      {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
  static constexpr std::array<std::array<int, 4>, 6> sides = {
      {{1, 2, 3, 4}, {5, 6, 7, 8}, {1, 10, -5, -9}, {2, 11, -6, -10}, {3, 12, -7, -11}, {4, 9, -8, -12}}};
  for (std::size_t i = 0; i < lines.size(); ++i)
    fmt::format_to(out, "Line({}) = {{{}, {}}};\n", i + 1, surfaces.points.size() + 1 + lines[i][0],
                   surfaces.points.size() + 1 + lines[i][1]);
  std::string loop;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto& s = sides[i];
    fmt::format_to(out, "Curve Loop({0}) = {{{1}, {2}, {3}, {4}}};\nPlane Surface({0}) = {{{0}}};\n", n + i, s[0], s[1],
                   s[2], s[3]);
    loop += fmt::format("{}{}", i == 0 ? "" : ", ", n + i);
  }
  fmt::format_to(out, "Surface Loop({}) = {{{}}};\n", n, loop);
  const auto inside = nesting(surfaces, shell, count);
  for (std::size_t k = 0; k <= count; ++k) {
    fmt::format_to(out, "Volume({0}) = {{{0}", k + 1);
    for (const std::size_t hole : inside[k]) fmt::format_to(out, ", {}", hole + 1);
    text += "};\n";
  }
  return text;
}

/// The same tetrahedra with the surface's points first, in their order.
Tetrahedra in_order(const MeshData& mesh, const ClosedSurfaces& surfaces) {
  const auto key = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  Tetrahedra result;
  result.points = surfaces.points;
  for (std::uint32_t i = 0; i < surfaces.points.size(); ++i) known[key(surfaces.points[i])] = i;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    std::array<std::uint32_t, 4> cell{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& p = mesh.points.at(mesh.cell(c)[k]);
      const auto [at, added] = known.try_emplace(key(p), static_cast<std::uint32_t>(result.points.size()));
      if (added) result.points.push_back(p);
      cell[k] = at->second;
    }
    result.cells.push_back(cell);
  }
  return result;
}

}  // namespace

Tetrahedra run_gmsh(const ClosedSurfaces& surfaces, const SurfaceScene& scene, std::uint64_t memory) {
  const TemporaryFolder folder;
  std::size_t count = 0;
  const std::vector<std::size_t> shell = shells_of(surfaces, count);
  write_bytes(folder.path() / "scene.msh", msh_of(surfaces, shell));
  write_bytes(folder.path() / "scene.geo", geo_of(surfaces, scene, shell, count));
  const ProgramEnd end =
      run_program({"gmsh", "-3", "scene.geo", "-o", "made.msh", "-format", "msh22", "-bin", "-nt", "1"}, folder,
                  scene.seconds, memory);
  if (!end.found) throw Error("gmsh is not installed: install the package gmsh");
  if (!end.in_time) throw Error(fmt::format("gmsh took more than {} s", scene.seconds));
  if (end.status != 0) throw Error(fmt::format("gmsh failed with status {}: {}", end.status, end.last_words));
  const MeshData mesh = parse_gmsh(read_bytes(folder.path() / "made.msh")).mesh;
  if (mesh.types.empty() ||
      std::any_of(mesh.types.begin(), mesh.types.end(), [](CellType type) { return type != CellType::tetrahedron; }))
    throw Error("gmsh has made no tetrahedra");
  return in_order(mesh, surfaces);
}

}  // namespace dartcast
