// Boxes whose sides are periodic, and the same boxes many times over, side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

/// Points, as multiples of 2^-30, move by up to a 32nd of a cube. Those of opposite sides move alike, so a side is bumpy.
inline void shake(MeshData& mesh, const std::array<std::uint32_t, 3>& cubes, std::uint64_t seed) {
  std::map<std::tuple<double, double, double>, Vec3> moves;
  Random random(seed);
  for (Vec3& x : mesh.points) {
    const auto in_first = [](double at, std::uint32_t n) { return at == n ? 0.0 : at; };
    const std::tuple place{in_first(x.x, cubes[0]), in_first(x.y, cubes[1]), in_first(x.z, cubes[2])};
    const auto part = [&] { return (random.below(1U << 11U) - 1024.0) * 0x1p-15; };
    const auto [move, added] = moves.try_emplace(place);
    if (added) move->second = {part(), part(), part()};
    x += move->second;
  }
}

/// A box of cubes of edge 1 whose opposite sides are pairs, along the first so many axes.
inline MeshData periodic_box(const BoxOptions& options, unsigned axes) {
  MeshData mesh = generate_box(options);
  const std::array<const char*, 3> names = {"x", "y", "z"};
  for (unsigned a = 0; a < axes; ++a) {
    const double length = options.cells[a];
    const Vec3 along = a == 0 ? Vec3{length, 0.0, 0.0} : a == 1 ? Vec3{0.0, length, 0.0} : Vec3{0.0, 0.0, length};
    mesh.periodic.push_back({std::string(names[a]) + "max", std::string(names[a]) + "min", -along});
  }
  return mesh;
}

/// The mesh many times over: copy (i, j, k) is moved by (i, j, k) times `size`, each from low to high. Its cells follow one
/// another, copy by copy, x fastest. Faces between copies are in no patch.
inline MeshData repeated(const MeshData& mesh, const Vec3& size, const std::array<int, 3>& low,
                         const std::array<int, 3>& high) {
  MeshData all;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        std::vector<std::uint32_t> number;
        for (const Vec3& x : mesh.points) {
          const Vec3 at = x + Vec3{i * size.x, j * size.y, k * size.z};
          const auto [entry, added] =
              known.try_emplace({at.x, at.y, at.z}, static_cast<std::uint32_t>(all.points.size()));
          if (added) all.points.push_back(at);
          number.push_back(entry->second);
        }
        for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
          std::vector<std::uint32_t> corners;
          for (const std::uint32_t v : mesh.cell(c)) corners.push_back(number[v]);
          all.add_cell(mesh.types[c], corners);
        }
        all.free.insert(all.free.end(), mesh.free.begin(), mesh.free.end());
      }
    }
  }
  return all;
}

}  // namespace dartcast::test
