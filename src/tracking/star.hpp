// The free simplices around a vertex, an edge or a triangle: those that are reached without passing a wall.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "complex/simplex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "tracking/space.hpp"

namespace dartcast {

/// 1 to 3 vertices: the simplex of the complex in whose interior a point lies.
struct Feature {
  std::array<Vertex, 4> vertex;  // the first `count`
  unsigned count = 0;

  void add(Vertex v) { vertex[count++] = v; }
  /// Adds it if `held`. Without a branch, which would mispredict.
  void add_if(bool held, Vertex v) {
    vertex[count] = v;
    count += held ? 1U : 0U;
  }
};

/// Bit i is set if the facet opposite to corner i holds the feature.
template <std::size_t N = 4>
[[gnu::always_inline]] inline unsigned facets_holding(const Feature& feature, const CellView& cell,
                                                      const ImplicitSimplex& s) {
  std::array<Vertex, N> corner;
  for (unsigned i = 0; i < N; ++i) corner[i] = cell.vertex(s.vertex[i]);
  unsigned beside = (1U << N) - 1U;
  for (unsigned k = 0; k < feature.count; ++k) {
    for (unsigned i = 0; i < N; ++i) beside &= ~(static_cast<unsigned>(corner[i] == feature.vertex[k]) << i);
  }
  return beside;
}

namespace detail {

// Codes found so far, each once, in order. Most stars have some tens of codes: these stay on the stack, uninitialized
// until they are needed.
class FoundSimplex {
 public:
  /// Precondition: the code was not found before, and will not be found again.
  void push(std::uint64_t code) {
    if (count_ == near_.size()) return add(code);
    near_[count_++] = code;
  }
  void add(std::uint64_t code) {
    if (!hashes_) {
      hashes_ = true;
      place_.fill(0);
    }
    if (count_ < near_.size()) {
      std::size_t slot = (code * 0x9e3779b97f4a7c15U) >> (64U - slot_bits);
      for (; place_[slot] != 0; slot = (slot + 1) % place_.size()) {
        if (near_[place_[slot] - 1U] == code) return;
      }
      near_[count_++] = code;
      place_[slot] = static_cast<std::uint8_t>(count_);
      return;
    }
    add_far(code);
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::uint64_t operator[](std::size_t i) const {
    return i < near_.size() ? near_[i] : far_->codes[i - near_.size()];
  }

 private:
  struct Far {
    std::vector<std::uint64_t> codes;
    std::unordered_set<std::uint64_t> known;  // all
  };

  void add_far(std::uint64_t code) {
    if (!far_) far_.emplace().known.insert(near_.begin(), near_.end());
    if (!far_->known.insert(code).second) return;
    far_->codes.push_back(code);
    ++count_;
  }

  static constexpr unsigned slot_bits = 7;

  std::array<std::uint64_t, 64> near_;               // the first count_
  std::array<std::uint8_t, 1U << slot_bits> place_;  // hash table: one more than the place in near_, 0 if empty
  std::size_t count_ = 0;
  bool hashes_ = false;  // most often nothing need be looked for
  std::optional<Far> far_;
};

// A cell, and a simplex or a star of its shape.
constexpr std::uint64_t code_of(Cell c, std::uint16_t number) { return (std::uint64_t{c.value} << 16U) | number; }
constexpr Cell cell_of(std::uint64_t code) { return Cell(static_cast<std::uint32_t>(code >> 16U)); }
constexpr std::uint16_t number_of(std::uint64_t code) { return static_cast<std::uint16_t>(code); }

// The first few cells that are finished, so that the search skips them at once. Four are compared at once, as branches
// would mispredict.
class FewCells {
 public:
  /// Returns false if there is no room.
  bool add(Cell c) {
    if (count_ == limit) return false;
    // Written as a whole: the processor could not load the four yet if one of them was just written.
    Four& four = cells_[count_ / 4];
    const std::uint32_t lane = count_ % 4;
    four = lane == 0 ? all(c.value) : (Four{0, 1, 2, 3} == all(lane)) ? all(c.value) : four;
    ++count_;
    return true;
  }
  [[nodiscard]] bool has(Cell c) const {
    Bits found{};
    for (std::uint32_t i = 0; 4 * i < count_; ++i) found |= reinterpret_cast<Bits>(cells_[i] == all(c.value));
    return (found[0] | found[1]) != 0;
  }

 private:
  using Four = std::uint32_t __attribute__((vector_size(16)));
  using Bits = std::uint64_t __attribute__((vector_size(16)));
  static Four all(std::uint32_t x) { return Four{x, x, x, x}; }

