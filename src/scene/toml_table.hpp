// Reading TOML strictly: every value checked where it stands, every key accounted for.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// Range of a number; ends included unless `open`.
struct Range {
  double low;
  double high;
  bool low_open = false;

  static constexpr double unlimited = std::numeric_limits<double>::max();
  static const Range positive;
  static const Range not_negative;
};

inline constexpr Range Range::positive = {0.0, Range::unlimited, true};
inline constexpr Range Range::not_negative = {0.0, Range::unlimited};

/// A table of a scene. Each getter leaves `value` as it is if the key is absent. It throws Error with file, line,
/// key, what is expected and what stands there, if it is of the wrong type or out of range.
class TomlTable {
 public:
  /// `name`: as it stands in the file, for messages: "[motion]".
  TomlTable(const toml::table& table, std::string file, std::string name)
      : table_(&table), file_(std::move(file)), name_(std::move(name)) {}

  bool has(std::string_view key);
  bool is_table(std::string_view key);
  bool is_text(std::string_view key);
  bool get(std::string_view key, double& value, Range range);
  bool get(std::string_view key, bool& value);
  bool get(std::string_view key, std::string& value);
  bool get(std::string_view key, Vec3& value);
  /// A list of points: [[0, 0, 0], [1, 0, 0]].
  bool get(std::string_view key, std::vector<Vec3>& value);
  bool get(std::string_view key, std::uint64_t& value, std::uint64_t low, std::uint64_t high);
  bool get(std::string_view key, std::uint32_t& value, std::uint32_t low, std::uint32_t high);
  /// A list of strings, or one.
  bool get(std::string_view key, std::vector<std::string>& value);
  /// A list of numbers, or one; `count` of them unless 0.
  bool get(std::string_view key, std::vector<double>& value, std::size_t count = 0);
  /// A list of whole numbers, or one.
  bool get(std::string_view key, std::vector<std::uint64_t>& value, std::uint64_t low, std::uint64_t high);
  /// One of some names; the place of the one found.
  bool get(std::string_view key, std::size_t& value, const std::vector<std::string_view>& names);

  /// One of some names, each with the value that it stands for.
  template <class T>
  bool get(std::string_view key, T& value, std::initializer_list<std::pair<std::string_view, T>> choices) {
    std::vector<std::string_view> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    std::size_t place = 0;
    if (!get(key, place, names)) return false;
    value = choices.begin()[place].second;
    return true;
  }

  /// A table in this one.
  [[nodiscard]] TomlTable table(std::string_view key);
  /// One table, or a list of tables; empty if the key is absent.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key);
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Throws if the key is absent.
  void require(std::string_view key, std::string_view what);
  /// Throws if a key was never asked for: names the nearest place and the keys there are.
  void finish() const;

  [[noreturn]] void fail(std::string_view key, const std::string& message) const;

 private:
  const toml::node* find(std::string_view key);
  [[nodiscard]] int line_of(std::string_view key) const;
  double number(std::string_view key, const toml::node& node) const;

  const toml::table* table_;
  std::string file_;
  std::string name_;
  std::set<std::string, std::less<>> known_;
};

}  // namespace dartcast
