// The free simplices around a vertex, an edge or a triangle: those that are reached without passing a wall. And whether
// there is a wall, in the cells around, which are fewer.
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

// What was found so far, simplices or darts, each once, in order. Stars have some tens: then all stays on the stack.
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

namespace detail {

/// The dart from corner a to corner b of a cell, where they are the ends of an edge.
inline std::optional<std::uint16_t> dart_between(const Shape& shape, std::uint16_t a, std::uint16_t b) {
  const std::uint16_t first = shape.dart_at(a);
  std::uint16_t d = first;
  do {
    if (shape.origin(shape.phi1(d)) == b) return d;
    d = shape.phi1(shape.phi2(d));
  } while (d != first);
  return {};
}

/// A wall at an edge, given by one of its darts: around it to the first wall, or once around.
inline std::optional<CellFace> wall_around_edge(const Map& map, Dart first) {
  Dart d = first;
  do {
    const CellView cell = map.view(d.cell);
    const std::uint16_t face = cell.shape().face_of(d.number);
    if (cell.is_wall(face)) return CellFace{d.cell, face};
    d = map.phi2(map.phi3(d));
  } while (d != first);
  return {};
}

/// A wall at a vertex, given by the dart that dart_at() gives.
inline std::optional<CellFace> wall_around_vertex(const Map& map, Dart start) {
  Found<Dart> found;  // of each cell the dart that its shape gives
  found.add(start);
  for (std::size_t next = 0; next < found.size(); ++next) {
    const Dart first = found[next];
    const CellView cell = map.view(first.cell);
    const Shape& shape = cell.shape();
    std::uint16_t d = first.number;
    do {
      const std::uint16_t face = shape.face_of(d);
      if (cell.is_wall(face)) return CellFace{first.cell, face};
      const Dart beyond = map.phi3({first.cell, d});
      const Shape& other = map.shape(beyond.cell);
      found.add({beyond.cell, other.dart_at(other.origin(other.phi1(beyond.number)))});
      d = shape.phi1(shape.phi2(d));
    } while (d != first.number);
  }
  return {};
}

/// A wall that may hold the vertex a (where b is a, too) or the edge ab of a simplex: points of a cell.
inline std::optional<CellFace> wall_around(const Map& map, Cell id, const CellView& cell, std::uint16_t a,
                                           std::uint16_t b) {
  const Shape& shape = cell.shape();
  const std::uint16_t inner = std::max(a, b);
  if (inner >= shape.corner_count()) {  // inside a face, or the cell
    const std::uint16_t face = shape.face_of_point(inner);
    if (face == shape.face_count() || !cell.is_wall(face)) return {};
    return CellFace{id, face};
  }
  if (a == b) return wall_around_vertex(map, {id, shape.dart_at(a)});
  if (const auto d = dart_between(shape, a, b)) return wall_around_edge(map, {id, *d});
  // Across one face, or through the cell.
  for (std::uint16_t face = 0; face < shape.face_count(); ++face) {
    const auto corners = shape.corners(face);
    const auto has = [&](std::uint16_t corner) {
      return std::find(corners.begin(), corners.end(), corner) != corners.end();
    };
    if (cell.is_wall(face) && has(a) && has(b)) return CellFace{id, face};
  }
  return {};
}

/// A facet in a face that holds the feature, if there is one.
inline std::optional<SimplexFacet> facet_in_face(const Map& map, CellFace f, const Feature& feature) {
  const CellView cell = map.view(f.cell);
  for (std::uint16_t t = 0; t < cell.shape().triangle_count(f.face); ++t) {
    unsigned held = 0;
    for (const std::uint16_t v : cell.shape().triangle(f.face, t)) held += feature.has(cell.vertex(v)) ? 1 : 0;
    if (held < feature.count) continue;
    const Across behind = cell.shape().entry(f.face, t);
    return SimplexFacet{{f.cell, behind.index}, behind.place};
  }
  return {};
}

}  // namespace detail

/// A wall facet that holds `feature`, spanned by the corners of a simplex that have no bit set in `zeros`; nothing
/// where there is none among those that search_star() finds from there. Cost: of one face for a feature inside it,
/// linear in the cells around an edge or a vertex. Precondition: 1 to 3 bits are set.
inline std::optional<SimplexFacet> find_wall(const Map& map, SimplexId simplex, unsigned zeros,
                                             const Feature& feature) {
  const CellView cell = map.view(simplex.cell);
  const Shape& shape = cell.shape();
  const ImplicitSimplex& s = shape.simplices()[simplex.simplex];
  if (feature.count == 3) {
    const auto facet = static_cast<std::uint16_t>(std::countr_zero(zeros));
    if (!s.across[facet].outer() || !cell.is_wall(s.across[facet].face())) return {};
    return SimplexFacet{simplex, facet};
  }
  const unsigned others = 15U & ~zeros;
  const std::uint16_t a = s.vertex[static_cast<unsigned>(std::countr_zero(others))];
  const std::uint16_t b = s.vertex[static_cast<unsigned>(std::bit_width(others)) - 1U];  // a itself at a vertex
  const std::optional<CellFace> wall = detail::wall_around(map, simplex.cell, cell, a, b);
  if (!wall) return {};
  return detail::facet_in_face(map, *wall, feature);
}

}  // namespace dartcast
