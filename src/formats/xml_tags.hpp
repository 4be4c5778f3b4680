// The tags of an XML file, one after another, as expat finds them.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace dartcast {

struct XmlTag {
  std::string name;
  std::map<std::string, std::string> attributes;
  bool opens = false;   ///< else it closes, and has no attributes
  std::size_t end = 0;  ///< the byte after it
  std::size_t line = 0;

  /// An attribute, or another text if there is none.
  [[nodiscard]] std::string attribute(const std::string& key, const std::string& otherwise) const;
  /// Throws InvalidMesh with the tag's line.
  [[noreturn]] void fail(std::string_view message) const;
};

/// Calls visit(tag) for each tag; <name/> is two. The bytes between <AppendedData ...> and the last </AppendedData>
/// need not be XML, and are left out. Throws as visit(), and InvalidMesh, with the line, if the rest is not
/// well-formed, has a document type, or nests tags more than 64 deep. Entities would give the file a second meaning.
void read_xml(std::string_view content, const std::function<void(const XmlTag&)>& visit);

}  // namespace dartcast
