#include "dartcast/map/map.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>

#include "dartcast/base/error.hpp"

namespace dartcast {

Dart Map::phi3(Dart d) const {
  const CellView c = view(d.cell);
  const std::uint16_t f = c.shape().face_of(d.number);
  const Cell other = c.neighbour(f);
  if (!other.valid()) return {};
  // Both sides number a face's darts from its lowest vertex, one forwards, one backwards.
  const int place = d.number - c.shape().first_dart(f);
  const int first = shape(other).first_dart(c.neighbour_face(f));
  return {other, static_cast<std::uint16_t>(first + c.shape().degree(f) - 1 - place)};
}

CellFace Map::opposite(CellFace f) const {
  const CellView c = view(f.cell);
  const Cell other = c.neighbour(f.face);
  return other.valid() ? CellFace{other, c.neighbour_face(f.face)} : CellFace{};
}

CellType Map::type(Cell c) const { return static_cast<CellType>(c.pool()); }

std::size_t Map::cell_count() const {
  return std::accumulate(pools_.begin(), pools_.end(), std::size_t{0},
                         [](std::size_t sum, const Pool& pool) { return sum + pool.count; });
}

std::uint32_t Map::source(Cell c) const {
  const auto& source = pools_[c.pool()].source;
  return source.empty() ? c.index() : source[c.index()];
}

std::vector<Cell> Map::cells() const {
  std::vector<Cell> all;
  all.reserve(cell_count());
  for (std::uint32_t p = 0; p < pools_.size(); ++p) {
    for (std::uint32_t i = 0; i < pools_[p].count; ++i) all.emplace_back(p, i);
  }
  return all;
}

void Map::set_neighbour(CellFace f, CellFace other) {
  std::uint32_t* word = record(f.cell);
  const Shape& s = shape(f.cell);
  word[2U + s.point_count() + f.face] = other.cell.value;
  if (!other.valid()) return;
  if (f.cell.pool() == general_pool) {
    std::uint32_t& extra = word[2U + s.point_count() + s.face_count() + f.face];
    extra = (extra & 0xffff0000U) | other.face;
  } else {
    word[1] = (word[1] & ~(7U << (3U * f.face))) | (std::uint32_t{other.face} << (3U * f.face));
  }
}

void Map::set_wall(CellFace f, bool wall) {
  std::uint32_t* word = record(f.cell);
  const Shape& s = shape(f.cell);
  const bool general = f.cell.pool() == general_pool;
  std::uint32_t& mask = general ? word[2U + s.point_count() + s.face_count() + f.face] : word[1];
  const std::uint32_t bit = 1U << (general ? 16U : 18U + f.face);
  mask = wall ? mask | bit : mask & ~bit;
}

void Map::mark_walls(Cell c) {
  const CellView v = view(c);
  for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
    const CellFace other = opposite({c, f});
    const bool wall = !other.valid() || is_free(other.cell) != v.is_free();
    set_wall({c, f}, wall);
    if (other.valid()) set_wall(other, wall);
    if (wall) mark_wall_vertices(v, f);
  }
}

void Map::mark_wall_vertices(const CellView& cell, std::uint16_t face) {
  for (std::uint16_t t = 0; t < cell.shape().triangle_count(face); ++t) {
    for (const std::uint16_t corner : cell.shape().triangle(face, t)) {
      const std::uint32_t v = cell.vertex(corner).value;
      wall_vertices_[v / 64U] |= std::uint64_t{1} << (v % 64U);
    }
  }
}

void Map::set_free(Cell c, bool free) {
  const std::uint32_t bit = 1U << (c.pool() == general_pool ? 16U : 24U);
  std::uint32_t& flags = record(c)[1];
  flags = free ? flags | bit : flags & ~bit;
  mark_walls(c);
}

Patch Map::patch(CellFace f) const {
  if (patches_.empty()) return {};
  // Bisection without branches: where it goes can't be foretold.
  const auto key = [](const CellFace& g) { return (std::uint64_t{g.cell.value} << 16U) | g.face; };
  const auto* entry = patches_.data();
  for (std::size_t count = patches_.size(); count > 1;) {
    const std::size_t half = count / 2;
    entry += key(entry[half].first) <= key(f) ? half : 0;
    count -= half;
  }
  return entry->first == f ? entry->second : Patch{};
}

Patch Map::patch(std::string_view name) const {
  const auto found = std::find(patch_names_.begin(), patch_names_.end(), name);
  if (found != patch_names_.end()) return Patch{static_cast<std::uint16_t>(found - patch_names_.begin())};
  std::string known;
  for (std::size_t i = 1; i < patch_names_.size(); ++i) known += (i > 1 ? ", " : "") + patch_names_[i];
  throw InvalidArgument("no patch is named \"" + std::string(name) +
                        "\"; there are: " + (known.empty() ? "none" : known));
}

std::size_t Map::wall_face_count() const {
  std::size_t count = 0;
  for (const Cell c : cells()) {
    const CellView v = view(c);
    if (!v.is_free()) continue;
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) count += v.is_wall(f) ? 1 : 0;
  }
  return count;
}

std::size_t Map::bytes() const {
  std::size_t sum = sizeof(Map) + shapes_.bytes() + wall_vertices_.size() * sizeof(std::uint64_t) +
                    patches_.size() * sizeof(patches_[0]);
  for (const Pool& pool : pools_) {
    sum += pool.words.size() * sizeof(std::uint32_t) + pool.offsets.size() * sizeof(std::size_t) +
           pool.source.size() * sizeof(std::uint32_t);
  }
  return sum;
}

}  // namespace dartcast
