// A value that all ranks have, made of each one's own. Not installed.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "base/are_several.hpp"
#include "base/bytes.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

/// The first rank adds those of all to its own, in the order of ranks, with add(sum, other), and all get the sum. Bytes
/// come from pack(value), and unpack(bytes) gives the value. Collective, if there are several.
template <class T, class Add, class Pack, class Unpack>
T reduced(Ranks* ranks, const T& own, Add&& add, Pack&& pack, Unpack&& unpack) {
  if (!are_several(ranks)) return own;
  const std::vector<std::string> all = ranks->gather(pack(own));
  T sum = own;
  for (std::size_t r = 1; r < all.size(); ++r) add(sum, unpack(all[r]));
  return unpack(ranks->broadcast(pack(sum)));
}

/// The same for plain records.
template <class T, class Add>
requires std::is_trivially_copyable_v<T> T reduced(Ranks* ranks, const T& own, Add&& add) {
  const auto pack = [](const T& value) {
    ByteWriter bytes;
    bytes.put(value);
    return bytes.bytes();
  };
  const auto unpack = [](const std::string& bytes) { return ByteReader(bytes).take<T>(); };
  return reduced(ranks, own, add, pack, unpack);
}

}  // namespace dartcast
