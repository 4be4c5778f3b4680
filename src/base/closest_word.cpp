// Compares words letter by letter: optimal string alignment, row by row.
#include "base/closest_word.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace dartcast {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);  // of the first i letters of a: the distance to each start of b
  std::iota(row.begin(), row.end(), std::size_t{0});
  std::vector<std::size_t> before = row;
  std::vector<std::size_t> before_that;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_that = std::exchange(before, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, replaced});
      const bool is_swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swapped) row[j] = std::min(row[j], before_that[j - 2] + 1);
    }
  }
  return row.back();
}

std::string did_you_mean(std::string_view word, std::span<const std::string> words) {
  std::size_t nearest = std::min(std::max<std::size_t>(1, word.size() / 3) + 1, word.size());
  const std::string* meant = nullptr;
  for (const std::string& w : words) {
    const std::size_t distance = edit_distance(word, w);
    if (distance >= nearest) continue;
    nearest = distance;
    meant = &w;
  }
  return meant == nullptr ? std::string() : " (did you mean '" + *meant + "'?)";
}

}  // namespace dartcast
