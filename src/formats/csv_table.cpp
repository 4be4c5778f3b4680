// Reads tables of numbers from .csv files.
#include "formats/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"

namespace dartcast {

namespace {

std::vector<std::string_view> fields(std::string_view line) {
  std::vector<std::string_view> result;
  constexpr std::string_view around = " \t\r\"";
  while (true) {
    const std::size_t end = line.find(',');
    std::string_view field = line.substr(0, end);
    field.remove_prefix(std::min(field.find_first_not_of(around), field.size()));
    field = field.substr(0, field.find_last_not_of(around) + 1);
    result.push_back(field);
    if (end == std::string_view::npos) return result;
    line.remove_prefix(end + 1);
  }
}

}  // namespace

CsvTable::CsvTable(std::filesystem::path path, std::uint64_t max_memory) : path_(std::move(path)), file_(path_) {
  std::string line;
  if (!std::getline(file_, line)) throw Error(fmt::format("{}: the file cannot be read, or is empty", path_.string()));
  try {
    check_memory(memory_of_text(file_bytes(path_)), max_memory);
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the file cannot be read: {}", path_.string(), e.what()));
  }
  for (const std::string_view name : fields(line)) {
    if (has(name)) fail(fmt::format("there are two columns '{}'; name each once", name));
    names_.emplace_back(name);
  }
}

bool CsvTable::has(std::string_view name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::size_t CsvTable::column(std::string_view name, std::string_view needed) const {
  if (!has(name)) fail(fmt::format("there is no column '{}'; the first line must name the columns {}", name, needed));
  return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
}

std::vector<double> CsvTable::rows(std::span<const std::size_t> columns) {
  std::vector<double> values;
  std::string line;
  for (std::size_t number = 2; std::getline(file_, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto texts = fields(line);
    for (const std::size_t c : columns) {
      const std::string_view text = c < texts.size() ? texts[c] : std::string_view();
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), values.emplace_back());
      const bool number_read = error == std::errc() && end == text.data() + text.size() && !text.empty();
      if (!number_read || !std::isfinite(values.back()))
        throw Error(
            fmt::format("{}:{}: '{}' is not {}", path_.string(), number, text, number_read ? "finite" : "a number"));
    }
  }
  return values;
}

void CsvTable::fail(std::string_view message) const { throw Error(fmt::format("{}:1: {}", path_.string(), message)); }

}  // namespace dartcast
