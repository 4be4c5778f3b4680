// Reads a file's words and numbers, with the line or byte in every message.
#include "formats/file_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "base/digest.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string printable(std::string_view word) {
  std::string out(word.substr(0, 40));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

std::string in_lower_case(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

namespace {

std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

}  // namespace

std::string_view from_first_word(std::string_view content) {
  return content.substr(std::min(content.find_first_not_of(" \t\r\n"), content.size()));
}

std::string_view without_byte_order_mark(std::string_view content) {
  if (content.starts_with("\xff\xfe") || content.starts_with("\xfe\xff"))
    throw InvalidMesh("byte 0: the text is in UTF-16; save it in UTF-8 or ASCII");
  return content.starts_with("\xef\xbb\xbf") ? content.substr(3) : content;
}

std::uint64_t file_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size =
      std::filesystem::is_regular_file(path, error) ? std::filesystem::file_size(path, error) : 0;
  return error ? 0 : size;
}

void refuse_zeros(const std::filesystem::path& path) {
  if (file_bytes(path) == 0) return;  // a pipe would wait
  std::ifstream in(path, std::ios::binary);
  std::array<char, 4096> first{};
  in.read(first.data(), first.size());
  const std::string_view bytes(first.data(), static_cast<std::size_t>(in.gcount()));
  if (!bytes.empty() && bytes.find_first_not_of('\0') == std::string_view::npos)
    throw InvalidMesh(
        fmt::format("the first {} bytes are zeros: it is damaged, or has never been written", bytes.size()));
}

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InvalidMesh("no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InvalidMesh("not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) throw InvalidMesh("the file cannot be opened; check its permissions");
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) throw InvalidMesh("the file cannot be read to its end");
  return bytes;
}

std::uint64_t file_digest(const std::filesystem::path& path) {
  if (file_bytes(path) == 0) return 0;
  const std::string bytes = read_bytes(path);
  return digest(bytes);
}

bool FileText::at_end() {
  while (position_ < text_.size()) {
    if (is_space(text_[position_])) {
      ++position_;
    } else if (comment_ != '\0' && text_[position_] == comment_) {
      line();
    } else {
      return false;
    }
  }
  return true;
}

std::string_view FileText::peek() {
  if (at_end()) return {};
  std::size_t end = position_;
  while (end < text_.size() && !is_space(text_[end])) ++end;
  return text_.substr(position_, end - position_);
}

std::string_view FileText::word(std::string_view what) {
  const std::string_view found = peek();
  if (found.empty()) fail(fmt::format("the file ends where {} should stand; it is truncated", what));
  position_ += found.size();
  return found;
}

std::string_view FileText::line() {
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  std::string_view found = text_.substr(position_, end - position_);
  position_ = std::min(end + 1, text_.size());
  if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
  return found;
}

bool FileText::line_ends() const {
  std::size_t at = position_;
  while (at < text_.size() && text_[at] != '\n' && is_space(text_[at])) ++at;
  return at >= text_.size() || text_[at] == '\n';
}

std::int64_t FileText::integer(std::string_view what, std::int64_t low, std::int64_t high) {
  const std::string_view found = without_plus(word(what));
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
  if (error == std::errc::invalid_argument || end != found.data() + found.size()) {
    fail(fmt::format("'{}' is not a whole number, where {} should stand", printable(found), what));
  }
  if (error != std::errc() || value < low || value > high) {
    fail(fmt::format("{} is out of range as {}", printable(found), what));
  }
  return value;
}

template <class Real>
Real FileText::number(std::string_view what) {
  const std::string_view found = without_plus(word(what));
  Real value = 0;
  const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
  if (error == std::errc::invalid_argument || end != found.data() + found.size()) {
    fail(fmt::format("'{}' is not a number, where {} should stand", printable(found), what));
  }
  if (error != std::errc::result_out_of_range) return value;
  if constexpr (sizeof(Real) == sizeof(float)) return std::strtof(std::string(found).c_str(), nullptr);
  return static_cast<Real>(std::strtod(std::string(found).c_str(), nullptr));
}
template float FileText::number(std::string_view what);
template double FileText::number(std::string_view what);

void FileText::check_count(std::string_view what, std::uint64_t n, std::size_t bytes_each) const {
  if (n > left() / bytes_each) {
    fail(fmt::format("{} {} are announced, but only {} bytes are left in the file; it is truncated or damaged", n, what,
                     left()));
  }
}

std::size_t FileText::count(std::string_view what, std::size_t bytes_each) {
  const auto n = static_cast<std::uint64_t>(integer(fmt::format("the number of {}", what), 0, INT64_MAX));
  check_count(what, n, bytes_each);
  return n;
}

std::string_view FileText::raw(std::size_t n, std::string_view what) {
  if (n > left()) fail_at_byte(fmt::format("the file ends within {}; it is truncated", what));
  position_ += n;
  return text_.substr(position_ - n, n);
}

void FileText::skip_past(std::string_view mark) {
  const std::size_t found = text_.find(mark, position_);
  if (found == std::string_view::npos) fail(fmt::format("'{}' is missing; the file is truncated", printable(mark)));
  position_ = found + mark.size();
}

void FileText::fail(std::string_view message) const {
  const std::string_view before = text_.substr(0, position_);
  throw InvalidMesh(fmt::format("line {}: {}", 1 + std::count(before.begin(), before.end(), '\n'), message));
}

void FileText::fail_at_byte(std::string_view message) const {
  throw InvalidMesh(fmt::format("byte {}: {}", position_, message));
}

}  // namespace dartcast
