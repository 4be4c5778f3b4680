// Reads the tags of an XML file one after another.
#include "formats/xml_tags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include "dartcast/error.hpp"

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

void append_utf8(std::string& out, std::uint32_t c) {
  if (c < 0x80U) {
    out += static_cast<char>(c);
    return;
  }
  const int more = c < 0x800U ? 1 : (c < 0x10000U ? 2 : 3);
  constexpr std::array<std::uint32_t, 4> marks = {0, 0xc0, 0xe0, 0xf0};
  out += static_cast<char>(marks[static_cast<std::size_t>(more)] | (c >> (6U * static_cast<unsigned>(more))));
  for (int k = more - 1; k >= 0; --k)
    out += static_cast<char>(0x80U | ((c >> (6U * static_cast<unsigned>(k))) & 0x3fU));
}

/// Appends the character that an entity stands for, as "amp" or "#65"; false where it is not known.
bool append_entity(std::string& out, std::string_view entity) {
  constexpr std::array<std::pair<std::string_view, char>, 5> named = {
      {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
  for (const auto& [name, character] : named) {
    if (entity != name) continue;
    out += character;
    return true;
  }
  if (!entity.starts_with('#')) return false;
  entity.remove_prefix(1);
  const bool hexadecimal = entity.starts_with('x');
  if (hexadecimal) entity.remove_prefix(1);
  std::uint32_t c = 0;
  const auto [end, error] = std::from_chars(entity.data(), entity.data() + entity.size(), c, hexadecimal ? 16 : 10);
  if (error != std::errc() || end != entity.data() + entity.size() || c == 0 || c > 0x10ffffU) return false;
  append_utf8(out, c);
  return true;
}

}  // namespace

std::string XmlTags::decoded(std::string_view value) const {
  std::string out;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] == '&') {
      const std::size_t end = value.find(';', i);
      if (end == std::string_view::npos || !append_entity(out, value.substr(i + 1, end - i - 1)))
        fail("a value has '&' that starts no known character");
      i = end;
    } else if (value[i] != '\r' || i + 1 == value.size() || value[i + 1] != '\n') {
      out += spaces.find(value[i]) == std::string_view::npos ? value[i] : ' ';
    }
  }
  return out;
}

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
    if (!tag.attributes.emplace(key, decoded(inside.substr(open + 1, close - open - 1))).second) {
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

bool XmlTags::skip_comment() {
  const std::string_view rest = content_.substr(position_);
  std::string_view end;
  if (rest.starts_with("<!--")) {
    end = "-->";
  } else if (rest.starts_with("<?")) {
    end = "?>";
  } else {
    if (rest.starts_with("<!")) fail("a declaration (<!DOCTYPE, <![CDATA[) is not supported");
    return false;
  }
  const std::size_t found = rest.find(end);
  if (found == std::string_view::npos) fail("a tag is not closed; the file is truncated");
  position_ += found + end.size();
  return true;
}

bool XmlTags::next(XmlTag& tag) {
  for (;;) {
    const std::size_t begin = content_.find('<', position_);
    if (begin == std::string_view::npos) {
      if (!open_.empty()) fail(fmt::format("the file ends before </{}>; it is truncated", open_.back()));
      return false;
    }
    position_ = begin;
    if (skip_comment()) continue;
    const std::size_t end = tag_end(content_, begin);
    if (end == std::string_view::npos) fail("a tag is not closed; the file is truncated");
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
