// Writes legacy .vtk: the arrays of write_vtu(), big-endian, in sections.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "formats/file_write.hpp"
#include "formats/vtk.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {
namespace {

/// A name without blanks: %41 is A.
std::string encoded(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool plain = c > ' ' && c < '\x7f' && c != '"' && c != '%';
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out.empty() ? "unnamed" : out;
}

class LegacyText {
 public:
  template <class... Values>
  void line(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), form, std::forward<Values>(values)...);
    text_ += '\n';
  }
  /// Numbers of so many bytes each, as they are in memory.
  void numbers(std::string_view bytes, std::size_t each) {
    const std::size_t begin = text_.size();
    text_ += bytes;
    if constexpr (std::endian::native == std::endian::little) {
      for (std::size_t at = begin; at < text_.size(); at += each)
        std::reverse(text_.begin() + static_cast<std::ptrdiff_t>(at),
                     text_.begin() + static_cast<std::ptrdiff_t>(at + each));
    }
    text_ += '\n';
  }
  template <class T>
  void numbers(const std::vector<T>& values) {
    numbers({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}, sizeof(T));
  }
  /// A text behind its length: 62 bits in eight bytes, of which the first starts with two zeros.
  void text(std::string_view characters) {
    for (unsigned shift = 64; shift > 0; shift -= 8)
      text_ += static_cast<char>(characters.size() >> (shift - 8) & 0xffU);
    text_ += characters;
  }
  [[nodiscard]] std::string_view all() const { return text_; }

 private:
  std::string text_;
};

/// A polyhedron's corners are its face stream here, else they are those of the .vtu file.
void add_cells(const MeshData& mesh, std::string_view types, LegacyText& to) {
  const std::size_t n = mesh.cell_count() + mesh.patch_tags.size();
  std::vector<std::int64_t> offsets = {0};
  std::vector<std::int64_t> ids;
  for (std::size_t c = 0; c < n; ++c) {
    const auto corners = c < mesh.cell_count() ? mesh.cell(c) : mesh.patch_face(c - mesh.cell_count());
    ids.insert(ids.end(), corners.begin(), corners.end());
    if (c < mesh.cell_count() && mesh.types[c] == CellType::prism) {
      std::swap(ids[ids.size() - 5], ids[ids.size() - 4]);
      std::swap(ids[ids.size() - 2], ids[ids.size() - 1]);
    }
    offsets.push_back(static_cast<std::int64_t>(ids.size()));
  }
  to.line("CELLS {} {}", n + 1, ids.size());
  to.line("OFFSETS vtktypeint64");
  to.numbers(offsets);
  to.line("CONNECTIVITY vtktypeint64");
  to.numbers(ids);
  to.line("CELL_TYPES {}", n);
  to.numbers(std::vector<std::int32_t>(types.begin(), types.end()));
}

/// Field data: texts, each behind its length. In the .vtu file each is ended by a 0.
void add_field(const std::vector<XmlArray>& arrays, LegacyText& to) {
  if (arrays.empty()) return;
  to.line("FIELD FieldData {}", arrays.size());
  for (const XmlArray& a : arrays) {
    std::string_view left = a.bytes();
    to.line("{} 1 {} string", encoded(a.name()), std::count(left.begin(), left.end(), '\0'));
    while (!left.empty()) {
      const std::string_view text = left.substr(0, left.find('\0'));
      to.text(text);
      left.remove_prefix(text.size() + 1);
    }
    to.line("");
  }
}

void add_arrays(std::string_view section, std::size_t items, const std::vector<XmlArray>& arrays, LegacyText& to) {
  if (arrays.empty()) return;
  to.line("{} {}", section, items);
  to.line("FIELD FieldData {}", arrays.size());
  for (const XmlArray& a : arrays) {
    const bool real = a.type() == "Float64";
    const bool byte = a.type() == "UInt8";
    to.line("{} {} {} {}", encoded(a.name()), a.components(), items, real ? "double" : byte ? "unsigned_char" : "int");
    to.numbers(a.bytes(), real ? 8 : byte ? 1 : 4);
  }
}

}  // namespace

void write_legacy_vtk(const MeshData& mesh, const std::filesystem::path& path) {
  XmlDataSet data = vtu_data_set(std::shared_ptr<const MeshData>(std::shared_ptr<const void>(), &mesh));
  LegacyText to;
  to.line("# vtk DataFile Version 5.1\ndartcast\nBINARY\nDATASET UNSTRUCTURED_GRID");
  add_field(data.field, to);
  to.line("POINTS {} double", mesh.points.size());
  to.numbers(data.section("Points").arrays.front().bytes(), sizeof(double));
  add_cells(mesh, data.section("Cells").arrays.at(2).bytes(), to);
  add_arrays("CELL_DATA", mesh.cell_count() + mesh.patch_tags.size(), data.section("CellData").arrays, to);
  add_arrays("POINT_DATA", mesh.points.size(), data.section("PointData").arrays, to);
  const std::string_view text = to.all();
  write_pieces(path, {&text, 1});
}

}  // namespace dartcast
