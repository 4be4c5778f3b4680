// The tags of an XML file, one after another. This part of XML suffices for VTK's files.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

struct XmlTag {
  std::string name;
  std::map<std::string, std::string> attributes;  ///< values with entities decoded, and white space as blanks
  bool opens = false;                             ///< <name ...>; with `closes`: <name .../>
  bool closes = false;                            ///< </name>
  std::size_t end = 0;                            ///< the byte after it
};

/// Reads tags and checks that they are nested. Errors are InvalidMesh with the line.
class XmlTags {
 public:
  explicit XmlTags(std::string_view content) : content_(content) {}

  /// The next tag, comments and processing instructions left out; false at the end of the file. Throws where a tag is
  /// damaged, closes another one than the last opened, or is open at the end, and at declarations, because entities
  /// that they define would give the file a second meaning.
  bool next(XmlTag& tag);

  /// Moves to a byte, over content that is not XML.
  void move_to(std::size_t position) { position_ = position; }

  [[noreturn]] void fail(std::string_view message) const;

 private:
  void read_attributes(std::string_view inside, XmlTag& tag) const;
  [[nodiscard]] std::string decoded(std::string_view value) const;
  bool skip_comment();
  void nest(const XmlTag& tag);

  std::string_view content_;
  std::size_t position_ = 0;
  std::vector<std::string> open_;
};

}  // namespace dartcast
