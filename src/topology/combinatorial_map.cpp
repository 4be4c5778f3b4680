// The functions of CombinatorialMap that are not inlined.
#include "dartcast/combinatorial_map.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

#include "dartcast/error.hpp"

namespace dartcast {

Dart CombinatorialMap::across(Dart d) const {
  const CellView c = view(d.cell);
  const std::uint16_t f = c.shape().face_of(d.number);
  const Cell other = c.neighbour(f);
  if (!other.valid()) return {};
  // Both sides number a face's darts from its lowest vertex, one side forwards, the other backwards.
  const int place = d.number - c.shape().first_dart(f);
  const int first = shape(other).first_dart(c.neighbour_face(f));
  return {other, static_cast<std::uint16_t>(first + c.shape().degree(f) - 1 - place)};
}

CellFace CombinatorialMap::opposite(CellFace f) const {
  const CellView c = view(f.cell);
  const Cell other = c.neighbour(f.face);
  return other.valid() ? CellFace{other, c.neighbour_face(f.face)} : CellFace{};
}

Vertex CombinatorialMap::point(CellFace f) const {
  const CellView v = view(f.cell);
  const auto& key = v.shape().key();
  if (!key.faces[f.face].has_point) return {};
  std::uint16_t local = key.corner_count;
  for (std::uint16_t g = 0; g < f.face; ++g)
    local = static_cast<std::uint16_t>(local + (key.faces[g].has_point ? 1 : 0));
  return v.vertex(local);
}

CellType CombinatorialMap::type_of(std::uint32_t pool) const {
  if (dimension_ == 3) return static_cast<CellType>(pool);
  constexpr std::array<CellType, 5> planar = {CellType::triangle, CellType::quadrilateral, CellType::polygon,
                                              CellType::polygon, CellType::polygon};
  return planar[pool];
}

std::size_t CombinatorialMap::cell_count() const {
  return std::accumulate(pools_.begin(), pools_.end(), std::size_t{0},
                         [](std::size_t sum, const Pool& pool) { return sum + pool.count - pool.gone; });
}

std::uint32_t CombinatorialMap::source(Cell c) const {
  const auto& source = pools_[c.pool()].source;
  return source.empty() ? c.index() : source[c.index()];
}

std::vector<Cell> CombinatorialMap::cells() const {
  std::vector<Cell> all;
  all.reserve(cell_count());
  for (std::uint32_t p = 0; p < pools_.size(); ++p) {
    for (std::uint32_t i = 0; i < pools_[p].count; ++i) {
      if (contains(Cell(p, i))) all.emplace_back(p, i);
    }
  }
  return all;
}

void CombinatorialMap::set_free(Cell c, bool free) {
  const std::uint32_t bit = 1U << (c.pool() == general_pool ? 16U : 24U);
  std::uint32_t& flags = record(c)[1];
  flags = free ? flags | bit : flags & ~bit;
  mark_walls(c);
}

Patch CombinatorialMap::patch(std::string_view name) const {
  const auto found = std::find(patch_names_.begin(), patch_names_.end(), name);
  if (found != patch_names_.end()) return Patch{static_cast<std::uint16_t>(found - patch_names_.begin())};
  std::string known;
  for (std::size_t i = 1; i < patch_names_.size(); ++i) known += (i > 1 ? ", " : "") + patch_names_[i];
  throw InvalidArgument("no patch is named \"" + std::string(name) +
                        "\"; there are: " + (known.empty() ? "none" : known));
}

std::size_t CombinatorialMap::wall_face_count() const {
  std::size_t count = 0;
  for (const Cell c : cells()) {
    const CellView v = view(c);
    if (!v.is_free()) continue;
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) count += v.is_wall(f) ? 1 : 0;
  }
  return count;
}

std::size_t CombinatorialMap::bytes() const {
  std::size_t sum = sizeof(CombinatorialMap) + shapes_.bytes() + patches_.bytes() + flats_.bytes() +
                    wall_vertices_.words.size() * sizeof(std::uint64_t) + cells_at_.size() * sizeof(std::uint32_t) +
                    vacant_vertices_.size() * sizeof(Vertex);
  for (const Pool& pool : pools_) {
    sum += pool.words.size() * sizeof(std::uint32_t) + pool.offsets.size() * sizeof(std::size_t) +
           pool.source.size() * sizeof(std::uint32_t);
    for (const auto& [length, places] : pool.vacant) sum += places.size() * sizeof(std::uint32_t);
  }
  return sum;
}

}  // namespace dartcast
