// One file of OpenFOAM: its header, words, numbers and lists, as ASCII or binary, compressed or not.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// More than any label: points, faces and cells are numbered with 32 bits here.
inline constexpr std::uint64_t no_label_limit = 0xffffffffU;

/// Whether the folder has the file, or the file with .gz.
bool has_foam_file(const std::filesystem::path& folder, std::string_view name);

/// The class that the header of the file gives, as "volVectorField"; empty if there is no such header.
std::string foam_class(const std::filesystem::path& folder, std::string_view name);

/// Lists of labels, one after another: list i is labels[offsets[i] .. offsets[i + 1]).
struct FoamLists {
  std::vector<std::size_t> offsets = {0};
  std::vector<std::uint32_t> labels;

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t i) const {
    return {labels.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

/// The values of entries, by name.
using FoamMacros = std::map<std::string, std::string, std::less<>>;

/// Reads a file from its first byte to its last. Errors are InvalidMesh, and name the file, and the line, or in binary
/// files the byte.
class FoamFile {
 public:
  /// Reads the file, or the file with .gz, and its header FoamFile { ... }, which a file to be included may lack.
  /// `max_memory` as ReadOptions.
  FoamFile(const std::filesystem::path& folder, std::string_view name, std::uint64_t max_memory, bool included = false);

  /// Takes bytes that have been read; `name` for messages.
  FoamFile(std::string name, std::string bytes);

  /// The class of its content, as "faceList".
  [[nodiscard]] const std::string& content_class() const { return class_; }

  /// The first character of the next token; 0 at the end.
  char next();
  /// Whether this character is next; then it is taken.
  bool take(char c);
  void expect(char c, std::string_view where);
  /// A word or a text in quotes, without these.
  std::string_view word(std::string_view what);
  std::int64_t integer(std::string_view what, std::int64_t low, std::int64_t high);
  double number(std::string_view what);
  /// The rest of an entry, whose key has been read: up to its ';', or a block in braces.
  void skip_entry();
  /// The same, and the text of the value; empty for a block and a long one.
  std::string entry();
  /// Takes a line that starts with '#'. The file that it includes, if that is named by a plain relative path; else empty.
  std::string directive();
  /// If a macro is next, $NAME or ${NAME}, puts its value in its place. Throws if it has none.
  void expand(const FoamMacros& values);

  // Lists: `N ( items )`, `N { item }`, `( items )`, each behind the name of a type or not; binary `N` and the bytes in
  // parentheses.

  /// Labels from 0 to limit - 1.
  std::vector<std::uint32_t> labels(std::string_view what, std::uint64_t limit);
  /// Labels whose sign has a meaning, from -limit to limit.
  std::vector<std::int64_t> signed_labels(std::string_view what, std::uint64_t limit);
  /// Faces, as lists or as the offsets and labels of all.
  FoamLists lists(std::string_view what, std::uint64_t limit);
  /// `components` numbers an item.
  std::vector<double> numbers(std::string_view what, std::size_t components);
  std::vector<Vec3> vectors(std::string_view what);
  void skip_bools();

  [[noreturn]] void fail(std::string_view message) const;

 private:
  void read_header();
  void skip_blank();
  void take_type_of_list();
  template <class Ascii, class Binary>
  void read_list(std::string_view what, std::size_t bytes_each, Ascii&& ascii, Binary&& binary);
  template <class Label, class Checked>
  std::vector<Label> read_labels(std::string_view what, Checked&& checked);
  std::int64_t raw_label(std::string_view raw, std::size_t i) const;
  double raw_scalar(std::string_view raw, std::size_t i) const;

  std::string name_;
  std::string bytes_;
  std::size_t at_ = 0;
  std::string class_;
  bool binary_ = false;
  std::endian order_ = std::endian::little;
  std::size_t label_bytes_ = 4;
  std::size_t scalar_bytes_ = 8;
};

}  // namespace dartcast
