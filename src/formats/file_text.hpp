// A file in memory, read number by number, with checks of ranges, and of counts against the bytes that remain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace dartcast {

/// The size of a regular file; 0 if there is none.
std::uint64_t file_bytes(const std::filesystem::path& path);

/// All bytes of a regular file. Throws InvalidMesh if it cannot be read.
std::string read_bytes(const std::filesystem::path& path);

/// A number for these bytes (base/digest.hpp); 0 if there are none. Throws as read_bytes().
std::uint64_t file_digest(const std::filesystem::path& path);

/// Throws InvalidMesh if a regular file starts with zeros, so that a sparse file is not read for nothing. Its first
/// 4096 bytes are looked at.
void refuse_zeros(const std::filesystem::path& path);

/// The content behind a byte-order mark of UTF-8. Throws InvalidMesh if it starts with one of UTF-16.
std::string_view without_byte_order_mark(std::string_view content);

bool is_space(char c);

/// For messages: a word cut short, without bytes that a terminal would take for commands.
std::string printable(std::string_view word);

std::string in_lower_case(std::string_view word);

/// The content from its first byte that is not white space.
std::string_view from_first_word(std::string_view content);

/// Reads words and numbers from text, and raw bytes in between. Errors are InvalidMesh and name the line, or in binary
/// parts the byte.
class FileText {
 public:
  explicit FileText(std::string_view text) : text_(text) {}

  /// Skips white space and comments that run from `comment` to the end of the line; true if nothing is left.
  bool at_end();
  void set_comment(char c) { comment_ = c; }

  /// The next word without consuming it; empty at the end.
  std::string_view peek();
  /// The next word. Throws at the end of the file.
  std::string_view word(std::string_view what);
  /// The rest of the current line, without its end.
  std::string_view line();
  /// Whether a line's end comes before the next word.
  [[nodiscard]] bool line_ends() const;

  std::int64_t integer(std::string_view what, std::int64_t low, std::int64_t high);
  /// Real: double or float. A number that a float cannot hold is infinite.
  template <class Real = double>
  Real number(std::string_view what);
  /// A count of items that take at least `bytes_each` bytes each in the rest of the file.
  std::size_t count(std::string_view what, std::size_t bytes_each);
  /// Throws if `n` items cannot fit into the rest of the file.
  void check_count(std::string_view what, std::uint64_t n, std::size_t bytes_each) const;

  /// The next n bytes as they are.
  std::string_view raw(std::size_t n, std::string_view what);
  /// Moves behind the next occurrence of `mark`; throws if there is none.
  void skip_past(std::string_view mark);

  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t left() const { return text_.size() - position_; }
  void move_to(std::size_t position) { position_ = position; }

  [[noreturn]] void fail(std::string_view message) const;
  [[noreturn]] void fail_at_byte(std::string_view message) const;

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  char comment_ = '\0';
};

}  // namespace dartcast
