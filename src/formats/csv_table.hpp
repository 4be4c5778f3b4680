// Tables of numbers in .csv files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

/// A file whose first line names its columns. Fields are separated by commas; or, if the first line has none, by
/// semicolons or tabs. Blanks and quotes around them do not count, and neither does a byte-order mark.
class CsvTable {
 public:
  /// Reads the first line. Throws Error if the file cannot be read, is empty, names a column twice, or may need more
  /// memory than `max_memory` (as in ReadOptions).
  explicit CsvTable(std::filesystem::path path, std::uint64_t max_memory = 0);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(std::string_view name) const;
  /// Gives a column another name, if there is one. Throws Error if a column has that name already.
  void rename(std::string_view from, std::string_view to);
  /// The index of a column. Throws Error, with the columns that `needed` names, if it is missing.
  [[nodiscard]] std::size_t column(std::string_view name, std::string_view needed) const;
  /// Reads the other lines: the numbers in these columns, one line after another. Throws Error, with line
  /// and column, if one is no finite number.
  [[nodiscard]] std::vector<double> rows(std::span<const std::size_t> columns);
  /// Throws Error about the first line.
  [[noreturn]] void fail(std::string_view message) const;

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  char separator_ = ',';
  std::vector<std::string> names_;
};

}  // namespace dartcast
