// Reads legacy .vtk files: a head, then sections of points, cells and arrays, ASCII or big-endian.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/raw_number.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk/vtk_grid.hpp"

namespace dartcast {
namespace {

/// A name as VTK reads it: %41 is A, and a '%' among the last two characters is dropped. None if VTK would read
/// beyond the name's end, would read a character from uninitialized memory, or would cut the name.
std::optional<std::string> decoded(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '%') {
      out += name[i];
      continue;
    }
    if (name.size() < 3) return std::nullopt;
    if (i + 3 > name.size()) continue;
    unsigned c = 0;
    const char* const digits = name.data() + i + 1;
    if (std::from_chars(digits, digits + 2, c, 16).ptr != digits + 2 || c == 0) return std::nullopt;
    out += static_cast<char>(c);
    i += 2;
  }
  return out;
}

struct NumberType {
  std::string_view name;
  std::size_t bytes;  // in binary; 0: eight to a byte
  bool real;
  std::int64_t low;
  std::int64_t high;
};

constexpr std::array<NumberType, 15> number_types = {{{"bit", 0, false, 0, 1},
                                                      {"char", 1, false, INT8_MIN, INT8_MAX},
                                                      {"signed_char", 1, false, INT8_MIN, INT8_MAX},
                                                      {"unsigned_char", 1, false, 0, UINT8_MAX},
                                                      {"short", 2, false, INT16_MIN, INT16_MAX},
                                                      {"unsigned_short", 2, false, 0, UINT16_MAX},
                                                      {"int", 4, false, INT32_MIN, INT32_MAX},
                                                      {"unsigned_int", 4, false, 0, UINT32_MAX},
                                                      {"vtkidtype", 4, false, INT32_MIN, INT32_MAX},
                                                      {"long", 8, false, INT64_MIN, INT64_MAX},
                                                      {"unsigned_long", 8, false, 0, INT64_MAX},
                                                      {"vtktypeint64", 8, false, INT64_MIN, INT64_MAX},
                                                      {"vtktypeuint64", 8, false, 0, INT64_MAX},
                                                      {"float", 4, true, 0, 0},
                                                      {"double", 8, true, 0, 0}}};

/// A number of a type in binary.
double raw_value(const NumberType& type, std::string_view raw) {
  constexpr auto order = std::endian::big;
  if (type.name == "float") return raw_number<float>(raw, order);
  if (type.name == "double") return raw_number<double>(raw, order);
  const auto value = [&]<class T>(T /*type*/) { return static_cast<double>(raw_number<T>(raw, order)); };
  const bool positive = type.low == 0;
  switch (type.bytes) {
    case 1: return positive ? value(std::uint8_t()) : value(std::int8_t());
    case 2: return positive ? value(std::uint16_t()) : value(std::int16_t());
    case 4: return positive ? value(std::uint32_t()) : value(std::int32_t());
    default: return positive ? value(std::uint64_t()) : value(std::int64_t());
  }
}

class LegacyReader {
 public:
  LegacyReader(std::string_view content, std::uint64_t max_memory)
      : content_(content), text_(content), max_memory_(max_memory) {
    sizes_.file = content.size();
  }

  VtkGrid read() {
    head();
    while (!text_.at_end()) section();
    if (!cells_.has_value()) text_.fail("the file ends before its CELLS; it is truncated");
    if (!types_.has_value()) text_.fail("the file ends before its CELL_TYPES; it is truncated");
    add_cells();
    return std::move(grid_);
  }

 private:
  struct Cells {
    std::vector<std::int64_t> offsets;
    std::vector<std::int64_t> points;
  };

  void head() {
    const std::string_view first = text_.line();
    if (first.substr(0, 23) != "# vtk DataFile Version ") text_.fail("'# vtk DataFile Version' should stand here");
    // From version 5 on VTK expects offsets, before that a stream of corners, whatever the file has.
    const std::string_view version = first.substr(23, first.find_last_not_of(' ') - 22);
    if (version.size() != 3 || version[0] < '1' || version[0] > '5' || version[1] != '.' || version[2] < '0' ||
        version[2] > '9') {
      text_.fail("the version is not one of 1.0 to 5.9");
    }
    with_offsets_ = version[0] == '5';
    text_.line();  // the title
    const std::string kind = in_lower_case(text_.word("ASCII or BINARY"));
    if (kind != "ascii" && kind != "binary") text_.fail("ASCII or BINARY should stand here");
    binary_ = kind == "binary";
    if (!binary_ && content_.find_first_of("\f\v") != std::string_view::npos)
      throw InvalidMesh("the file has form feeds or vertical tabs, which VTK takes for text: write line ends");
    if (in_lower_case(text_.word("DATASET")) != "dataset") text_.fail("DATASET should stand here");
    const std::string data_set(text_.word("the kind of data set"));
    if (in_lower_case(data_set) != "unstructured_grid") {
      text_.fail(fmt::format("the data set is {}, not UNSTRUCTURED_GRID: it has no volume cells to use",
                             data_set.substr(0, 40)));
    }
  }

