// The free simplices around a vertex, an edge or a triangle: those that are reached without passing a wall.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "dartcast/geometry/simplex.hpp"
#include "dartcast/map/map.hpp"
#include "dartcast/walk/space.hpp"

namespace dartcast {

/// 1 to 3 vertices: the simplex of the complex in whose interior a point lies.
struct Feature {
  std::array<Vertex, 4> vertex;
  unsigned count = 0;

  void add(Vertex v) { vertex[count++] = v; }
};

/// Bit i is set where the facet opposite to corner i holds the feature.
template <std::size_t N = 4>
unsigned facets_holding(const Feature& feature, const CellView& cell, const ImplicitSimplex& s) {
  std::array<Vertex, N> corner;
  for (unsigned i = 0; i < N; ++i) corner[i] = cell.vertex(s.vertex[i]);
  unsigned beside = (1U << N) - 1U;
  for (unsigned k = 0; k < feature.count; ++k) {
    for (unsigned i = 0; i < N; ++i) beside &= ~(static_cast<unsigned>(corner[i] == feature.vertex[k]) << i);
  }
  return beside;
}

namespace detail {

// Codes found so far, each key once, in order. Stars have some tens: then all stays on the stack, and nothing is
// written before it is needed.
template <std::uint64_t key_mask>
class Found {
 public:
  /// One that was not found before, nor will be again.
  void push(std::uint64_t code) {
    if (count_ == near_.size()) return add(code);
    near_[count_++] = code;
  }
  void add(std::uint64_t code) {
    const std::uint64_t key = code & key_mask;
    if (count_ < near_.size()) {
      std::size_t slot = (key * 0x9e3779b97f4a7c15U) >> (64U - slot_bits);
      for (; place_[slot] != 0; slot = (slot + 1) % place_.size()) {
        if ((near_[place_[slot] - 1U] & key_mask) == key) return;
      }
      near_[count_++] = code;
      place_[slot] = static_cast<std::uint8_t>(count_);
      return;
    }
    add_far(code, key);
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::uint64_t operator[](std::size_t i) const {
    return i < near_.size() ? near_[i] : far_->codes[i - near_.size()];
  }

 private:
  struct Far {
    std::vector<std::uint64_t> codes;
    std::unordered_set<std::uint64_t> keys;  // of all
  };

  void add_far(std::uint64_t code, std::uint64_t key) {
    if (!far_) {
      far_.emplace();
      for (const std::uint64_t known : near_) far_->keys.insert(known & key_mask);
    }
    if (!far_->keys.insert(key).second) return;
    far_->codes.push_back(code);
    ++count_;
  }

  static constexpr unsigned slot_bits = 7;

  std::array<std::uint64_t, 64> near_;                 // the first count_
  std::array<std::uint8_t, 1U << slot_bits> place_{};  // hash table: one more than the place in near_, 0 where empty
  std::size_t count_ = 0;
  std::optional<Far> far_;
};

// Cell, simplex and, of its shape, star: the simplex only says where the star was entered.
constexpr std::uint64_t code_of(SimplexId s, std::uint16_t star) {
  return (std::uint64_t{s.cell.value} << 32U) | (std::uint64_t{s.simplex} << 16U) | star;
}
constexpr SimplexId simplex_of(std::uint64_t code) {
  return {Cell(static_cast<std::uint32_t>(code >> 32U)), static_cast<std::uint16_t>(code >> 16U)};
}

// Cells of which nothing more can be found: the first few of them, to be passed by at once.
class FewCells {
 public:
  /// Returns false: there is no room.
  bool add(Cell c) {
    if (count_ == cells_.size()) return false;
    cells_[count_++] = c;
    return true;
  }
  [[nodiscard]] bool has(Cell c) const {
    return std::find(cells_.begin(), cells_.begin() + count_, c) != cells_.begin() + count_;
  }

 private:
  std::array<Cell, 16> cells_;
  std::size_t count_ = 0;
};

using FoundSimplices = Found<~std::uint64_t{0xffff}>;
using FoundStars = Found<~(std::uint64_t{0xffff} << 16U)>;

}  // namespace detail

/// Goes through the simplices around `feature` that are reached from `start` (one of them) through facets that hold the
/// feature and are no walls. Calls on_simplex(SimplexId, CellView, ImplicitSimplex) for each, start first; it ends the
/// search by returning false. Purely combinatorial: no coordinate is read. Cost: linear in the star.
template <std::size_t N = 4, class OnSimplex>
void search_star(const Map& map, SimplexId start, const Feature& feature, OnSimplex&& on_simplex) {
  detail::FoundSimplices found;
  found.add(detail::code_of(start, 0));
  for (std::size_t next = 0; next < found.size(); ++next) {
    const SimplexId id = detail::simplex_of(found[next]);
    const CellView cell = map.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    if (!on_simplex(id, cell, s)) return;
    unsigned facets = facets_holding<N>(feature, cell, s);
    for (; facets != 0; facets &= facets - 1) {
      const auto facet = static_cast<std::uint16_t>(std::countr_zero(facets));
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face())) continue;
      found.add(detail::code_of(pass(map, id, cell, across).simplex, 0));
    }
  }
}

