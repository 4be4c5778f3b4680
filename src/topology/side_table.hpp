// 16-bit values for a few of the faces, or darts, of cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/ids.hpp"

namespace dartcast {

/// Values by cell and number; 0 where none was set. Eight bytes for each place of a hash table that is at most three
/// quarters full. Cost of each function but bytes() and ==: constant on average.
class SideTable {
 public:
  [[nodiscard]] std::uint16_t find(Cell cell, std::uint16_t number) const {
    if (count_ == 0) return 0;
    for (std::size_t at = home(key_of(cell, number));; at = (at + 1) & mask()) {
      if (places_[at] == empty) return 0;
      if (places_[at] >> 16U == key_of(cell, number)) return static_cast<std::uint16_t>(places_[at] & 0xffffU);
    }
  }
  /// 0 takes a value away.
  void set(Cell cell, std::uint16_t number, std::uint16_t value);

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::size_t bytes() const { return places_.size() * sizeof(std::uint64_t); }
  /// The same values, however they came.
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

}  // namespace dartcast