  void section() {
    const std::string name = in_lower_case(text_.word("a section"));
    if (name == "points") {
      if (points_.has_value()) text_.fail("a second section of points");
      points_ = text_.count("points", binary_ ? 3 : 6);
      sizes_.points = *points_;
      const std::vector<double> xyz = data("points", *points_, 3, type());
      grid_.points.reserve(*points_);
      for (std::size_t i = 0; i < xyz.size(); i += 3) grid_.points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
      if (*points_ >= no_point) text_.fail("more than 2^32 - 2 points");
    } else if (name == "cells") {
      read_cells();
    } else if (name == "cell_types") {
      read_types();
    } else if (name == "point_data" || name == "cell_data") {
      const auto owners = name == "point_data" ? points_ : cell_count();
      owner_ = name == "point_data" ? Owner::points : Owner::cells;
      items_ = static_cast<std::uint64_t>(text_.integer("a number of items", 0, INT64_MAX));
      if (!owners.has_value() || *owners != items_)
        text_.fail("the number of data items is not that of the points or cells");
    } else if (name == "metadata") {
      metadata();
    } else {
      attribute(name);
    }
  }

  void attribute(const std::string& name) {
    if (name == "field") return field();
    if (name == "lookup_table") return lookup_table();
    const std::string array = take_name(short_word("the name of an array"));
    if (name == "color_scalars") {
      const auto components = static_cast<std::uint64_t>(text_.integer("a number of components", 1, 4));
      return add_array(array, items_, components, find_type(binary_ ? "unsigned_char" : "float"));
    }
    if (name == "texture_coordinates") {
      const auto dimension = static_cast<std::uint64_t>(text_.integer("a dimension", 1, 3));
      return add_array(array, items_, dimension, type());
    }
    const NumberType& kind = type();
    if (name == "scalars") {
      std::uint64_t components = 1;
      if (!text_.line_ends()) components = static_cast<std::uint64_t>(text_.integer("a number of components", 1, 4));
      if (in_lower_case(text_.word("LOOKUP_TABLE")) != "lookup_table") text_.fail("LOOKUP_TABLE should stand here");
      short_word("the name of a table");
      return add_array(array, items_, components, kind);
    }
    if (name == "vectors" || name == "normals") return add_array(array, items_, 3, kind);
    if (name == "tensors") return add_array(array, items_, 9, kind);
    if (name == "tensors6") return add_array(array, items_, 6, kind);
    if (name == "global_ids" || name == "pedigree_ids" || name == "edge_flags")
      return add_array(array, items_, 1, kind);
    text_.fail(fmt::format("'{}' is not a section of a legacy VTK file", name.substr(0, 40)));
  }

  std::vector<VtkArray>& arrays_here() {
    if (owner_ == Owner::file) return grid_.field;
    return owner_ == Owner::points ? grid_.point_data : grid_.cell_data;
  }

  void add_array(const std::string& name, std::uint64_t items, std::uint64_t components, const NumberType& kind) {
    std::vector<double> values = data(name, items, components, kind);
    arrays_here().push_back({name, std::max<std::size_t>(components, 1), false, std::move(values), {}});
  }

  /// VTK keeps one table of arrays for the points, one for the cells and one for the file. If two arrays have one
  /// name, it keeps the last.
  std::string take_name(std::string_view word) {
    static constexpr std::array<std::string_view, 3> places = {"of the file", "at the points", "at the cells"};
    const auto owner = static_cast<std::size_t>(owner_);
    std::string name = checked_text(word);
    if (!names_[owner].insert(name).second) {
      text_.fail(
          fmt::format("a second array '{}' {}: each needs a name of its own", name.substr(0, 60), places[owner]));
    }
    return name;
  }

