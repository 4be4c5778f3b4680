// A hash table of 16-bit values for a few faces or darts of cells.
#include <algorithm>

#include "dartcast/storage.hpp"

namespace dartcast {

void SideTable::set(Cell cell, std::uint16_t number, std::uint16_t value) {
  const std::uint64_t key = key_of(cell, number);
  if (value != 0 && 4 * (count_ + 1) > 3 * places_.size()) grow();
  if (places_.empty()) return;
  std::size_t at = home(key);
  while (places_[at] != empty && places_[at] >> 16U != key) at = (at + 1) & mask();
  const bool there = places_[at] != empty;
  if (value != 0) {
    places_[at] = (key << 16U) | value;
    count_ += there ? 0 : 1;
  } else if (there) {
    --count_;
    close_gap(at);
  }
}

void SideTable::grow() {
  std::vector<std::uint64_t> old(std::max<std::size_t>(8, 2 * places_.size()), empty);
  old.swap(places_);
  for (const std::uint64_t place : old) {
    if (place == empty) continue;
    std::size_t at = home(place >> 16U);
    while (places_[at] != empty) at = (at + 1) & mask();
    places_[at] = place;
  }
}

// Closes a gap: moves up the entries that a search would no longer find behind it.
void SideTable::close_gap(std::size_t gap) {
  for (std::size_t at = (gap + 1) & mask(); places_[at] != empty; at = (at + 1) & mask()) {
    const std::size_t from_home = (at - home(places_[at] >> 16U)) & mask();
    if (from_home < ((at - gap) & mask())) continue;
    places_[gap] = places_[at];
    gap = at;
  }
  places_[gap] = empty;
}

bool SideTable::operator==(const SideTable& other) const {
  return count_ == other.count_ && std::all_of(places_.begin(), places_.end(), [&](std::uint64_t place) {
           const Cell cell(static_cast<std::uint32_t>(place >> 32U));
           return place == empty || other.find(cell, static_cast<std::uint16_t>((place >> 16U) & 0xffffU)) ==
                                        static_cast<std::uint16_t>(place & 0xffffU);
         });
}

}  // namespace dartcast
