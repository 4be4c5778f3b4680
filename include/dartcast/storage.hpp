// The storage of maps and complexes: aligned arrays, a table of shapes, a table of rare marks. It is part of the layout
// of CombinatorialMap and CellComplex. Programs use those classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "dartcast/cell_shape.hpp"
#include "dartcast/ids.hpp"

namespace dartcast {

// A vector whose storage starts on a cache line, so that a 64-byte record never straddles two. Some bytes behind its
// last element are readable, so that vector instructions may load more than they use.

namespace detail {
// The memory starts on a cache line. Large arrays lie on huge pages if the system has them. Without huge pages, most
// of the time in a large scene is spent on page walks.
void* allocate_aligned(std::size_t bytes);
void deallocate_aligned(void* p, std::size_t bytes) noexcept;
}  // namespace detail

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  // NOLINTNEXTLINE(google-explicit-constructor): allocators rebind by conversion
  constexpr CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}

  static constexpr std::size_t readable_behind = 64;

  [[nodiscard]] T* allocate(std::size_t n) {
    return static_cast<T*>(detail::allocate_aligned(n * sizeof(T) + readable_behind));
  }
  void deallocate(T* p, std::size_t n) noexcept { detail::deallocate_aligned(p, n * sizeof(T) + readable_behind); }
  constexpr bool operator==(const CacheLineAllocator&) const = default;
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

// 16-bit values for a few of the faces, or darts, of cells.

/// Values by cell and number; 0 if none was set. Each place of the hash table takes eight bytes, and at most three
/// quarters of the places are full. Cost of each function but bytes() and ==: constant on average.
class SideTable {
 public:
  [[nodiscard]] std::uint16_t find(Cell cell, std::uint16_t number) const {
    if (count_ == 0) return 0;
    for (std::size_t at = home(key_of(cell, number));; at = (at + 1) & mask()) {
      if (places_[at] == empty) return 0;
      if (places_[at] >> 16U == key_of(cell, number)) return static_cast<std::uint16_t>(places_[at] & 0xffffU);
    }
  }
  /// Sets a value; 0 removes it.
  void set(Cell cell, std::uint16_t number, std::uint16_t value);

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t bytes() const { return places_.size() * sizeof(std::uint64_t); }
  /// Whether the values are the same, in whatever order they were set.
  bool operator==(const SideTable& other) const;

 private:
  static constexpr std::uint64_t empty = ~std::uint64_t{0};  // the invalid cell

  static std::uint64_t key_of(Cell cell, std::uint16_t number) { return (std::uint64_t{cell.value} << 16U) | number; }
  [[nodiscard]] std::size_t mask() const { return places_.size() - 1; }
  [[nodiscard]] std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15U) >> 32U) & mask();
  }
  void grow();
  void close_gap(std::size_t gap);

  std::vector<std::uint64_t> places_;  // cell, number, value; a power of two of them
  std::size_t count_ = 0;
};

// Shapes by number. Equal cells share one shape. A shape that no cell uses any more is released.

/// The shapes of a map, by number.
class ShapeTable {
 public:
  /// Numbers of standard shapes fit in 16 bits. The last 64 of these are reserved for them (45 serve every numbering of
  /// the four types).
  static constexpr std::uint32_t kept_begin = 0x10000U - 64U;
  static constexpr std::uint32_t kept_end = 0x10000U;

  /// The number of a shape, and how it came to it.
  struct Interned {
    std::uint32_t number;
    bool made;      ///< the shape is new
    bool appended;  ///< under a new number
  };

  /// Returns the shape with this key and adds one use. Throws as Shape does.
  Interned intern(const ShapeKey& key);
  /// Returns the shape of a standard cell by its signature (see topology/cell_form.hpp). It is never released. `key()`
  /// is called if the shape is new.
  template <class Key>
  Interned intern_standard(std::uint32_t signature, Key&& key) {
    const auto found = standard_.find(signature);
    if (found != standard_.end()) return {found->second, false, false};
    return add_standard(signature, key());
  }
  /// Removes one use. A shape without uses is released, and its number is used again.
  void release(std::uint32_t number);
  /// Undoes the last intern() or intern_standard() that has not been undone.
  void undo(const Interned& interned);

  [[nodiscard]] const Shape& operator[](std::uint32_t number) const { return *shapes_[number]; }
  /// Number of shapes. They are numbered from 0 without gaps until the map is edited.
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t bytes() const;
  /// Whether the same shapes have the same numbers and uses.
  bool operator==(const ShapeTable& other) const;

 private:
  struct KeyHash {
    std::size_t operator()(const ShapeKey* key) const;
  };
  struct KeyEqual {
    bool operator()(const ShapeKey* a, const ShapeKey* b) const { return *a == *b; }
  };
  static constexpr std::uint32_t forever = 0xffffffffU;  // uses of a standard shape
  static constexpr std::size_t recent_places = 512;
  static constexpr std::uint16_t max_recent_darts = 128;

  [[nodiscard]] std::shared_ptr<const Shape>& recent(const ShapeKey& key);
  [[nodiscard]] std::shared_ptr<const Shape> make(const ShapeKey& key);
  Interned add_standard(std::uint32_t signature, ShapeKey key);
  Interned put(std::uint32_t number, std::shared_ptr<const Shape> shape, std::uint32_t uses);
  void drop(std::uint32_t number);

  std::vector<std::shared_ptr<const Shape>> shapes_;  // shared by copies of the table: they are immutable
  // Released a short time ago: edits need the same few shapes again and again, and a shape is expensive to make. One
  // for each value of the key's hash. Empty until the first release.
  std::vector<std::shared_ptr<const Shape>> recent_;
  std::vector<std::uint32_t> uses_;
  std::vector<std::uint32_t> vacant_;                                              // released numbers
  std::unordered_map<const ShapeKey*, std::uint32_t, KeyHash, KeyEqual> numbers_;  // keys lie in the shapes
  std::unordered_map<std::uint32_t, std::uint32_t> standard_;                      // by signature
  std::size_t count_ = 0;
};

}  // namespace dartcast