  static constexpr std::uint32_t limit = 16;

  std::array<Four, limit / 4> cells_;  // in the last four the first one again if there are not as many
  std::uint32_t count_ = 0;
};

}  // namespace detail

/// Goes through the simplices around `feature` that are reached from `start` (one of them) through facets that hold the
/// feature and are no walls. Calls on_simplex(SimplexId, CellView, ImplicitSimplex) for each, start first; it ends the
/// search by returning false. Purely combinatorial: no coordinate is read. Cost: linear in the star.
template <std::size_t N = 4, class OnSimplex>
void search_star(const CombinatorialMap& map, SimplexId start, const Feature& feature, OnSimplex&& on_simplex) {
  detail::FoundSimplex found;
  found.add(detail::code_of(start.cell, start.simplex));
  for (std::size_t next = 0; next < found.size(); ++next) {
    const SimplexId id = {detail::cell_of(found[next]), detail::number_of(found[next])};
    const CellView cell = map.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    if (!on_simplex(id, cell, s)) return;
    unsigned facets = facets_holding<N>(feature, cell, s);
    for (; facets != 0; facets &= facets - 1) {
      const auto facet = static_cast<std::uint16_t>(std::countr_zero(facets));
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face())) continue;
      const SimplexId beyond = pass(map, id, cell, across).simplex;
      found.add(detail::code_of(beyond.cell, beyond.simplex));
    }
  }
}

namespace detail {

/// search_walls() in the plane, around a vertex: from triangle to triangle.
template <class OnWall>
void search_plane_walls(const CombinatorialMap& map, SimplexId start, const Feature& feature, OnWall&& on_wall) {
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

/// The same search for walls alone, around one or two vertices: from cell to cell, by their stars
/// (dartcast/cell_shape.hpp). Calls on_wall(SimplexId, CellView, ImplicitSimplex, facet) for each wall facet that holds
/// the feature; it ends the search by returning false. Cost: linear in the number of cells around the feature.
template <std::size_t N = 4, class OnWall>
void search_walls(const CombinatorialMap& map, SimplexId start, const Feature& feature, OnWall&& on_wall) {
  if constexpr (N == 3) return detail::search_plane_walls(map, start, feature, on_wall);
  detail::FoundSimplex found;
  detail::FewCells whole;
  const auto add = [&](Cell c, const Stars& all, std::uint16_t star) {
    const std::uint64_t code = detail::code_of(c, star);
    if (all.one_each() && whole.add(c)) return found.push(code);
    found.add(code);
  };
  const CellView first = map.view(start.cell);
  const unsigned beside = facets_holding(feature, first, first.shape().simplices()[start.simplex]);
  const Stars& stars = first.shape().stars();
  add(start.cell, stars, stars.star(start.simplex, 15U & ~beside));
  for (std::size_t next = 0; next < found.size(); ++next) {
    const Cell at = detail::cell_of(found[next]);
    const CellView cell = map.view(at);
    const Shape& shape = cell.shape();
    const auto outer = shape.stars().outer_facets(detail::number_of(found[next]));
    for (std::size_t i = 0; i < outer.size(); i += outer[i].rest + std::size_t{1}) {  // face by face
      const auto of_face = outer.subspan(i, outer[i].rest + std::size_t{1});
      const std::uint16_t face = outer[i].face;
      if (cell.is_wall(face)) {
        for (const Stars::Facet& f : of_face) {
          if (!on_wall(SimplexId{at, f.simplex}, cell, shape.simplices()[f.simplex], f.facet)) return;
        }
        continue;
      }
      const Cell neighbour = cell.neighbour(face);
      if (whole.has(neighbour)) continue;
      const Stars& beyond = map.shape(neighbour).stars();
      if (beyond.empty()) continue;  // flat: no way through
      const std::uint16_t from_there = cell.neighbour_face(face);
      for (const Stars::Facet& f : of_face.first(beyond.one_each() ? 1 : of_face.size()))
        add(neighbour, beyond, beyond.star_behind(from_there, f.triangle, f.held));
    }
  }
}

/// A facet of a simplex.
struct SimplexFacet {
  SimplexId simplex;
  std::uint16_t facet = 0;
};

/// A wall facet that holds `feature`, which the corners of a simplex without a bit in `zeros` span. Returns nothing if
/// search_walls() finds none from there. Cost: constant inside a face, else linear in the star. Precondition: 1 to
/// N - 1 bits are set.
template <std::size_t N = 4>
std::optional<SimplexFacet> find_wall(const CombinatorialMap& map, SimplexId simplex, unsigned zeros,
                                      const Feature& feature) {
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
