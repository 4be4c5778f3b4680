// Reads the tags of an XML file without expat, which is not built for WebAssembly: in UTF-8, without document types.
#include "formats/xml_tags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

constexpr std::size_t max_depth = 64;
constexpr std::string_view spaces = " \t\r\n";

class XmlReader {
 public:
  XmlReader(std::string_view content, const std::function<void(const XmlTag&)>& visit)
      : content_(content), visit_(visit), at_(content.starts_with("\xef\xbb\xbf") ? 3 : 0) {}

  void read() {
    bool any = false;
    for (;;) {
      const std::size_t next = std::min(content_.find('<', at_), content_.size());
      if (open_.empty() && content_.substr(at_, next - at_).find_first_not_of(spaces) != std::string_view::npos)
        fail("text outside of all tags");
      move_to(next);
      if (at_ == content_.size()) break;
      if (starts("<?")) {
        skip_past("?>");
      } else if (starts("<!--")) {
        skip_past("-->");
      } else if (starts("<![CDATA[")) {
        skip_past("]]>");
      } else if (starts("<!")) {
        throw InvalidMesh(fmt::format("line {}: a document type (<!DOCTYPE) is not supported", line_));
      } else if (starts("</")) {
        close();
      } else {
        if (any && open_.empty()) fail("junk after the document's element");
        any = true;
        open();
      }
    }
    if (!any || !open_.empty()) fail("no element found; the file is truncated or damaged");
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw InvalidMesh(fmt::format("line {}: this is no well-formed XML: {}", line_, what));
  }
  [[nodiscard]] bool starts(std::string_view with) const { return content_.substr(at_).starts_with(with); }
  void move_to(std::size_t to) {
    line_ += static_cast<std::size_t>(std::count(content_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                 content_.begin() + static_cast<std::ptrdiff_t>(to), '\n'));
    at_ = to;
  }
  void skip_past(std::string_view mark) {
    const std::size_t found = content_.find(mark, at_);
    if (found == std::string_view::npos) fail("unclosed token; the file is truncated or damaged");
    move_to(found + mark.size());
  }
  void skip_space() { move_to(std::min(content_.find_first_not_of(spaces, at_), content_.size())); }
  void expect(char c) {
    if (at_ == content_.size() || content_[at_] != c) fail("not well-formed (invalid token)");
    ++at_;
  }
  std::string name() {
    const std::size_t end = std::min(content_.find_first_of(" \t\r\n=/><\"'&", at_), content_.size());
    if (end == at_) fail("not well-formed (invalid token)");
    const std::string_view found = content_.substr(at_, end - at_);
    at_ = end;
    return std::string(found);
  }

  std::string value() {
    const char quote = at_ < content_.size() ? content_[at_] : ' ';
    if (quote != '"' && quote != '\'') fail("not well-formed (invalid token)");
    const std::size_t end = content_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail("unclosed token; the file is truncated or damaged");
    const std::string_view raw = content_.substr(at_ + 1, end - at_ - 1);
    if (raw.find('<') != std::string_view::npos) fail("not well-formed (invalid token)");
    std::string out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] != '&') {
        out += spaces.find(raw[i]) == std::string_view::npos ? raw[i] : ' ';
        continue;
      }
      const auto entity = std::find_if(entities.begin(), entities.end(),
                                       [&](const auto& e) { return raw.substr(i + 1).starts_with(e.first); });
      if (entity == entities.end()) fail("undefined entity");
      out += entity->second;
      i += entity->first.size();
    }
    move_to(end + 1);
    return out;
  }

  void open() {
    XmlTag tag;
    tag.opens = true;
    tag.line = line_;
    ++at_;
    tag.name = name();
    for (;;) {
      const std::size_t before = at_;
      skip_space();
      if (starts(">") || starts("/>")) break;
      if (at_ == before) fail("not well-formed (invalid token)");
      std::string key = name();
      skip_space();
      expect('=');
      skip_space();
      if (!tag.attributes.emplace(std::move(key), value()).second) fail("duplicate attribute");
    }
    const bool closes = content_[at_] == '/';
    move_to(at_ + (closes ? 2 : 1));
    tag.end = at_;
    if (open_.size() == max_depth) throw InvalidMesh(fmt::format("line {}: tags are nested too deeply", tag.line));
    visit_(tag);
    if (closes) return visit_({tag.name, {}, false, 0, line_});
    if (tag.name == "AppendedData") skip_appended();
    open_.push_back(std::move(tag.name));
  }

  void skip_appended() {
    const std::size_t end = content_.rfind("</AppendedData");
    if (end == std::string_view::npos || end < at_)
      throw InvalidMesh(fmt::format("line {}: the appended data are not closed; the file is truncated", line_));
    at_ = end;
  }

  void close() {
    at_ += 2;
    const std::string closed = name();
    skip_space();
    expect('>');
    if (open_.empty() || open_.back() != closed) fail("mismatched tag");
    open_.pop_back();
    visit_({closed, {}, false, 0, line_});
  }

  static constexpr std::array<std::pair<std::string_view, char>, 5> entities = {
      {{"lt;", '<'}, {"gt;", '>'}, {"amp;", '&'}, {"quot;", '"'}, {"apos;", '\''}}};

  std::string_view content_;
  const std::function<void(const XmlTag&)>& visit_;
  std::size_t at_;
  std::size_t line_ = 1;
  std::vector<std::string> open_;
};

}  // namespace

std::string XmlTag::attribute(const std::string& key, const std::string& otherwise) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? otherwise : found->second;
}

void XmlTag::fail(std::string_view message) const { throw InvalidMesh(fmt::format("line {}: {}", line, message)); }

void read_xml(std::string_view content, const std::function<void(const XmlTag&)>& visit) {
  XmlReader(content, visit).read();
}

}  // namespace dartcast
