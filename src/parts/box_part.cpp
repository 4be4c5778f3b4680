// Makes one part of a generated box without the rest: its cubes, and one layer of cubes around them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "generators/box_window.hpp"
#include "mesh/faces.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast {

namespace {

using CubePlace = std::array<std::uint32_t, 3>;

// Blocks of cubes: halves along the longest side, again and again.
struct CubeBlock {
  BoxWindow window;
  std::uint32_t first = 0;  // parts [first, first + count)
  std::uint32_t count = 1;

  [[nodiscard]] std::size_t longest() const {
    const auto length = [&](std::size_t a) { return window.high[a] - window.low[a]; };
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) axis = length(a) > length(axis) ? a : axis;
    return axis;
  }
  // The half that has a part, or a cube. Each half has a cube for each of its parts.
  template <class IsLow>
  [[nodiscard]] CubeBlock half(IsLow&& is_low) const {
    const std::size_t axis = longest();
    const std::uint64_t length = window.high[axis] - window.low[axis];
    const std::uint64_t layer = window.cubes() / length;  // cubes in each
    const std::uint64_t at = std::clamp<std::uint64_t>((length * (count / 2) + count / 2) / count, 1, length - 1);
    const std::uint64_t beyond = (length - at) * layer;
    const auto low = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
        count / 2, count > beyond ? count - beyond : 1, std::min<std::uint64_t>(count - 1, at * layer)));
    const std::uint32_t cut = window.low[axis] + static_cast<std::uint32_t>(at);
    CubeBlock result = *this;
    if (is_low(axis, cut, first + low)) {
      result.window.high[axis] = cut;
      result.count = low;
    } else {
      result.window.low[axis] = cut;
      result.first += low;
      result.count -= low;
    }
    return result;
  }
};

BoxWindow window_of(const BoxOptions& o, std::uint32_t parts, std::uint32_t part) {
  CubeBlock block{{{0, 0, 0}, o.cells}, 0, parts};
  while (block.count > 1)
    block = block.half([&](std::size_t, std::uint32_t, std::uint32_t upper) { return part < upper; });
  return block.window;
}

std::uint32_t owner_of(const BoxOptions& o, std::uint32_t parts, const CubePlace& cube) {
  CubeBlock block{{{0, 0, 0}, o.cells}, 0, parts};
  while (block.count > 1)
    block = block.half([&](std::size_t axis, std::uint32_t cut, std::uint32_t) { return cube[axis] < cut; });
  return block.first;
}

// In the order in which the whole box meets its sides first.
std::vector<std::int32_t> patch_order_of(const BoxOptions& o) {
  const auto& n = o.cells;
  std::vector<std::pair<std::uint64_t, std::int32_t>> sides;
  std::uint64_t step = 1;
  for (std::int32_t a = 0; a < 3; ++a) {
    sides.emplace_back(0, 2 * a + 1);
    sides.emplace_back(step * (n[static_cast<std::size_t>(a)] - 1), 2 * a + 2);
    step *= n[static_cast<std::size_t>(a)];
  }
  std::sort(sides.begin(), sides.end());
  std::vector<std::int32_t> order;
  for (const auto& [first, tag] : sides) order.push_back(tag);
  return order;
}

// Calls visit(place) for the places of a window, x fastest.
template <class Visit>
void for_each_place(const CubePlace& low, const CubePlace& high, Visit&& visit) {
  for (std::uint32_t k = low[2]; k < high[2]; ++k) {
    for (std::uint32_t j = low[1]; j < high[1]; ++j) {
      for (std::uint32_t i = low[0]; i < high[0]; ++i) visit(CubePlace{i, j, k});
    }
  }
}

// Lattice points first, then the cubes' middles, if they are cut from these.
void number_points(const BoxOptions& o, const BoxWindow& w, MeshPart& part) {
  const CubePlace n = {o.cells[0] + 1, o.cells[1] + 1, o.cells[2] + 1};
  for_each_place(w.low, {w.high[0] + 1, w.high[1] + 1, w.high[2] + 1},
                 [&](const CubePlace& p) { part.points.push_back(p[0] + n[0] * (p[1] + n[1] * p[2])); });
  if (o.type != CellType::pyramid) return;
  const std::uint32_t lattice = n[0] * n[1] * n[2];
  for_each_place(w.low, w.high, [&](const CubePlace& c) {
    part.points.push_back(lattice + c[0] + o.cells[0] * (c[1] + o.cells[1] * c[2]));
  });
}

void number_cells(const BoxOptions& o, const BoxWindow& w, MeshPart& part) {
  const std::uint32_t each = cells_per_cube(o.type);
  const std::uint32_t pool = CombinatorialMap::pool_of(o.type);
  for_each_place(w.low, w.high, [&](const CubePlace& c) {
    const std::uint32_t cube = c[0] + o.cells[0] * (c[1] + o.cells[1] * c[2]);
    const std::uint32_t owner = owner_of(o, part.parts, c);
    for (std::uint32_t k = 0; k < each; ++k) {
      part.cells.push_back(each * cube + k);
      part.owners.push_back(owner);
      part.handles.emplace_back(pool, each * cube + k);
    }
  });
  part.mesh.source = part.cells;
}

// Those on the boundary that are on no side of the box.
void name_unknown_faces(const BoxOptions& o, MeshPart& part) {
  MeshData& mesh = part.mesh;
  const std::int32_t tag = unknown_tag_of(mesh);
  mesh.patch_order = patch_order_of(o);
  mesh.patch_order.push_back(tag);
  mesh.patch_names[tag] = unknown_patch;
  std::vector<std::vector<std::uint32_t>> sides;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) sides.push_back(sorted_corners(mesh.patch_face(f)));
  std::sort(sides.begin(), sides.end());
  const BoundaryFaces around = match_faces(mesh).boundary;
  for (std::size_t f = 0; f < around.size(); ++f) {
    if (!std::binary_search(sides.begin(), sides.end(), sorted_corners(around.face(f))))
      mesh.add_patch_face(around.face(f), tag);
  }
}

}  // namespace

bool has_parts(const BoxOptions& options) { return !options.mixed && options.blocked_share == 0.0; }

MeshPart box_part(const BoxOptions& options, std::uint32_t parts, std::uint32_t part) {
  if (!has_parts(options))
    throw InvalidArgument(
        "box_part: cubes that are mixed or blocked at random depend on all others: make the whole box");
  if (part >= parts) throw InvalidArgument(fmt::format("box_part: there is no part {} of {}", part, parts));
  const std::uint64_t cubes = std::uint64_t{options.cells[0]} * options.cells[1] * options.cells[2];
  if (cubes < parts)
    throw InvalidArgument(fmt::format("partition: {} parts of {} cubes: each part needs a cube", parts, cubes));
  BoxWindow w = window_of(options, parts, part);
  for (std::size_t a = 0; a < 3; ++a) {
    w.low[a] -= w.low[a] > 0 ? 1 : 0;
    w.high[a] += w.high[a] < options.cells[a] ? 1 : 0;
  }
  MeshPart result;
  result.part = part;
  result.parts = parts;
  result.mesh = generate_box_window(options, w);
  number_points(options, w, result);
  number_cells(options, w, result);
  name_unknown_faces(options, result);
  return result;
}

}  // namespace dartcast
