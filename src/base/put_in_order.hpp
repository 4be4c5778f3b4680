// Arrays of which entry i, or group i of entries, belongs to the same thing, put in the order of its numbers. Not installed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace dartcast {

/// The indices by ascending number; empty where the numbers ascend already.
inline std::vector<std::uint32_t> order_of(std::span<const std::uint64_t> numbers) {
  if (std::is_sorted(numbers.begin(), numbers.end())) return {};
  std::vector<std::uint32_t> order(numbers.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return numbers[a] < numbers[b]; });
  return order;
}

/// `width`: entries of each thing.
template <class T>
void put_in_order(std::vector<T>& values, std::span<const std::uint32_t> order, std::size_t width = 1) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::uint32_t i : order) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i * width);
    sorted.insert(sorted.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  values = std::move(sorted);
}

}  // namespace dartcast
