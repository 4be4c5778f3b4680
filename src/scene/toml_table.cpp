// Reads and checks values of a TOML table, with messages that say where.
#include "scene/toml_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/closest_word.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

std::string_view type_name(const toml::node& node) {
  if (node.is_string()) return "a text";
  if (node.is_integer()) return "a whole number";
  if (node.is_floating_point()) return "a number";
  if (node.is_boolean()) return "true or false";
  if (node.is_array()) return "a list";
  return node.is_table() ? "a table" : "a date or a time";
}

}  // namespace

const toml::node* TomlTable::find(std::string_view key) {
  known_.emplace(key);
  return table_->get(key);
}

int TomlTable::line_of(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return static_cast<int>(node != nullptr ? node->source().begin.line : table_->source().begin.line);
}

void TomlTable::fail(std::string_view key, const std::string& message) const {
  throw Error(fmt::format("{}:{}: {}{}{}", file_, line_of(key), name_, name_.empty() ? "" : " ", message));
}

bool TomlTable::has(std::string_view key) { return find(key) != nullptr; }

bool TomlTable::is_table(std::string_view key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_table();
}

bool TomlTable::is_text(std::string_view key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_string();
}

double TomlTable::number(std::string_view key, const toml::node& node) const {
  const auto value = node.value<double>();
  if (!value || node.is_boolean()) fail(key, fmt::format("{} must be a number; here is {}", key, type_name(node)));
  if (!std::isfinite(*value)) fail(key, fmt::format("{} must be finite", key));
  return *value;
}

bool TomlTable::get(std::string_view key, double& value, Range range) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const double x = number(key, *node);
  if (x < range.low || x > range.high || (range.low_open && x == range.low)) {
    const bool bounded = range.high < std::numeric_limits<double>::max();
    fail(key, fmt::format("{} = {}: it must be {} {}{}", key, x, range.low_open ? "more than" : "at least", range.low,
                          bounded ? fmt::format(" and at most {}", range.high) : ""));
  }
  value = x;
  return true;
}

bool TomlTable::get(std::string_view key, bool& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  if (!node->is_boolean()) fail(key, fmt::format("{} must be true or false; here is {}", key, type_name(*node)));
  value = node->as_boolean()->get();
  return true;
}

bool TomlTable::get(std::string_view key, std::string& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  if (!node->is_string()) fail(key, fmt::format("{} must be a text in quotes; here is {}", key, type_name(*node)));
  value = node->as_string()->get();
  if (value.empty()) fail(key, fmt::format("{} is empty: leave it out, or name something", key));
  return true;
}

bool TomlTable::get(std::string_view key, Vec3& value) {
  std::vector<double> list;
  if (!get(key, list, 3)) return false;
  value = {list[0], list[1], list[2]};
  return true;
}

bool TomlTable::get(std::string_view key, std::vector<Vec3>& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const toml::array* list = node->as_array();
  if (list == nullptr) fail(key, fmt::format("{} must be a list of points; here is {}", key, type_name(*node)));
  value.clear();
  for (const toml::node& item : *list) {
    const toml::array* point = item.as_array();
    if (point == nullptr || point->size() != 3)
      fail(key, fmt::format("{}: point {} must be a list of 3 numbers", key, value.size() + 1));
    value.push_back({number(key, (*point)[0]), number(key, (*point)[1]), number(key, (*point)[2])});
  }
  return true;
}

bool TomlTable::get(std::string_view key, std::uint64_t& value, std::uint64_t low, std::uint64_t high) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  if (!node->is_integer()) fail(key, fmt::format("{} must be a whole number; here is {}", key, type_name(*node)));
  const std::int64_t x = node->as_integer()->get();
  if (x < 0 || static_cast<std::uint64_t>(x) < low || static_cast<std::uint64_t>(x) > high) {
    fail(key, fmt::format("{} = {}: it must be between {} and {}", key, x, low, high));
  }
  value = static_cast<std::uint64_t>(x);
  return true;
}

bool TomlTable::get(std::string_view key, std::uint32_t& value, std::uint32_t low, std::uint32_t high) {
  std::uint64_t wide = value;
  const bool found = get(key, wide, std::uint64_t{low}, std::uint64_t{high});
  value = static_cast<std::uint32_t>(wide);
  return found;
}

