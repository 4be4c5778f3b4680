// Reads tables of numbers from .csv files.
#include "formats/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"

namespace dartcast {

namespace {

// The character between the fields of a table whose first line this is.
char separator_in(std::string_view line) {
  for (const char c : {',', ';', '\t'}) {
    if (line.find(c) != std::string_view::npos) return c;
  }
  return ',';
}

// A number, with a sign or without, and with the exponents of C or of Fortran (1.0D+00). None where the text is none.
std::optional<double> number_in(std::string_view text) {
  std::string plain(text.substr(text.starts_with('+') ? 1 : 0));
  if (const std::size_t exponent = plain.find_first_of("dD"); exponent != std::string::npos) plain[exponent] = 'e';
  double value = 0.0;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (error != std::errc() || end != plain.data() + plain.size() || plain.empty()) return std::nullopt;
  return value;
}

std::vector<std::string_view> fields(std::string_view line, char separator) {
  std::vector<std::string_view> result;
  constexpr std::string_view around = " \t\r\"";
  while (true) {
    const std::size_t end = line.find(separator);
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
  std::string_view head;
  try {
    check_memory(memory_of_text(file_bytes(path_)), max_memory);
    head = without_byte_order_mark(line);
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the file cannot be read: {}", path_.string(), e.what()));
  }
  separator_ = separator_in(head);
  for (const std::string_view name : fields(head, separator_)) {
    if (has(name)) fail(fmt::format("there are two columns '{}'; the first line must name each once", name));
    names_.emplace_back(name);
  }
}

void CsvTable::rename(std::string_view from, std::string_view to) {
  if (!has(from)) return;
  if (has(to)) fail(fmt::format("the columns '{}' and '{}' say the same; name one of them", from, to));
  *std::find(names_.begin(), names_.end(), from) = to;
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
    const auto texts = fields(line, separator_);
    for (const std::size_t c : columns) {
      const std::string_view text = c < texts.size() ? texts[c] : std::string_view();
      const std::optional<double> value = number_in(text);
      if (!value || !std::isfinite(*value))
        throw Error(fmt::format("{}:{}: column '{}': '{}' is not {}", path_.string(), number, names_[c], text,
                                value ? "finite" : "a number"));
      values.push_back(*value);
    }
  }
  return values;
}

void CsvTable::fail(std::string_view message) const { throw Error(fmt::format("{}:1: {}", path_.string(), message)); }

}  // namespace dartcast