  /// VTK reads 255 characters of a word, and the rest as the next one.
  std::string_view short_word(std::string_view what) {
    const std::string_view word = text_.word(what);
    if (word.size() > 255) text_.fail(fmt::format("{} has more than 255 characters", what));
    return word;
  }

  [[nodiscard]] std::string checked_text(std::string_view word) const {
    const std::optional<std::string> text = decoded(word);
    if (word.find('\0') != std::string_view::npos) text_.fail("a name or text holds a zero byte");
    if (!text.has_value()) text_.fail("a '%' in a name or text is not followed by the two digits of a character");
    return *text;
  }

  void field() {
    short_word("the name of a field");
    const std::size_t arrays = text_.count("arrays", 1);
    for (std::size_t i = 0; i < arrays; ++i) {
      if (in_lower_case(text_.peek()).starts_with("metadata")) metadata();  // VTK looks at eight letters
      const std::string_view word = short_word("the name of an array");
      if (word == "NULL_ARRAY") continue;
      const std::string name = take_name(word);
      const auto components = static_cast<std::uint64_t>(text_.integer("a number of components", 0, INT32_MAX));
      const auto items = static_cast<std::uint64_t>(text_.integer("a number of items", 0, INT64_MAX));
      if (in_lower_case(text_.peek()) == "string") {
        text_.word("a type");
        arrays_here().push_back({name, 1, true, {}, texts(items, components)});
      } else {
        add_array(name, items, components, type());
      }
    }
  }

  /// Texts: in ASCII one on a line; in binary each after its length.
  std::vector<std::string> texts(std::uint64_t items, std::uint64_t components) {
    components_ = 1;
    text_.check_count("texts", items, 1);
    if (components != 1) text_.fail("an array of texts must have one component");
    take_memory(64 * items);
    text_.line();
    std::vector<std::string> out;
    for (std::uint64_t i = 0; i < items; ++i) {
      if (!binary_) {
        if (text_.left() == 0) text_.fail("the file ends within an array of texts; it is truncated");
        out.push_back(checked_text(text_.line()));
      } else {
        out.emplace_back(text_.raw(text_length(), "an array of texts"));
      }
    }
    return out;
  }

  /// The two highest bits of the first byte give the number of bytes of the length: 3 one, 2 two, 1 four, 0 eight.
  std::size_t text_length() {
    const auto first = static_cast<unsigned char>(text_.raw(1, "a text's length")[0]);
    std::size_t length = first & 0x3fU;
    for (std::size_t more = (std::size_t{1} << (3U - (first >> 6U))) - 1; more > 0; --more) {
      length = (length << 8U) | static_cast<unsigned char>(text_.raw(1, "a text's length")[0]);
    }
    return length;
  }

  void lookup_table() {
    short_word("the name of a table");
    const std::size_t size = text_.count("colours", binary_ ? 4 : 8);
    data("colours", size, 4, find_type(binary_ ? "unsigned_char" : "float"));
  }

  /// After an array: lines up to an empty one. VTK goes by the number of components and by the keys it knows, across
  /// empty lines, too. So only lines that it surely reads in the same way are accepted.
  void metadata() {
    text_.line();
    while (text_.left() > 0) {
      const std::string line = in_lower_case(text_.line());
      if (line.empty()) return;
      if (line.starts_with("component_names")) {
        for (std::uint64_t k = 0; k < components_; ++k) {
          if (text_.left() == 0) text_.fail("the file ends within the names of components; it is truncated");
          (void)checked_text(text_.line());
        }
      } else if (line.starts_with("information ")) {
        FileText count(std::string_view(line).substr(12));
        const std::int64_t keys = count.integer("a number of keys", 0, INT32_MAX);
        for (std::int64_t k = 0; k < keys; ++k) information();
      } else {
        text_.fail(fmt::format("'{}' is not known in METADATA", line.substr(0, 40)));
      }
    }
  }

