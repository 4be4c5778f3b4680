// Reads Medit's binary .meshb section by section. Each says where the next one begins.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/medit.hpp"
#include "formats/medit_elements.hpp"
#include "formats/raw_number.hpp"
#include "formats/second_order.hpp"

namespace dartcast {
namespace {

constexpr int dimension_code = 3;
constexpr int vertices_code = 4;
constexpr int end_code = 54;

class MeshbReader {
 public:
  MeshbReader(std::string_view content, bool linearise) : text_(content) { parsed_.linearise = linearise; }

  ParsedMesh read() {
    read_version();
    while (text_.left() > 0) {
      const std::int32_t code = int32("a keyword");
      if (code == end_code) break;
      const std::uint64_t next = version_ >= 3 ? static_cast<std::uint64_t>(raw<std::int64_t>("the place of a section"))
                                               : static_cast<std::uint32_t>(int32("the place of a section"));
      read_section(code);
      if (next == 0) break;
      if (next < text_.position() || next > text_.position() + text_.left())
        text_.fail_at_byte(fmt::format("the next section is to begin at byte {}, which is not behind this one", next));
      text_.move_to(next);
    }
    const MeshData& mesh = parsed_.mesh;
    if (mesh.types.empty() && mesh.patch_tags.empty() && parsed_.second_order.count == 0)
      throw InvalidMesh("the file has no cells; it is truncated, or has points and edges only");
    parsed_.format = "Medit binary";
    finish(parsed_);
    return std::move(parsed_);
  }

 private:
  template <class T>
  T raw(std::string_view what) {
    return raw_number<T>(text_.raw(sizeof(T), what), order_);
  }
  std::int32_t int32(std::string_view what) { return raw<std::int32_t>(what); }
  std::int64_t integer(std::string_view what) { return version_ == 4 ? raw<std::int64_t>(what) : int32(what); }
  double real(std::string_view what) {
    return version_ == 1 ? static_cast<double>(raw<float>(what)) : raw<double>(what);
  }

  void read_version() {
    constexpr std::int32_t turned = 1 << 24;
    const std::int32_t mark = int32("the mark of the format");
    if (mark != 1 && mark != turned) text_.fail_at_byte("this .meshb is not of Medit: it does not begin with 1");
    if (mark == turned) order_ = order_ == std::endian::little ? std::endian::big : std::endian::little;
    version_ = int32("the version");
    if (version_ < 1 || version_ > 4) text_.fail_at_byte(fmt::format("version {}: 1 to 4 are read", version_));
  }

  void read_section(std::int32_t code) {
    if (code == dimension_code) {
      dimension_ = int32("the dimension");
      if (dimension_ != 2 && dimension_ != 3) text_.fail_at_byte(fmt::format("dimension {}", dimension_));
    } else if (code == vertices_code) {
      read_vertices();
    } else {
      const auto* section = std::find_if(medit_sections.begin(), medit_sections.end(),
                                         [&](const MeditSection& s) { return s.code == code; });
      if (section != medit_sections.end()) read_elements(*section);
    }
  }

  std::size_t count(std::string_view what, std::size_t bytes_each) {
    const std::int64_t n = integer(what);
    if (n < 0 || static_cast<std::uint64_t>(n) > text_.left() / bytes_each)
      text_.fail_at_byte(
          fmt::format("{} {} are announced, but only {} bytes are left in the file; it is truncated or "
                      "damaged",
                      n, what, text_.left()));
    return static_cast<std::size_t>(n);
  }

  void read_vertices() {
    if (dimension_ == 0) text_.fail_at_byte("Vertices stand before Dimension");
    if (!parsed_.mesh.points.empty()) text_.fail_at_byte("a second section of Vertices");
    const std::size_t reals = version_ == 1 ? 4 : 8;
    const std::size_t integers = version_ == 4 ? 8 : 4;
    const std::size_t n = count("vertices", static_cast<std::size_t>(dimension_) * reals + integers);
    if (n >= no_point) text_.fail_at_byte("more than 2^32 - 2 vertices");
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 p;
      p.x = real("a coordinate");
      p.y = real("a coordinate");
      if (dimension_ == 3) p.z = real("a coordinate");
      integer("a reference");
      parsed_.mesh.points.push_back(p);
    }
  }

  void read_elements(const MeditSection& section) {
    const std::size_t n = count(section.name, (section.points + 1) * (version_ == 4 ? 8 : 4));
    std::array<std::uint32_t, 8> corners{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < section.points; ++k) {
        const std::int64_t number = integer("a vertex number");
        if (k < section.corners)
          corners[k] = number >= 1 && number <= no_point ? static_cast<std::uint32_t>(number - 1) : no_point;
      }
      const std::int64_t reference = integer("a reference");
      if (reference < INT32_MIN || reference > INT32_MAX)
        text_.fail_at_byte(fmt::format("the reference {} does not fit into 32 bits", reference));
      add_medit_element(section, std::span(corners).first(section.corners), static_cast<std::int32_t>(reference), i,
                        parsed_);
    }
  }

  FileText text_;
  std::endian order_ = std::endian::native;
  std::int32_t version_ = 0;
  std::int32_t dimension_ = 0;
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh parse_meshb(std::string_view content, bool linearise) { return MeshbReader(content, linearise).read(); }

}  // namespace dartcast
