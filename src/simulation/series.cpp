// Finds and sorts names that fit a pattern, and gives each its time.
#include "simulation/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

/// The digits that stand in place of the star; empty if the name does not fit.
std::string_view number_in(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  const std::string_view before = pattern.substr(0, star);
  const std::string_view after = pattern.substr(star + 1);
  if (name.size() < pattern.size() || !name.starts_with(before) || !name.ends_with(after)) return {};
  const std::string_view number = name.substr(star, name.size() + 1 - pattern.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos ? number : std::string_view();
}

}  // namespace

std::vector<std::string> numbered(std::string_view pattern, const std::vector<std::string>& names) {
  struct Entry {
    std::string_view digits;  // without zeros in front
    std::string name;
  };
  std::vector<Entry> entries;
  for (const std::string& name : names) {
    std::string_view digits = number_in(pattern, name);
    if (digits.empty()) continue;
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    entries.push_back({digits, name});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    if (a.digits.size() != b.digits.size()) return a.digits.size() < b.digits.size();
    return a.digits != b.digits ? a.digits < b.digits : a.name < b.name;
  });
  std::vector<std::string> result;
  for (Entry& e : entries) result.push_back(std::move(e.name));
  return result;
}

std::vector<double> sample_times(std::string_view owner, const std::vector<double>& times, double spacing,
                                 std::size_t count, std::string_view items) {
  if (!times.empty()) {
    if (times.size() != count)
      throw InvalidArgument(
          fmt::format("{} has {} times for {} {}: give one for each", owner, times.size(), count, items));
    return times;
  }
  if (count > 1 && !(spacing > 0.0))
    throw InvalidArgument(fmt::format("{} has {} {}, but no times: give times or spacing", owner, count, items));
  std::vector<double> result(count);
  for (std::size_t k = 0; k < count; ++k) result[k] = static_cast<double>(k) * spacing;
  return result;
}

}  // namespace dartcast
