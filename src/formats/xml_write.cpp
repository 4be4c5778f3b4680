// The header of VTK's XML files, and the appended data behind it.
#include "formats/xml_write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <string>

#include "formats/file_write.hpp"

namespace dartcast {

namespace {

std::string_view compressor(Compression compression) {
  switch (compression) {
    case Compression::none: return "";
    case Compression::fast: return " compressor=\"vtkLZ4DataCompressor\"";
    case Compression::small: return " compressor=\"vtkZLibDataCompressor\"";
  }
  return "";
}

constexpr std::string_view byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&apos;"; break;
      case '\t':
      case '\n':
      case '\r': out += fmt::format("&#{};", static_cast<int>(c)); break;
      default: out += c;
    }
  }
  return out;
}

// The text of a file and, one behind the other, the bytes that stand between its two parts.
class XmlFile {
 public:
  XmlFile(const XmlDataSet& data, Compression compression) : compression_(compression) {
    add("<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\"{}>\n",
        data.kind, byte_order, compressor(compression));
    add("<{}>\n", data.kind);
    if (!data.field.empty()) add_section("FieldData", data.field);
    add("<Piece");
    for (const auto& [name, count] : data.counts) add(" {}=\"{}\"", name, count);
    add(">\n");
    for (const XmlSection& section : data.sections) add_section(section.name, section.arrays);
    add("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", data.kind);
  }

  [[nodiscard]] std::vector<std::string_view> pieces() const {
    std::vector<std::string_view> pieces = {text_};
    pieces.insert(pieces.end(), appended_.begin(), appended_.end());
    pieces.emplace_back("\n</AppendedData>\n</VTKFile>\n");
    return pieces;
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), form, std::forward<Values>(values)...);
  }

  void add_section(std::string_view name, const std::vector<XmlArray>& arrays) {
    add("<{}>\n", name);
    for (const XmlArray& array : arrays) add_array(array);
    add("</{}>\n", name);
  }

  void add_array(const XmlArray& array) {
    add("<{} type=\"{}\" Name=\"{}\"", array.type() == "String" ? "Array" : "DataArray", array.type(),
        escaped(array.name()));
    if (array.components() != 1) add(" NumberOfComponents=\"{}\"", array.components());
    if (array.tuples() > 0) add(" NumberOfTuples=\"{}\"", array.tuples());
    add(" format=\"appended\" offset=\"{}\"/>\n", offset_);
    blocks_.push_back(array.block(compression_));
    for (const std::string_view bytes :
         {std::string_view(blocks_.back()->head),
          compression_ == Compression::none ? array.bytes() : std::string_view(blocks_.back()->packed)}) {
      appended_.push_back(bytes);
      offset_ += bytes.size();
    }
  }

  Compression compression_;
  std::string text_;
  std::vector<std::shared_ptr<const XmlBlock>> blocks_;
  std::vector<std::string_view> appended_;
  std::size_t offset_ = 0;
};

}  // namespace

XmlSection& XmlDataSet::section(std::string_view name) {
  return *std::find_if(sections.begin(), sections.end(), [&](const XmlSection& s) { return s.name == name; });
}

std::size_t XmlDataSet::bytes() const {
  std::size_t sum = 0;
  for (const XmlSection& section : sections) {
    for (const XmlArray& array : section.arrays) sum += array.bytes().size();
  }
  return sum;
}

void write_xml(const std::filesystem::path& path, const XmlDataSet& data, Compression compression, WritePieces write) {
  const XmlFile file(data, compression);
  write(path, file.pieces());
}

// VTK's names for a data set of pieces have a P in front. Cells and lines are in the pieces alone.
void write_xml_of_pieces(const std::filesystem::path& path, const XmlDataSet& data,
                         std::span<const std::string> pieces) {
  std::string text;
  const auto add = [&text]<class... Values>(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text), form, std::forward<Values>(values)...);
  };
  add("<?xml version=\"1.0\"?>\n<VTKFile type=\"P{}\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n",
      data.kind, byte_order);
  add("<P{} GhostLevel=\"0\">\n", data.kind);
  for (const XmlSection& section : data.sections) {
    if (section.name != "PointData" && section.name != "CellData" && section.name != "Points") continue;
    add("<P{}>\n", section.name);
    for (const XmlArray& a : section.arrays)
      add("<PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", a.type(), escaped(a.name()),
          a.components());
    add("</P{}>\n", section.name);
  }
  for (const std::string& piece : pieces) add("<Piece Source=\"{}\"/>\n", escaped(piece));
  add("</P{}>\n</VTKFile>\n", data.kind);
  const std::string_view whole = text;
  replace_file(path, {&whole, 1});
}

}  // namespace dartcast
