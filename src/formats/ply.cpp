// Reads Stanford's .ply: the header, then each element in ASCII or binary.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/file_text.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/raw_number.hpp"
#include "formats/surface_formats.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

struct PlyType {
  std::string_view name, other_name;
  std::size_t size;
  bool whole;
  double (*read)(std::string_view bytes, std::endian order);  // any value is exact as a double
};

template <class T>
double ply_number(std::string_view bytes, std::endian order) {
  return static_cast<double>(raw_number<T>(bytes, order));
}

constexpr std::array<PlyType, 8> ply_types = {{{"char", "int8", 1, true, ply_number<std::int8_t>},
                                               {"uchar", "uint8", 1, true, ply_number<std::uint8_t>},
                                               {"short", "int16", 2, true, ply_number<std::int16_t>},
                                               {"ushort", "uint16", 2, true, ply_number<std::uint16_t>},
                                               {"int", "int32", 4, true, ply_number<std::int32_t>},
                                               {"uint", "uint32", 4, true, ply_number<std::uint32_t>},
                                               {"float", "float32", 4, false, ply_number<float>},
                                               {"double", "float64", 8, false, ply_number<double>}}};

enum class PlyRole : std::uint8_t { none, x, y, z, corners };

struct PlyProperty {
  PlyRole role = PlyRole::none;
  const PlyType* type = nullptr;
  const PlyType* count = nullptr;  // for a list: the type of its length
};

enum class PlyKind : std::uint8_t { other, vertex, face };

struct PlyElement {
  PlyKind kind = PlyKind::other;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has(PlyRole role) const {
    return std::any_of(properties.begin(), properties.end(), [&](const PlyProperty& p) { return p.role == role; });
  }
};

struct PlyHeader {
  std::optional<std::endian> order;  // none: ASCII
  std::vector<PlyElement> elements;

  [[nodiscard]] bool has(PlyKind kind) const {
    return std::any_of(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.kind == kind; });
  }
};

void read_ply_format(FileText& text, PlyHeader& header) {
  const std::string_view format = text.word("a format");
  if (format == "binary_little_endian") {
    header.order = std::endian::little;
  } else if (format == "binary_big_endian") {
    header.order = std::endian::big;
  } else if (format != "ascii") {
    text.fail("the format should be ascii, binary_little_endian or binary_big_endian");
  }
  if (text.word("the version") != "1.0") text.fail("only version 1.0 of the format is supported");
}

void read_ply_element(FileText& text, PlyHeader& header) {
  const std::string_view name = text.word("an element's name");
  PlyElement element;
  if (name == "vertex") element.kind = PlyKind::vertex;
  if (name == "face") element.kind = PlyKind::face;
  if (element.kind != PlyKind::other && header.has(element.kind)) text.fail("a second element of this name");
  element.count = static_cast<std::uint64_t>(text.integer("a number of elements", 0, INT64_MAX));
  header.elements.push_back(std::move(element));
}

const PlyType* read_ply_type(FileText& text) {
  const std::string_view name = text.word("a type");
  const auto* found = std::find_if(ply_types.begin(), ply_types.end(),
                                   [&](const PlyType& t) { return t.name == name || t.other_name == name; });
  if (found == ply_types.end()) text.fail("an unknown type; char, uchar, short, ushort, int, uint, float, double are");
  return found;
}

PlyRole ply_role(std::string_view name, PlyKind kind, bool list) {
  if (kind == PlyKind::face && list && (name == "vertex_indices" || name == "vertex_index")) return PlyRole::corners;
  if (kind != PlyKind::vertex || list) return PlyRole::none;
  if (name == "x") return PlyRole::x;
  if (name == "y") return PlyRole::y;
  return name == "z" ? PlyRole::z : PlyRole::none;
}

void read_ply_property(FileText& text, PlyHeader& header) {
  if (header.elements.empty()) text.fail("a property stands before the first element");
  PlyElement& element = header.elements.back();
  PlyProperty property;
  if (text.peek() == "list") {
    text.word("'list'");
    property.count = read_ply_type(text);
    if (!property.count->whole) text.fail("the length of a list should be of a type of whole numbers");
  }
  property.type = read_ply_type(text);
  property.role = ply_role(text.word("a property's name"), element.kind, property.count != nullptr);
  if (property.role == PlyRole::corners && !property.type->whole)
    text.fail("corners of faces should be of a type of whole numbers");
  if (property.role != PlyRole::none && element.has(property.role)) text.fail("a second property of this name");
  element.properties.push_back(property);
}

void check_ply_header(const FileText& text, const PlyHeader& header) {
  for (const PlyElement& e : header.elements) {
    if (e.kind == PlyKind::vertex && !(e.has(PlyRole::x) && e.has(PlyRole::y) && e.has(PlyRole::z)))
      text.fail("the element vertex should have properties x, y and z");
    if (e.kind == PlyKind::face && !e.has(PlyRole::corners))
      text.fail("the element face should have a list vertex_indices or vertex_index");
  }
  if (!header.has(PlyKind::vertex)) text.fail("there is no element vertex");
  if (!header.has(PlyKind::face))
    text.fail("there is no element face; clouds of points and strips of triangles are not supported");
}

