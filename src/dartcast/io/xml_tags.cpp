#include "dartcast/io/xml_tags.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/base/error.hpp"

namespace dartcast {
namespace {

constexpr std::string_view spaces = " \t\r\n";

/// The byte behind the '>' that ends the tag which starts at `from`; npos where there is none. '>' may stand in quotes.
std::size_t tag_end(std::string_view text, std::size_t from) {
  char quote = '\0';
  for (std::size_t i = from; i < text.size(); ++i) {
    if (quote != '\0') {
      if (text[i] == quote) quote = '\0';
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '>') {
      return i + 1;
    }
  }
  return std::string_view::npos;
}

}  // namespace

void XmlTags::fail(std::string_view message) const {
  const std::string_view before = content_.substr(0, position_);
  throw InvalidMesh(fmt::format("line {}: {}", 1 + std::count(before.begin(), before.end(), '\n'), message));
}

void XmlTags::read_attributes(std::string_view inside, XmlTag& tag) const {
  std::size_t at = inside.find_first_not_of(spaces);
  while (at != std::string_view::npos) {
    const std::size_t equals = inside.find('=', at);
    if (equals == std::string_view::npos) fail(fmt::format("tag <{}> has an attribute without a value", tag.name));
    std::string_view key = inside.substr(at, equals - at);
    key = key.substr(0, key.find_last_not_of(spaces) + 1);
    const std::size_t open = inside.find_first_not_of(spaces, equals + 1);
    if (open == std::string_view::npos || (inside[open] != '"' && inside[open] != '\'')) {
      fail(fmt::format("tag <{}> has a value without quotes", tag.name));
    }
    const std::size_t close = inside.find(inside[open], open + 1);
    if (close == std::string_view::npos) fail(fmt::format("tag <{}> has a quote that is not closed", tag.name));
    if (!tag.attributes.emplace(key, inside.substr(open + 1, close - open - 1)).second) {
      fail(fmt::format("tag <{}> has an attribute twice", tag.name));
    }
    at = inside.find_first_not_of(spaces, close + 1);
  }
}

void XmlTags::nest(const XmlTag& tag) {
  if (tag.opens && !tag.closes) {
    if (open_.size() >= 64) fail("tags are nested too deeply");
    open_.push_back(tag.name);
  } else if (tag.closes && !tag.opens) {
    if (open_.empty() || open_.back() != tag.name) fail(fmt::format("</{}> closes no open tag", tag.name));
    open_.pop_back();
  }
}

bool XmlTags::next(XmlTag& tag) {
  for (;;) {
    const std::size_t begin = content_.find('<', position_);
    if (begin == std::string_view::npos) {
      if (!open_.empty()) fail(fmt::format("the file ends before </{}>; it is truncated", open_.back()));
      return false;
    }
    position_ = begin;
    const bool comment = content_.substr(begin, 4) == "<!--";
    const std::size_t found = comment ? content_.find("-->", begin) : tag_end(content_, begin);
    if (found == std::string_view::npos) fail("a tag is not closed; the file is truncated");
    const std::size_t end = comment ? found + 3 : found;
    const char second = begin + 1 < content_.size() ? content_[begin + 1] : '\0';
    if (second == '!' || second == '?') {
      position_ = end;
      continue;
    }
    std::string_view inside = content_.substr(begin + 1, end - begin - 2);
    tag = {};
    tag.end = end;
    tag.closes = !inside.empty() && (inside.front() == '/' || inside.back() == '/');
    tag.opens = inside.empty() || inside.front() != '/';
    if (tag.closes && tag.opens) inside.remove_suffix(1);
    if (!tag.opens) inside.remove_prefix(1);
    const std::size_t name_end = std::min(inside.find_first_of(spaces), inside.size());
    tag.name = inside.substr(0, name_end);
    if (tag.name.empty() || tag.name.size() > 64) fail("a tag without a proper name");
    read_attributes(inside.substr(name_end), tag);
    nest(tag);
    position_ = end;
    return true;
  }
}

}  // namespace dartcast
