// Reads the tags of an XML file with expat, around VTK's appended data.
#include "formats/xml_tags.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

constexpr std::size_t max_depth = 64;
constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;

[[noreturn]] void fail_in_line(std::size_t line, std::string_view message) {
  throw InvalidMesh(fmt::format("line {}: {}", line, message));
}

/// Exceptions must not pass through expat: they wait here until it returns.
class XmlReader {
 public:
  XmlReader(std::string_view content, const std::function<void(const XmlTag&)>& visit)
      : content_(content), visit_(visit), parser_(XML_ParserCreate(nullptr), &XML_ParserFree) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &on_open, &on_close);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &on_document_type);
  }

  void read() {
    const std::size_t tag = content_.find("<AppendedData");
    const std::size_t begin = std::min(content_.find('>', tag), content_.size() - 1) + 1;
    if (tag == std::string_view::npos || begin == content_.size()) return feed(content_, true);
    const std::size_t end = content_.rfind("</AppendedData");
    feed(content_.substr(0, begin), false);
    if (end == std::string_view::npos || end < begin)
      fail_in_line(line(), "the appended data are not closed; the file is truncated");
    feed(content_.substr(end), true);
  }

 private:
  [[nodiscard]] std::size_t line() const { return XML_GetCurrentLineNumber(parser_.get()); }

  void feed(std::string_view text, bool last) {
    for (;;) {
      const std::string_view chunk = text.substr(0, chunk_bytes);
      text.remove_prefix(chunk.size());
      const bool ends = last && text.empty();
      const XML_Status status = XML_Parse(parser_.get(), chunk.data(), static_cast<int>(chunk.size()), ends ? 1 : 0);
      if (error_) std::rethrow_exception(error_);
      if (status != XML_STATUS_OK)
        fail_in_line(line(),
                     fmt::format("this is no well-formed XML: {}{}", XML_ErrorString(XML_GetErrorCode(parser_.get())),
                                 ends ? "; the file is truncated or damaged" : ""));
      if (text.empty()) return;
    }
  }

  template <class Work>
  static void guarded(void* data, Work&& work) {
    auto& self = *static_cast<XmlReader*>(data);
    if (self.error_) return;
    try {
      work(self);
    } catch (...) {
      self.error_ = std::current_exception();
      XML_StopParser(self.parser_.get(), XML_FALSE);
    }
  }
  static void on_open(void* data, const XML_Char* name, const XML_Char** attributes) {
    guarded(data, [&](XmlReader& self) { self.open(name, attributes); });
  }
  static void on_close(void* data, const XML_Char* name) {
    guarded(data, [&](XmlReader& self) {
      --self.depth_;
      self.visit_({name, {}, false, 0, self.line()});
    });
  }
  static void on_document_type(void* data, const XML_Char* /*name*/, const XML_Char* /*system*/,
                               const XML_Char* /*public_id*/, int /*internal*/) {
    guarded(data,
            [](const XmlReader& self) { fail_in_line(self.line(), "a document type (<!DOCTYPE) is not supported"); });
  }

  void open(const XML_Char* name, const XML_Char** attributes) {
    if (++depth_ > max_depth) fail_in_line(line(), "tags are nested too deeply");
    XmlTag tag{name, {}, true, 0, line()};
    for (; *attributes != nullptr; attributes += 2) tag.attributes.emplace(attributes[0], attributes[1]);
    tag.end = static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())) +
              static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get()));
    visit_(tag);
  }

  std::string_view content_;
  const std::function<void(const XmlTag&)>& visit_;
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  std::size_t depth_ = 0;
  std::exception_ptr error_;
};

}  // namespace

std::string XmlTag::attribute(const std::string& key, const std::string& otherwise) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? otherwise : found->second;
}

void XmlTag::fail(std::string_view message) const { fail_in_line(line, message); }

void read_xml(std::string_view content, const std::function<void(const XmlTag&)>& visit) {
  XmlReader(content, visit).read();
}

}  // namespace dartcast
