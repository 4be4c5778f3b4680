// Cells and arrays of a data set of VTK.
#include "formats/vtk/vtk_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

/// A polyhedron in VTK's way: its number of faces, then for each face its number of corners and the corners.
void add_faces(std::span<const std::int64_t> numbers, const PointRange& range, VtkGrid& grid) {
  const auto refuse = [&] {
    throw InvalidMesh(fmt::format("the faces of polyhedron {} do not fit its numbers", grid.types.size()));
  };
  if (numbers.empty()) throw InvalidMesh(fmt::format("polyhedron {} has no faces", grid.types.size()));
  std::size_t at = 1;
  for (std::int64_t f = 0; f < numbers[0]; ++f) {
    if (at >= numbers.size()) refuse();
    const std::int64_t n = numbers[at++];
    if (n < 0 || n > static_cast<std::int64_t>(numbers.size() - at)) refuse();
    grid.connectivity.push_back(static_cast<std::uint32_t>(n));
    for (const std::int64_t id : numbers.subspan(at, static_cast<std::size_t>(n)))
      grid.connectivity.push_back(range.point(id));
    at += static_cast<std::size_t>(n);
  }
  if (numbers[0] < 0 || at != numbers.size()) refuse();
}

/// Calls visit(point) for each point in the connectivity of a grid.
template <class Visit>
void for_each_point(VtkGrid& grid, Visit&& visit) {
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    const auto ids = std::span(grid.connectivity).subspan(grid.offsets[c], grid.offsets[c + 1] - grid.offsets[c]);
    if (grid.types[c] != vtk_polyhedron) {
      for (std::uint32_t& id : ids) visit(id);
      continue;
    }
    for (std::size_t at = 1; at < ids.size(); at += ids[at] + 1) {
      for (std::uint32_t& id : ids.subspan(at + 1, ids[at])) visit(id);
    }
  }
}

void add_items(std::vector<VtkArray>&& from, std::vector<VtkArray>& to) {
  const auto same = [](const VtkArray& a, const VtkArray& b) {
    return a.name == b.name && a.components == b.components && a.is_text == b.is_text;
  };
  if (!std::equal(from.begin(), from.end(), to.begin(), to.end(), same))
    throw InvalidMesh("it has other arrays than the pieces before it, or in another order");
  for (std::size_t a = 0; a < to.size(); ++a) {
    to[a].values.insert(to[a].values.end(), from[a].values.begin(), from[a].values.end());
    to[a].texts.insert(to[a].texts.end(), from[a].texts.begin(), from[a].texts.end());
  }
}

/// The bits of a place, for an order of all points: 0 and -0 are one.
std::array<std::uint64_t, 3> bits_of(const Vec3& x) {
  return {std::bit_cast<std::uint64_t>(x.x + 0.0), std::bit_cast<std::uint64_t>(x.y + 0.0),
          std::bit_cast<std::uint64_t>(x.z + 0.0)};
}

}  // namespace

void add_pieces(VtkGrid&& from, VtkGrid& to) {
  if (from.points.empty()) return;
  if (to.points.empty()) {
    to = std::move(from);
    return;
  }
  const std::size_t first = to.points.size();
  if (first + from.points.size() >= no_point) throw InvalidMesh("more than 2^32 - 2 points");
  add_items(std::move(from.point_data), to.point_data);
  add_items(std::move(from.cell_data), to.cell_data);
  for_each_point(from, [&](std::uint32_t& id) { id = id == no_point ? id : static_cast<std::uint32_t>(first + id); });
  for (const std::size_t piece : from.pieces) to.pieces.push_back(first + piece);
  for (std::size_t c = 0; c < from.types.size(); ++c)
    to.offsets.push_back(to.connectivity.size() + from.offsets[c + 1]);
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  to.types.insert(to.types.end(), from.types.begin(), from.types.end());
  to.connectivity.insert(to.connectivity.end(), from.connectivity.begin(), from.connectivity.end());
}

void join_pieces(VtkGrid& grid) {
  if (grid.pieces.size() < 2) return;
  const std::size_t n = grid.points.size();
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::array<std::uint64_t, 3>> places;
  places.reserve(n);
  for (const Vec3& x : grid.points) places.push_back(bits_of(x));
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::tie(places[a], a) < std::tie(places[b], b); });
  const auto piece_of = [&](std::uint32_t p) {
    return std::upper_bound(grid.pieces.begin(), grid.pieces.end(), p) - grid.pieces.begin();
  };
  std::vector<std::uint32_t> number(n);  // first the point that each becomes
  for (std::size_t i = 0, first = 0; i < n; ++i) {
    if (places[order[i]] != places[order[first]]) first = i;
    const bool joins = i > first && piece_of(order[i]) != piece_of(order[first]);
    number[order[i]] = joins ? order[first] : order[i];
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t p = 0; p < n; ++p) {
    if (number[p] != p) {
      number[p] = number[number[p]];  // a lower one, which has its number
      continue;
    }
    number[p] = static_cast<std::uint32_t>(kept.size());
    grid.points[kept.size()] = grid.points[p];
    kept.push_back(p);
  }
  grid.points.resize(kept.size());
  for (VtkArray& a : grid.point_data) a.take_rows(kept);
  for_each_point(grid, [&](std::uint32_t& id) { id = id == no_point ? id : number[id]; });
}

void VtkArray::take_rows(std::span<const std::uint32_t> rows) {
  if (rows.size() == items()) return;
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(rows[i] * components), components,
                values.begin() + static_cast<std::ptrdiff_t>(i * components));
  values.resize(rows.size() * components);
}

const VtkArray* find_array(const std::vector<VtkArray>& arrays, std::string_view name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const VtkArray& a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

void add_cell(std::uint8_t type, std::span<const std::int64_t> ids, const PointRange& range, VtkGrid& grid) {
  if (type == vtk_polyhedron) {
    if (!ids.empty()) grid.connectivity.push_back(static_cast<std::uint32_t>(ids[0]));
    add_faces(ids, range, grid);
  } else {
    for (const std::int64_t id : ids) grid.connectivity.push_back(range.point(id));
  }
  grid.types.push_back(type);
  grid.offsets.push_back(grid.connectivity.size());
}

}  // namespace dartcast