  /// One key of an array, with its value.
  void information() {
    if (text_.word("NAME") != "NAME") text_.fail("NAME should stand here");
    const std::string_view key = short_word("a key");
    if (text_.word("LOCATION") != "LOCATION") text_.fail("LOCATION should stand here");
    const bool known = short_word("a class") == "vtkDataArray" && text_.line_ends();
    const bool range = key == "L2_NORM_RANGE" || key == "L2_NORM_FINITE_RANGE";
    if (!known || (!range && key != "UNITS_LABEL"))
      text_.fail(fmt::format("the key '{}' is not known in METADATA", key.substr(0, 40)));
    if (text_.word("DATA") != "DATA") text_.fail("DATA should stand here");
    if (range) {
      text_.integer("the number of a range's ends", 2, 2);
      for (int end = 0; end < 2; ++end) finite_number<double>("a range's end");
    } else {
      if (text_.line_ends()) text_.fail("a unit should stand here");
      (void)checked_text(short_word("a unit"));
    }
    if (!text_.line_ends()) text_.fail("the line should end behind a key's value");
    text_.line();
  }

  const NumberType& find_type(std::string_view name) {
    const std::string wanted = in_lower_case(name);
    const auto* found =
        std::find_if(number_types.begin(), number_types.end(), [&](const NumberType& t) { return t.name == wanted; });
    if (found == number_types.end())
      text_.fail(fmt::format("'{}' is not a type of numbers that can be read", wanted.substr(0, 40)));
    return *found;
  }
  const NumberType& type() { return find_type(text_.word("a type of numbers")); }

  /// Counts bytes for decoded arrays, before they are taken.
  void take_memory(std::uint64_t bytes) {
    sizes_.decoded += bytes;
    check_memory(memory_of_vtk(sizes_), max_memory_);
  }

  /// Reads items x components numbers.
  std::vector<double> data(std::string_view what, std::uint64_t items, std::uint64_t components,
                           const NumberType& kind) {
    text_.check_count(what, items, 1);
    text_.check_count(what, components, 1);
    if (components != 0 && items > UINT64_MAX / components) text_.fail("an array is too large");
    const std::uint64_t n = items * components;
    components_ = components;
    if (binary_) {
      text_.line();
      const std::uint64_t bytes = kind.bytes == 0 ? n / 8 + (n % 8 != 0 ? 1 : 0) : n;
      text_.check_count(what, bytes, std::max<std::size_t>(kind.bytes, 1));
    } else {
      text_.check_count(what, n, 1);
    }
    sizes_.values += n;
    take_memory(n * std::max<std::size_t>(kind.bytes, 1));
    return binary_ ? binary_numbers(what, n, kind) : ascii_numbers(what, n, kind);
  }

  std::vector<double> binary_numbers(std::string_view what, std::uint64_t n, const NumberType& kind) {
    std::vector<double> out(n);
    const std::string_view raw = text_.raw(kind.bytes == 0 ? (n + 7) / 8 : n * kind.bytes, what);
    for (std::uint64_t i = 0; i < n; ++i)
      out[i] = kind.bytes == 0 ? (static_cast<unsigned char>(raw[i / 8]) >> (7U - i % 8)) & 1U
                               : raw_value(kind, raw.substr(i * kind.bytes, kind.bytes));
    return out;
  }

  std::vector<double> ascii_numbers(std::string_view what, std::uint64_t n, const NumberType& kind) {
    std::vector<double> out(n);
    for (double& x : out) {
      if (!kind.real) {
        x = static_cast<double>(text_.integer(what, kind.low, kind.high));
        continue;
      }
      x = kind.bytes == 4 ? finite_number<float>(what) : finite_number<double>(what);
    }
    return out;
  }

  template <class Real>
  Real finite_number(std::string_view what) {
    const Real x = text_.number<Real>(what);
    if (!(x - x == 0)) text_.fail(fmt::format("a number of {} is not finite", what));
    return x;
  }