namespace detail {

/// search_walls() in the plane, around a vertex: from triangle to triangle.
template <class OnWall>
void search_plane_walls(const Map& map, SimplexId start, const Feature& feature, OnWall&& on_wall) {
  search_star<3>(map, start, feature, [&](SimplexId id, const CellView& cell, const ImplicitSimplex& s) {
    for (unsigned facets = facets_holding<3>(feature, cell, s); facets != 0; facets &= facets - 1) {
      const auto facet = static_cast<std::uint16_t>(std::countr_zero(facets));
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face()) && !on_wall(id, cell, s, facet)) return false;
    }
    return true;
  });
}

}  // namespace detail

/// The same search for walls alone, around one or two vertices: from cell to cell, by their stars (map/stars.hpp).
/// Calls on_wall(SimplexId, CellView, ImplicitSimplex, facet) for each wall facet that holds the feature; it ends the
/// search by returning false. Cost: linear in the number of cells around the feature.
template <std::size_t N = 4, class OnWall>
void search_walls(const Map& map, SimplexId start, const Feature& feature, OnWall&& on_wall) {
  if constexpr (N == 3) return detail::search_plane_walls(map, start, feature, on_wall);
  detail::FoundStars found;
  detail::FewCells whole;
  const auto add = [&](SimplexId id, const CellView& cell) {
    const Stars& stars = cell.shape().stars();
    const unsigned beside = facets_holding(feature, cell, cell.shape().simplices()[id.simplex]);
    const std::uint64_t code = detail::code_of(id, stars.star(id.simplex, 15U & ~beside));
    if (stars.one_each() && whole.add(id.cell)) return found.push(code);
    found.add(code);
  };
  add(start, map.view(start.cell));
  for (std::size_t next = 0; next < found.size(); ++next) {
    const Cell at = detail::simplex_of(found[next]).cell;
    const CellView cell = map.view(at);
    const Shape& shape = cell.shape();
    std::uint16_t passed = shape.face_count();  // the face before, where one look is enough
    for (const Stars::Facet& outer : shape.stars().outer_facets(static_cast<std::uint16_t>(found[next]))) {
      if (outer.face == passed) continue;
      if (cell.is_wall(outer.face)) {
        if (!on_wall(SimplexId{at, outer.simplex}, cell, shape.simplices()[outer.simplex], outer.facet)) return;
        continue;
      }
      const Cell neighbour = cell.neighbour(outer.face);
      if (!whole.has(neighbour)) {
        const CellView beyond = map.view(neighbour);
        if (beyond.shape().stars().empty()) continue;  // flat: no way through
        add(pass_face(cell, outer.face, outer.triangle, neighbour, beyond).simplex, beyond);
        if (!beyond.shape().stars().one_each()) continue;
      }
      passed = outer.face;
    }
  }
}

/// A facet of a simplex.
struct SimplexFacet {
  SimplexId simplex;
  std::uint16_t facet = 0;
};

/// A wall facet that holds `feature`, spanned by the corners of a simplex that have no bit set in `zeros`; nothing
/// where search_walls() finds none from there. Cost: one look inside a face, else linear in the star. Precondition: 1
/// to N - 1 bits are set.
template <std::size_t N = 4>
std::optional<SimplexFacet> find_wall(const Map& map, SimplexId simplex, unsigned zeros, const Feature& feature) {
  if (feature.count == N - 1) {
    const auto facet = static_cast<std::uint16_t>(std::countr_zero(zeros));
    const CellView cell = map.view(simplex.cell);
    const Across across = cell.shape().simplices()[simplex.simplex].across[facet];
    if (!across.outer() || !cell.is_wall(across.face())) return {};
    return SimplexFacet{simplex, facet};
  }
  bool may_touch = true;
  for (unsigned i = 0; i < feature.count; ++i) may_touch &= map.may_touch_wall(feature.vertex[i]);
  if (!may_touch) return {};
  std::optional<SimplexFacet> found;
  search_walls<N>(map, simplex, feature,
                  [&](SimplexId id, const CellView&, const ImplicitSimplex&, std::uint16_t facet) {
                    found = SimplexFacet{id, facet};
                    return false;
                  });
  return found;
}

}  // namespace dartcast
