// The records of cells, word by word. The head of dartcast/combinatorial_map.hpp describes their layout.
#include <algorithm>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t wide_bit = 1U << 25U;

}  // namespace

// The neighbour's dart along our first edge, in the opposite direction, belongs to the face in question.
std::uint16_t CellView::neighbour_face_from_7(std::uint16_t face) const {
  if ((word_[1] & wide_bit) == 0) return 7;
  const Cell other = neighbour(face);
  if (!map_->contains(other)) return 7;
  const auto corners = shape_->corners(face);
  const CellView n = map_->view(other);
  for (std::uint16_t d = 0; d < n.shape().dart_count(); ++d) {
    if (n.vertex(n.shape().origin(d)) == vertex(corners[1]) &&
        n.vertex(n.shape().origin(n.shape().phi1(d))) == vertex(corners[0]))
      return n.shape().face_of(d);
  }
  return 7;
}

// Appends a record of zeros.
void CombinatorialMap::open_record(std::uint32_t pool, std::size_t words) {
  Pool& p = pools_[pool];
  if (pool == general_pool) p.offsets.push_back(p.words.size());
  p.words.resize(p.words.size() + words);
}

// Writes everything except the version, which stays. The cell has no neighbours and no walls yet.
void CombinatorialMap::write_cell(Cell c, std::uint32_t shape, std::span<const std::uint32_t> vertices, bool free) {
  const bool general = c.pool() == general_pool;
  std::uint32_t* word = record(c);
  const std::uint16_t faces = shapes_[shape].face_count();
  word[0] = general ? shape : (word[0] & 0xffff0000U) | shape;
  word[1] = general ? (word[1] & 0xffffU) | (free ? 1U << 16U : 0U) : (free ? 1U << 24U : 0U);
  std::uint32_t* next = std::copy(vertices.begin(), vertices.end(), word + 2);
  next = std::fill_n(next, faces, Cell::invalid_value);
  if (general) std::fill_n(next, faces, 0U);
}

void CombinatorialMap::set_neighbour(CellFace f, CellFace other) {
  std::uint32_t* word = record(f.cell);
  const Shape& s = shape(f.cell);
  word[2U + s.point_count() + f.face] = other.cell.value;
  if (!other.valid()) return;
  if (f.cell.pool() == general_pool) {
    std::uint32_t& extra = word[2U + s.point_count() + s.face_count() + f.face];
    extra = (extra & 0xffff0000U) | other.face;
  } else {
    const std::uint32_t number = std::min<std::uint32_t>(other.face, 7);
    word[1] = (word[1] & ~(7U << (3U * f.face))) | (number << (3U * f.face)) | (other.face > 7 ? wide_bit : 0U);
  }
}

void CombinatorialMap::set_wall(CellFace f, bool wall) {
  std::uint32_t* word = record(f.cell);
  const Shape& s = shape(f.cell);
  const bool general = f.cell.pool() == general_pool;
  std::uint32_t& mask = general ? word[2U + s.point_count() + s.face_count() + f.face] : word[1];
  const std::uint32_t bit = 1U << (general ? 16U : 18U + f.face);
  mask = wall ? mask | bit : mask & ~bit;
  if (!wall) return;
  const CellView v = view(f.cell);
  for (std::uint16_t t = 0; t < s.triangle_count(f.face); ++t) {
    for (const std::uint16_t corner : s.triangle(f.face, t)) wall_vertices_.add(v.vertex(corner));
  }
}

void CombinatorialMap::mark_walls(Cell c) {
  const CellView v = view(c);
  for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
    const CellFace other = opposite({c, f});
    const bool wall = !other.valid() || is_free(other.cell) != v.is_free();
    set_wall({c, f}, wall);
    if (other.valid()) set_wall(other, wall);
  }
}

}  // namespace dartcast