  std::vector<std::int64_t> integers(std::string_view what, std::size_t n, const NumberType& kind) {
    if (kind.real || kind.bytes < 4) text_.fail("a type of whole numbers of 4 or 8 bytes should stand here");
    text_.check_count(what, n, binary_ ? kind.bytes : 2);
    components_ = 1;
    std::vector<std::int64_t> out;
    out.reserve(n);
    if (!binary_) {
      for (std::size_t i = 0; i < n; ++i) out.push_back(text_.integer(what, kind.low, kind.high));
      return out;
    }
    text_.line();
    const std::string_view raw = text_.raw(n * kind.bytes, what);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view bytes = raw.substr(i * kind.bytes, kind.bytes);
      out.push_back(kind.bytes == 8 ? raw_number<std::int64_t>(bytes, std::endian::big)
                                    : raw_number<std::int32_t>(bytes, std::endian::big));
    }
    return out;
  }

  [[nodiscard]] std::optional<std::size_t> cell_count() const {
    return cells_.has_value() ? std::optional(cells_->offsets.size() - 1) : std::nullopt;
  }

  void read_cells() {
    if (cells_.has_value()) text_.fail("a second section of cells");
    const std::size_t first = text_.count("cells", 1);
    const std::size_t second = text_.count("corners", 1);
    sizes_.cells = first;
    sizes_.corners = second;
    take_memory(0);
    Cells cells;
    if (with_offsets_) {
      if (in_lower_case(text_.word("OFFSETS")) != "offsets") text_.fail("OFFSETS should stand here");
      cells.offsets = integers("offsets", first, type());
      if (in_lower_case(text_.word("CONNECTIVITY")) != "connectivity") text_.fail("CONNECTIVITY should stand here");
      cells.points = integers("corners", second, type());
      if (cells.offsets.empty() || cells.offsets.front() != 0 ||
          !std::is_sorted(cells.offsets.begin(), cells.offsets.end()) ||
          cells.offsets.back() != static_cast<std::int64_t>(second)) {
        text_.fail("the cells' offsets do not ascend from 0 to the number of corners");
      }
    } else {
      const auto stream = integers("corners", second, find_type("int"));
      cells.offsets.reserve(first + 1);
      cells.points.reserve(second);
      cells.offsets.push_back(0);
      for (std::size_t at = 0; at < stream.size();) {
        const std::int64_t n = stream[at++];
        if (n < 0 || n > static_cast<std::int64_t>(stream.size() - at)) {
          text_.fail(fmt::format("cell {} has {} corners, more than the section holds", cells.offsets.size() - 1, n));
        }
        cells.points.insert(cells.points.end(), stream.begin() + static_cast<std::ptrdiff_t>(at),
                            stream.begin() + static_cast<std::ptrdiff_t>(at) + n);
        cells.offsets.push_back(static_cast<std::int64_t>(cells.points.size()));
        at += static_cast<std::size_t>(n);
      }
      if (cells.offsets.size() != first + 1) text_.fail("the number of cells is not the one announced");
    }
    cells_ = std::move(cells);
  }

  void read_types() {
    if (types_.has_value()) text_.fail("a second section of cell types");
    const std::size_t n = text_.count("cell types", binary_ ? 4 : 2);
    if (!cells_.has_value() || cells_->offsets.size() != n + 1)
      text_.fail("the number of cell types is not that of the cells");
    types_ = integers("cell types", n, find_type("int"));
    for (std::size_t c = 0; c < n; ++c) {
      if ((*types_)[c] < 0 || (*types_)[c] > 255)
        text_.fail(fmt::format("cell {} has the unknown type {}", c, (*types_)[c]));
    }
  }

  void add_cells() {
    const PointRange range{0, grid_.points.size()};
    const std::size_t n = types_->size();
    if (n >= no_point) throw InvalidMesh("more than 2^32 - 2 cells");
    grid_.types.reserve(n);
    grid_.offsets.reserve(n + 1);
    grid_.connectivity.reserve(cells_->points.size());
    for (std::size_t c = 0; c < n; ++c) {
      const auto begin = static_cast<std::size_t>(cells_->offsets[c]);
      const auto end = static_cast<std::size_t>(cells_->offsets[c + 1]);
      add_cell(static_cast<std::uint8_t>((*types_)[c]), std::span(cells_->points).subspan(begin, end - begin), range,
               grid_);
    }
  }

  const std::string_view content_;
  FileText text_;
  const std::uint64_t max_memory_;
  VtkGrid grid_;
  bool binary_ = false;
  bool with_offsets_ = false;
  std::optional<std::size_t> points_;
  std::optional<Cells> cells_;
  std::optional<std::vector<std::int64_t>> types_;
  std::uint64_t items_ = 0;
  std::uint64_t components_ = 1;  // components of the last array
  enum class Owner : std::uint8_t { file, points, cells } owner_ = Owner::file;
  std::array<std::set<std::string>, 3> names_;  // by owner
  ReadSizes sizes_;
};

}  // namespace

VtkGrid read_legacy_grid(std::string_view content, std::uint64_t max_memory) {
  return LegacyReader(content, max_memory).read();
}

}  // namespace dartcast