bool TomlTable::get(std::string_view key, std::vector<std::string>& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  if (node->is_string()) {
    value = {node->as_string()->get()};
    return true;
  }
  if (!node->is_array()) fail(key, fmt::format("{} must be a list of texts; here is {}", key, type_name(*node)));
  value.clear();
  for (const toml::node& item : *node->as_array()) {
    if (!item.is_string()) fail(key, fmt::format("{} must be a list of texts; {} is in it", key, type_name(item)));
    value.push_back(item.as_string()->get());
  }
  return true;
}

bool TomlTable::get(std::string_view key, std::vector<double>& value, std::size_t count) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  value.clear();
  if (const toml::array* list = node->as_array()) {
    for (const toml::node& item : *list) value.push_back(number(key, item));
  } else if (count <= 1) {
    value.push_back(number(key, *node));
  } else {
    fail(key, fmt::format("{} must be a list of {} numbers; here is {}", key, count, type_name(*node)));
  }
  if (count != 0 && value.size() != count)
    fail(key, fmt::format("{} must have {} numbers; it has {}", key, count, value.size()));
  return true;
}

bool TomlTable::get(std::string_view key, std::vector<std::uint64_t>& value, std::uint64_t low, std::uint64_t high) {
  std::vector<double> list;
  if (!get(key, list)) return false;
  value.clear();
  for (const double x : list) {
    if (x != std::floor(x) || x < static_cast<double>(low) || x > static_cast<double>(high))
      fail(key, fmt::format("{}: {} is in it: all must be whole numbers between {} and {}", key, x, low, high));
    value.push_back(static_cast<std::uint64_t>(x));
  }
  return true;
}

bool TomlTable::get(std::string_view key, std::size_t& value, const std::vector<std::string_view>& names) {
  std::string name;
  if (!get(key, name)) return false;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    fail(key, fmt::format("{} = \"{}\": it must be one of {}{}", key, name, fmt::join(names, ", "),
                          did_you_mean(name, std::vector<std::string>(names.begin(), names.end()))));
  value = static_cast<std::size_t>(found - names.begin());
  return true;
}

TomlTable TomlTable::table(std::string_view key) {
  static const toml::table nothing;
  const toml::node* node = find(key);
  const std::string name =
      name_.empty() ? fmt::format("[{}]", key) : fmt::format("[{}.{}]", name_.substr(1, name_.size() - 2), key);
  if (node == nullptr) return {nothing, file_, name};
  if (!node->is_table()) fail(key, fmt::format("{} must be a table: {}; here is {}", key, name, type_name(*node)));
  return {*node->as_table(), file_, name};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  if (node->is_table()) return {table(key)};
  const bool nested = name_.starts_with("[") && !name_.starts_with("[[");
  const std::string name =
      nested ? fmt::format("[[{}.{}]]", name_.substr(1, name_.size() - 2), key) : fmt::format("[[{}]]", key);
  std::vector<TomlTable> result;
  if (const toml::array* list = node->as_array()) {
    for (const toml::node& item : *list) {
      if (!item.is_table()) fail(key, fmt::format("{} must be a list of tables: {}", key, name));
      result.emplace_back(*item.as_table(), file_, name);
    }
    return result;
  }
  fail(key, fmt::format("{} must be tables: {}; here is {}", key, name, type_name(*node)));
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> result;
  for (const auto& entry : *table_) result.emplace_back(entry.first.str());
  return result;
}

void TomlTable::require(std::string_view key, std::string_view what) {
  if (find(key) != nullptr) return;
  const std::vector<std::string> wanted = {std::string(key)};
  for (const std::string& other : keys()) {
    const std::string meant = did_you_mean(other, wanted);
    if (known_.count(other) == 0 && !meant.empty()) fail(other, fmt::format("the key '{}' is unknown{}", other, meant));
  }
  fail(key, fmt::format("{} is missing: {}", key, what));
}

void TomlTable::finish() const {
  for (const std::string& key : keys()) {
    if (known_.count(key) != 0) continue;
    const std::vector<std::string> known(known_.begin(), known_.end());
    fail(key,
         fmt::format("the key '{}' is unknown{}; there are {}", key, did_you_mean(key, known), fmt::join(known, ", ")));
  }
}

}  // namespace dartcast
