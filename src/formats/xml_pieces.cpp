// Reads the names of pieces.
#include "formats/xml_pieces.hpp"

#include <fmt/format.h>

#include "formats/xml_tags.hpp"

namespace dartcast {

std::vector<std::filesystem::path> named_pieces(const std::filesystem::path& path, const std::string& text,
                                                std::string_view ending) {
  std::vector<std::filesystem::path> pieces;
  read_xml(text, [&](const XmlTag& tag) {
    if (tag.name != "Piece" || !tag.opens) return;
    const std::string source = tag.attribute("Source", "");
    if (source.starts_with('/') || source.find("..") != std::string::npos || !source.ends_with(ending))
      tag.fail(fmt::format("the piece '{}' is no {} file in this folder or one in it", source, ending));
    pieces.push_back(path.parent_path() / source);
  });
  return pieces;
}

}  // namespace dartcast
