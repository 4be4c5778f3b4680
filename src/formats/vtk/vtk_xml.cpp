// Reads the pieces, sections and arrays of VTK's XML files.
#include "formats/vtk/vtk_xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "dartcast/error.hpp"
#include "formats/xml_tags.hpp"

namespace dartcast {
namespace {

constexpr std::array<std::string_view, 5> cell_sections = {"Cells", "Verts", "Lines", "Strips", "Polys"};

bool is_cell_section(std::string_view name) {
  return std::find(cell_sections.begin(), cell_sections.end(), name) != cell_sections.end();
}

bool is_section(std::string_view name) {
  return name == "Points" || name == "PointData" || name == "CellData" || is_cell_section(name);
}

bool is_array(std::string_view name) { return name == "DataArray" || name == "Array"; }

/// Reads one file's tags. `path_`: the tags that are open.
class VtkXmlReader {
 public:
  VtkXmlReader(std::string_view content, std::string_view kind) : content_(content), kind_(kind) {}

  VtkXmlFile read() {
    read_xml(content_, [&](const XmlTag& tag) {
      if (!tag.opens) return path_.pop_back();
      path_.empty() ? read_head(tag) : open(tag);
      path_.push_back(tag.name);
    });
    if (file_.pieces.empty()) throw InvalidMesh(fmt::format("the file has no <{}> with a <Piece>", kind_));
    for (const VtkXmlPiece& piece : file_.pieces) check_same_arrays(piece);
    return std::move(file_);
  }

 private:
  /// At most 2^60: sums of a few sizes do not overflow.
  static std::uint64_t size_of(const XmlTag& tag, const std::string& name, const std::string& otherwise) {
    const std::string text = tag.attribute(name, otherwise);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value > std::uint64_t{1} << 60U) {
      tag.fail(fmt::format("tag <{}>: {}=\"{}\" is not a size", tag.name, name, text.substr(0, 40)));
    }
    return value;
  }

  void read_head(const XmlTag& tag) {
    if (tag.name != "VTKFile") tag.fail("<VTKFile> should stand here");
    const std::string type = tag.attribute("type", "");
    if (type != kind_) {
      tag.fail(fmt::format("the data set is {}, not {}{}", type.substr(0, 40), kind_,
                           kind_ == "UnstructuredGrid" ? ": it has no volume cells to use" : ""));
    }
    const std::string version = tag.attribute("version", "0.1");
    if (version < "0" || version > "3" || (version.size() > 1 && version[1] != '.'))
      tag.fail(fmt::format("the version is '{}', not one of 0.1 to 2.9", version.substr(0, 40)));
    const std::string order = tag.attribute("byte_order", "LittleEndian");
    if (order != "LittleEndian" && order != "BigEndian") tag.fail("byte_order is neither LittleEndian nor BigEndian");
    const std::string header = tag.attribute("header_type", "UInt32");
    if (header != "UInt32" && header != "UInt64") tag.fail("header_type is neither UInt32 nor UInt64");
    file_.encoding.big_endian = order == "BigEndian";
    file_.encoding.header_bytes = header == "UInt64" ? 8 : 4;
    file_.encoding.compressor = tag.attribute("compressor", "");
  }

  void open(const XmlTag& tag) {
    const std::string& parent = path_.back();
    const bool in_section = is_section(parent) || parent == "FieldData";
    if (is_array(tag.name)) {
      if (!in_section) tag.fail("an array stands outside the sections of a piece");
      add_array(tag, parent);
    } else if (in_section) {
      tag.fail(fmt::format("<{}> stands in <{}>, which holds arrays alone", tag.name, parent));
    } else if (tag.name == kind_) {
      enter(tag, "VTKFile");
      if (tag.attributes.contains("TimeValues")) tag.fail("several times in one file are not supported");
    } else if (tag.name == "AppendedData") {
      enter(tag, "VTKFile");
      read_appended(tag);
    } else if (tag.name == "Piece") {
      expect_parent(tag, kind_);
      add_piece(tag);
    } else if (tag.name == "FieldData") {
      enter(tag, kind_);
    } else if (is_section(tag.name)) {
      enter(tag, "Piece");
      VtkXmlPiece& piece = file_.pieces.back();
      if (is_cell_section(tag.name) && !piece.items.contains(tag.name))
        tag.fail(fmt::format("<{}> is not a section of {}", tag.name, kind_));
      piece.sections[tag.name];
    }
  }

  void expect_parent(const XmlTag& tag, std::string_view parent) const {
    if (path_.back() != parent) tag.fail(fmt::format("<{}> should stand in <{}>", tag.name, parent));
  }

  /// A tag that stands once in its parent.
  void enter(const XmlTag& tag, std::string_view parent) {
    expect_parent(tag, parent);
    if (!once_.insert(tag.name).second) tag.fail(fmt::format("a second <{}> in the same <{}>", tag.name, parent));
  }

