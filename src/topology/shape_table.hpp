// Shapes by number: cells alike share one, and those that no cell uses any more are given up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "dartcast/cell_shape.hpp"

namespace dartcast {

class ShapeTable {
 public:
  /// Numbers of standard shapes fit in 16 bits: the last 64 of these are kept for them (45 serve every numbering of the
  /// four types).
  static constexpr std::uint32_t kept_begin = 0x10000U - 64U;
  static constexpr std::uint32_t kept_end = 0x10000U;

  struct Interned {
    std::uint32_t number;
    bool made;      ///< the shape is new
    bool appended;  ///< under a number that there was not before
  };

  /// The shape with this key, one use more. Throws as Shape does.
  Interned intern(ShapeKey key);
  /// The shape of a standard cell, told by its signature (see topology/cell_form.hpp); it stays for good.
  /// `key()` is called where the shape is new.
  template <class Key>
  Interned intern_standard(std::uint32_t signature, Key&& key) {
    const auto found = standard_.find(signature);
    if (found != standard_.end()) return {found->second, false, false};
    return add_standard(signature, key());
  }
  /// One use less; a shape without uses is given up, and its number used again.
  void release(std::uint32_t number);
  /// Takes back the last intern() or intern_standard() that has not been taken back: all is as before.
  void undo(const Interned& interned);

  [[nodiscard]] const Shape& operator[](std::uint32_t number) const { return *shapes_[number]; }
  /// Number of shapes. They are numbered from 0 without gaps until the map is edited.
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t bytes() const;
  /// The same shapes under the same numbers, with the same uses.
  bool operator==(const ShapeTable& other) const;

 private:
  struct KeyHash {
    std::size_t operator()(const ShapeKey* key) const;
  };
  struct KeyEqual {
    bool operator()(const ShapeKey* a, const ShapeKey* b) const { return *a == *b; }
  };
  static constexpr std::uint32_t forever = 0xffffffffU;  // uses of a standard shape

  Interned add_standard(std::uint32_t signature, ShapeKey key);
  Interned put(std::uint32_t number, std::shared_ptr<const Shape> shape, std::uint32_t uses);
  void drop(std::uint32_t number);

  std::vector<std::shared_ptr<const Shape>> shapes_;  // shared by copies of the table: they are immutable
  std::vector<std::uint32_t> uses_;
  std::vector<std::uint32_t> vacant_;                                              // numbers given up
  std::unordered_map<const ShapeKey*, std::uint32_t, KeyHash, KeyEqual> numbers_;  // keys lie in the shapes
  std::unordered_map<std::uint32_t, std::uint32_t> standard_;                      // by signature
  std::size_t count_ = 0;
};

}  // namespace dartcast
