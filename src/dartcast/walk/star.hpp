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
  /// No branch: which of them it is can't be foretold.
  [[nodiscard]] bool has(Vertex v) const {
    return static_cast<bool>(static_cast<int>(vertex[0] == v) | static_cast<int>(vertex[1] == v) |
                             static_cast<int>(vertex[2] == v) | static_cast<int>(vertex[3] == v));
  }
};

/// Bit i is set where the facet opposite to corner i holds the feature.
inline unsigned facets_holding(const Feature& feature, const CellView& cell, const ImplicitSimplex& s) {
  unsigned facets = 0;
  for (unsigned i = 0; i < 4; ++i) facets |= feature.has(cell.vertex(s.vertex[i])) ? 0U : 1U << i;
  return facets;
}

namespace detail {

// What was found so far, each once, in order. Stars have some tens: then all stays on the stack.
template <class Item>
class Found {
 public:
  void add(Item s) {
    if (count_ < near_.size()) {
      std::size_t slot = (key(s) * 0x9e3779b97f4a7c15U) >> (64U - slot_bits);
      for (; place_[slot] != 0; slot = (slot + 1) % place_.size()) {
        if (near_[place_[slot] - 1U] == s) return;
      }
      near_[count_++] = s;
      place_[slot] = static_cast<std::uint8_t>(count_);
      return;
    }
    if (seen_.empty()) {
      for (const Item known : near_) seen_.insert(key(known));
    }
    if (!seen_.insert(key(s)).second) return;
    far_.push_back(s);
    ++count_;
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] Item operator[](std::size_t i) const { return i < near_.size() ? near_[i] : far_[i - near_.size()]; }

 private:
  static std::uint64_t key(Item s) {
    const auto [cell, number] = s;
    return (std::uint64_t{cell.value} << 16U) | number;
  }

  static constexpr unsigned slot_bits = 7;

  std::array<Item, 64> near_;
  std::array<std::uint8_t, 1U << slot_bits> place_{};  // hash table: one more than the place in near_, 0 where empty
  std::size_t count_ = 0;
  std::vector<Item> far_;
  std::unordered_set<std::uint64_t> seen_;  // of all, once they are many
};

}  // namespace detail

/// Goes through the simplices around `feature` that are reached from `start` (one of them) through facets that hold the
/// feature and are no walls. Calls on_simplex(SimplexId, CellView, ImplicitSimplex) for each, start first, and
/// on_wall(SimplexId, CellView, ImplicitSimplex, facet) for each wall facet that holds the feature; either ends the
/// search by returning false. Purely combinatorial: no coordinate is read. Cost: linear in the star.
template <class OnSimplex, class OnWall>
void search_star(const Map& map, SimplexId start, const Feature& feature, OnSimplex&& on_simplex, OnWall&& on_wall) {
  detail::Found<SimplexId> found;
  found.add(start);
  for (std::size_t next = 0; next < found.size(); ++next) {
    const SimplexId id = found[next];
    const CellView cell = map.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    if (!on_simplex(id, cell, s)) return;
    unsigned facets = facets_holding(feature, cell, s);
    for (; facets != 0; facets &= facets - 1) {
      const auto facet = static_cast<std::uint16_t>(std::countr_zero(facets));
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face())) {
        if (!on_wall(id, cell, s, facet)) return;
        continue;
      }
      found.add(pass(map, id, cell, across).simplex);
    }
  }
}

/// A facet of a simplex.
struct SimplexFacet {
  SimplexId simplex;
  std::uint16_t facet = 0;
};

/// A wall facet that holds `feature`, spanned by the corners of a simplex that have no bit set in `zeros`; nothing
/// where search_star() finds none from there. Cost: one look inside a face, else linear in the star. Precondition: 1 to
/// 3 bits are set.
inline std::optional<SimplexFacet> find_wall(const Map& map, SimplexId simplex, unsigned zeros,
                                             const Feature& feature) {
  if (feature.count == 3) {
    const auto facet = static_cast<std::uint16_t>(std::countr_zero(zeros));
    const CellView cell = map.view(simplex.cell);
    const Across across = cell.shape().simplices()[simplex.simplex].across[facet];
    if (!across.outer() || !cell.is_wall(across.face())) return {};
    return SimplexFacet{simplex, facet};
  }
  for (unsigned i = 0; i < feature.count; ++i) {
    if (!map.may_touch_wall(feature.vertex[i])) return {};
  }
  std::optional<SimplexFacet> found;
  search_star(
      map, simplex, feature, [](SimplexId, const CellView&, const ImplicitSimplex&) { return true; },
      [&](SimplexId id, const CellView&, const ImplicitSimplex&, std::uint16_t facet) {
        found = SimplexFacet{id, facet};
        return false;
      });
  return found;
}

}  // namespace dartcast
