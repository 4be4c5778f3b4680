// The text of a data set, the same from VTK and from us.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace dartcast::test {

/// Lines of words. Numbers are bits.
class CanonicalText {
 public:
  void line(std::string_view word) { out_ += (out_.empty() ? "" : "\n") + name_of(word); }
  void number(double x) {
    char text[24];
    std::snprintf(text, sizeof text, " %llx", static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(x)));
    out_ += text;
  }
  void size(std::size_t n) { out_ += " " + std::to_string(n); }
  void text(std::string_view text) { out_ += " " + name_of(text); }
  /// A point, or x where there is none of this number.
  void point(std::int64_t id, std::size_t points) {
    const bool known = id >= 0 && static_cast<std::uint64_t>(id) < points;
    out_ += known ? " " + std::to_string(id) : " x";
  }
  [[nodiscard]] const std::string& text() const { return out_; }

 private:
  static std::string name_of(std::string_view name) {
    std::string out;
    for (const char c : name)
      out += c > ' ' && c < '\x7f' ? std::string(1, c) : "%" + std::to_string(static_cast<unsigned char>(c));
    return "'" + out + "'";
  }

  std::string out_;
};

}  // namespace dartcast::test