/// Leaves the text at the first byte of the data.
PlyHeader read_ply_header(FileText& text) {
  if (text.word("'ply'") != "ply") text.fail("'ply' should stand here");
  if (text.word("'format'") != "format") text.fail("'format' should stand here");
  PlyHeader header;
  read_ply_format(text, header);
  for (;;) {
    const std::string_view word = text.word("'end_header'");
    if (word == "end_header") break;
    if (word == "comment" || word == "obj_info") {
      text.line();
    } else if (word == "element") {
      read_ply_element(text, header);
    } else if (word == "property") {
      read_ply_property(text, header);
    } else {
      text.fail("'element', 'property', 'comment' or 'end_header' should stand here");
    }
  }
  if (!text.line_ends()) text.fail("the line should end behind 'end_header'");
  check_ply_header(text, header);
  text.line();
  return header;
}

/// The data behind the header, number by number.
class PlyData {
 public:
  PlyData(FileText& text, std::optional<std::endian> order) : text_(text), order_(order) {}

  [[nodiscard]] bool binary() const { return order_.has_value(); }
  [[nodiscard]] const FileText& text() const { return text_; }

  [[noreturn]] void fail(std::string_view message) const {
    if (binary()) text_.fail_at_byte(message);
    text_.fail(message);
  }
  double number(const PlyType& type, std::string_view what) {
    return binary() ? type.read(text_.raw(type.size, what), *order_) : text_.number(what);
  }
  std::int64_t whole(const PlyType& type, std::string_view what) {
    return binary() ? static_cast<std::int64_t>(type.read(text_.raw(type.size, what), *order_))
                    : text_.integer(what, INT64_MIN, INT64_MAX);
  }
  /// At least as many bytes as an element takes: the last one of a text may end without white space.
  [[nodiscard]] std::size_t min_bytes(const PlyElement& element) const {
    if (!binary()) return 2 * element.properties.size() - 1;
    std::size_t sum = 0;
    for (const PlyProperty& p : element.properties) sum += p.count != nullptr ? p.count->size : p.type->size;
    return sum;
  }
  void skip(const PlyProperty& property) {
    const std::int64_t n = property.count != nullptr ? whole(*property.count, "a list's length") : 1;
    if (n < 0) fail(fmt::format("a list of {} numbers", n));
    if (binary()) {
      text_.raw(static_cast<std::size_t>(n) * property.type->size, "a property");
    } else {
      for (std::int64_t i = 0; i < n; ++i) text_.word("a number");
    }
  }

 private:
  FileText& text_;
  std::optional<std::endian> order_;
};

void read_ply_vertex(PlyData& data, const PlyElement& element, ParsedSurface& surface) {
  Vec3 p;
  for (const PlyProperty& property : element.properties) {
    if (property.role == PlyRole::none) {
      data.skip(property);
    } else {
      const double value = data.number(*property.type, "a coordinate");
      (property.role == PlyRole::x ? p.x : property.role == PlyRole::y ? p.y : p.z) = value;
    }
  }
  surface.add_point(p, data.text(), data.binary());
}

void read_ply_face(PlyData& data, const PlyElement& element, ParsedSurface& surface,
                   std::vector<std::uint32_t>& corners) {
  for (const PlyProperty& property : element.properties) {
    if (property.role == PlyRole::none) {
      data.skip(property);
      continue;
    }
    const std::int64_t n = data.whole(*property.count, "a number of corners");
    if (n < 0 || n > polyhedron_limit) data.fail(fmt::format("a face of {} corners; it may have 3 to 1000", n));
    corners.clear();
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t id = data.whole(*property.type, "a corner");
      corners.push_back(id >= 0 && id < no_point ? static_cast<std::uint32_t>(id) : no_point);
    }
    surface.add_face(corners, data.text(), data.binary());
  }
}

void read_ply_elements(PlyData& data, const PlyElement& element, ParsedSurface& surface) {
  if (element.properties.empty()) return;  // no bytes, however many there are
  constexpr std::array<std::string_view, 3> names = {"elements", "vertices", "faces"};
  data.text().check_count(names[static_cast<std::size_t>(element.kind)], element.count, data.min_bytes(element));
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (element.kind == PlyKind::vertex) {
      read_ply_vertex(data, element, surface);
    } else if (element.kind == PlyKind::face) {
      read_ply_face(data, element, surface, corners);
    } else {
      for (const PlyProperty& property : element.properties) data.skip(property);
    }
  }
}

}  // namespace

ParsedSurface parse_ply(std::string_view content) {
  FileText text(content);
  const PlyHeader header = read_ply_header(text);
  PlyData data(text, header.order);
  ParsedSurface surface;
  surface.format =
      !header.order ? "PLY ASCII"
                    : (*header.order == std::endian::little ? "PLY binary, little endian" : "PLY binary, big endian");
  for (const PlyElement& element : header.elements) read_ply_elements(data, element, surface);
  if (!text.at_end()) data.fail("the file goes on behind its last element: it has more than it announces");
  surface.finish();
  return surface;
}

}  // namespace dartcast
