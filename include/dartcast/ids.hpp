// Distinct types for the numbers of things, so that a cell cannot be passed as a vertex.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace dartcast {

/// A number with a type of its own; invalid by default.
template <class Tag>
struct Id {
  static constexpr std::uint32_t invalid_value = 0xffffffffU;

  std::uint32_t value = invalid_value;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}

  [[nodiscard]] constexpr bool valid() const { return value != invalid_value; }
  constexpr auto operator<=>(const Id&) const = default;
};

/// A vertex: index into the array of positions.
using Vertex = Id<struct VertexTag>;

/// A cell: 3 bits name the pool (one per kind of record), 29 bits the place in it.
struct Cell : Id<struct CellTag> {
  static constexpr unsigned index_bits = 29;
  static constexpr std::uint32_t index_mask = (1U << index_bits) - 1;

  constexpr Cell() = default;
  constexpr explicit Cell(std::uint32_t v) : Id(v) {}
  constexpr Cell(std::uint32_t pool, std::uint32_t index) : Id((pool << index_bits) | index) {}

  [[nodiscard]] constexpr std::uint32_t pool() const { return value >> index_bits; }
  [[nodiscard]] constexpr std::uint32_t index() const { return value & index_mask; }
};

/// A dart: an oriented edge of a face of a cell, by its number in the cell's shape.
struct Dart {
  Cell cell;
  std::uint16_t number = 0xffffU;

  [[nodiscard]] constexpr bool valid() const { return cell.valid(); }
  constexpr auto operator<=>(const Dart&) const = default;
};

/// A face of a cell, by its number in the cell's shape. Two cells that share a face each have one of these.
struct CellFace {
  Cell cell;
  std::uint16_t face = 0xffffU;

  [[nodiscard]] constexpr bool valid() const { return cell.valid(); }
  constexpr auto operator<=>(const CellFace&) const = default;
};

/// Names an implicit simplex: a cell and the number of one of its shape's simplices.
struct SimplexId {
  Cell cell;
  std::uint16_t simplex = 0;

  [[nodiscard]] constexpr bool valid() const { return cell.valid(); }
  constexpr auto operator<=>(const SimplexId&) const = default;
};

/// The kind of the map's cell that holds a point in its interior. The value is the cell's dimension.
enum class Kind : std::uint8_t { vertex = 0, edge = 1, face = 2, volume = 3 };

/// A named group of wall faces; 0 is the unnamed rest.
struct Patch {
  std::uint16_t value = 0;

  constexpr auto operator<=>(const Patch&) const = default;
};

}  // namespace dartcast

template <class Tag>
struct std::hash<dartcast::Id<Tag>> {
  std::size_t operator()(dartcast::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value); }
};