  void add_piece(const XmlTag& tag) {
    for (const std::string_view section : cell_sections) once_.erase(std::string(section));
    for (const char* section : {"Points", "PointData", "CellData"}) once_.erase(section);
    VtkXmlPiece& piece = file_.pieces.emplace_back();
    piece.items["Points"] = size_of(tag, "NumberOfPoints", "");
    for (const std::string_view section : cell_sections) {
      if ((section == "Cells") != (kind_ == "UnstructuredGrid")) continue;
      piece.items[std::string(section)] =
          size_of(tag, fmt::format("NumberOf{}", section), section == "Cells" ? "" : "0");
    }
  }

  /// The appended data, which need not be XML. They end before their last closing tag.
  void read_appended(const XmlTag& tag) {
    const std::size_t begin = content_.find_first_not_of(" \t\r\n", tag.end);
    const std::size_t end = content_.rfind("</AppendedData");
    if (begin >= end || content_[begin] != '_') tag.fail("the appended data do not start with '_' behind their tag");
    file_.encoding.appended = content_.substr(begin + 1, end - begin - 1);
    file_.encoding.appended_raw = tag.attribute("encoding", "base64") == "raw";
  }

  [[nodiscard]] VtuArray read_array(const XmlTag& tag, const std::string& section) const {
    VtuArray array;
    array.name = tag.attribute("Name", "");
    array.type = tag.attribute("type", "");
    array.format = tag.attribute("format", "ascii");
    // The points are the only array of their section; VTK's older writers give them no name.
    if (array.name.empty() && section != "Points")
      tag.fail(fmt::format("an array in <{}> has no name: give it one in Name=\"...\"", section));
    if (vtu_type_bytes(array.type) == 0)
      tag.fail(fmt::format("'{}' is not a type of numbers", array.type.substr(0, 40)));
    if (array.format != "ascii" && array.format != "binary" && array.format != "appended") {
      tag.fail(fmt::format("'{}' is not a format of data", array.format.substr(0, 40)));
    }
    array.components = size_of(tag, "NumberOfComponents", "1");
    array.tuples = size_of(tag, "NumberOfTuples", "0");
    array.offset = size_of(tag, "offset", array.format == "appended" ? "" : "0");
    if (array.components == 0 || array.components > 1000000) tag.fail("a number of components is out of range");
    if (tag.attributes.contains("TimeStep")) tag.fail("several times in one file are not supported");
    // VTK takes the text after the first '>' as the data.
    const std::size_t begin = content_.rfind('<', tag.end - 1);
    if (content_.find('>', begin) + 1 != tag.end) tag.fail("an array's tag has '>' in a value");
    array.text = content_.substr(tag.end, content_.find('<', tag.end) - tag.end);
    return array;
  }

  void add_array(const XmlTag& tag, const std::string& section) {
    const bool data = section == "PointData" || section == "CellData" || section == "FieldData";
    if (tag.name == "Array" && !data)
      tag.fail(fmt::format("<Array> stands in <{}>: it should be <DataArray>", section));
    std::vector<VtuArray>& arrays = section == "FieldData" ? file_.field : file_.pieces.back().sections[section];
    VtuArray array = read_array(tag, section);
    if (std::any_of(arrays.begin(), arrays.end(), [&](const VtuArray& a) { return a.name == array.name; })) {
      tag.fail(
          fmt::format("a second array '{}' in <{}>: each needs a name of its own", array.name.substr(0, 60), section));
    }
    arrays.push_back(std::move(array));
  }

  /// VTK makes the arrays of the first piece, and fills them from all pieces in their order.
  void check_same_arrays(const VtkXmlPiece& piece) const {
    for (const std::string_view section : {"Points", "PointData", "CellData"}) {
      const auto& own = piece.arrays(section);
      const auto& wanted = file_.pieces.front().arrays(section);
      const std::uint64_t items = section == "CellData" ? piece.cells() : piece.points();
      if (own.empty() && items == 0) continue;
      const auto same = [](const VtuArray& a, const VtuArray& b) {
        return a.name == b.name && a.type == b.type && a.components == b.components;
      };
      if (!std::equal(own.begin(), own.end(), wanted.begin(), wanted.end(), same)) {
        throw InvalidMesh(fmt::format(
            "the pieces of the file do not have the same arrays, of the same types, in the same order, in <{}>",
            section));
      }
    }
  }

  std::string_view content_;
  std::string_view kind_;
  VtkXmlFile file_;
  std::vector<std::string> path_;
  std::set<std::string, std::less<>> once_;
};

}  // namespace

std::uint64_t VtkXmlPiece::cells() const {
  std::uint64_t sum = 0;
  for (const auto& [section, count] : items) sum += section == "Points" ? 0 : count;
  return sum;
}

const std::vector<VtuArray>& VtkXmlPiece::arrays(std::string_view section) const {
  static const std::vector<VtuArray> empty;
  const auto found = sections.find(section);
  return found == sections.end() ? empty : found->second;
}

VtkXmlFile read_vtk_xml(std::string_view content, std::string_view kind) { return VtkXmlReader(content, kind).read(); }

}  // namespace dartcast
