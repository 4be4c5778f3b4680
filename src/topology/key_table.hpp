// A small hash table for work within a few cells. It is built, used and dropped in a time linear in its entries.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace dartcast::detail {

/// Numbers by key. Open addressing: half the places stay empty. It grows if there are more keys than announced.
class KeyTable {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  explicit KeyTable(std::size_t keys = 0) { reset(keys); }

  /// Removes all keys.
  void reset(std::size_t keys) {
    places_.assign(std::bit_ceil(2 * keys + 2), {});
    shift_ = 64 - static_cast<unsigned>(std::countr_zero(places_.size()));
    count_ = 0;
  }

  /// The number of a key, `none` if it has none yet. The caller can write to it, until the next key is added.
  /// Precondition: key < 2^64 - 1.
  std::uint32_t& operator[](std::uint64_t key) {
    Place* p = place(key);
    if (p->key != key) {
      if (2 * ++count_ > places_.size()) [[unlikely]] {
        grow();
        p = place(key);
      }
      p->key = key;
    }
    return p->number;
  }
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const { return const_cast<KeyTable*>(this)->place(key)->number; }

 private:
  struct Place {
    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t number = none;
  };

  Place* place(std::uint64_t key) {
    std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15U) >> shift_);
    while (places_[at].key != key && places_[at].key != ~std::uint64_t{0}) at = (at + 1) & (places_.size() - 1);
    return &places_[at];
  }

  void grow() {
    const std::vector<Place> old = std::move(places_);
    const std::size_t count = count_;
    reset(count);
    count_ = count;
    for (const Place& p : old) {
      if (p.key != ~std::uint64_t{0}) *place(p.key) = p;
    }
  }

  std::vector<Place> places_;
  std::size_t count_ = 0;
  unsigned shift_ = 0;
};

}  // namespace dartcast::detail
