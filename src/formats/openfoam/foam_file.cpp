// Reads OpenFOAM's files: first the header, which says how the rest is written, then token by token.
#include "formats/openfoam/foam_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/raw_number.hpp"
#include "formats/read_memory.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

bool ends_word(char c) { return is_space(c) || std::string_view("(){};\"").find(c) != std::string_view::npos; }

/// The path from its time on, or from its processor's folder on, as "constant/polyMesh/faces".
std::string short_name(const fs::path& file) {
  const fs::path folder = file.parent_path();
  const fs::path time = folder.filename() == "polyMesh" ? folder.parent_path() : folder;
  fs::path from = time.parent_path();
  if (from.filename().string().starts_with("processor")) from = from.parent_path();
  return file.lexically_relative(from.empty() ? "." : from).string();
}

/// All bytes of a file that gzip has made. They may be many more than those of the file: the limit is checked on the
/// way.
std::string unzipped(const fs::path& path, std::uint64_t max_memory) {
  struct Close {
    void operator()(gzFile_s* file) const { gzclose(file); }
  };
  const std::unique_ptr<gzFile_s, Close> in(gzopen(path.c_str(), "rb"));
  if (!in) throw InvalidMesh("the file cannot be opened; check its permissions");
  constexpr unsigned step = 1U << 20U;
  std::string bytes;
  for (;;) {
    check_memory(memory_of_text(bytes.size() + step), max_memory);
    const std::size_t before = bytes.size();
    bytes.resize(before + step);
    const int n = gzread(in.get(), bytes.data() + before, step);
    int state = Z_OK;
    gzerror(in.get(), &state);
    if (n < 0 || (state != Z_OK && state != Z_STREAM_END))
      throw InvalidMesh("the file cannot be uncompressed; it is truncated or damaged");
    bytes.resize(before + static_cast<std::size_t>(n));
    if (n < static_cast<int>(step)) return bytes;
  }
}

std::string bytes_of(const fs::path& path, std::uint64_t max_memory) {
  if (path.extension() == ".gz") return unzipped(path, max_memory);
  check_memory(memory_of_text(file_bytes(path)), max_memory);
  return read_bytes(path);
}

/// The file of this name, or with .gz behind it.
fs::path found_file(const fs::path& folder, std::string_view name) {
  fs::path plain = folder / name;
  std::error_code error;
  if (fs::is_regular_file(plain, error)) return plain;
  fs::path packed = folder / (std::string(name) + ".gz");
  return fs::is_regular_file(packed, error) ? packed : plain;
}

}  // namespace

bool has_foam_file(const fs::path& folder, std::string_view name) {
  std::error_code error;
  return fs::is_regular_file(found_file(folder, name), error);
}

std::string foam_class(const fs::path& folder, std::string_view name) {
  constexpr unsigned header_bytes = 4096;
  const fs::path path = found_file(folder, name);
  gzFile_s* in = gzopen(path.c_str(), "rb");  // reads plain files as well
  if (in == nullptr) return {};
  std::string bytes(header_bytes, '\0');
  const int n = gzread(in, bytes.data(), header_bytes);
  gzclose(in);
  bytes.resize(static_cast<std::size_t>(std::max(n, 0)));
  try {
    return FoamFile(short_name(path), std::move(bytes)).content_class();
  } catch (const InvalidMesh&) {
    return {};
  }
}

FoamFile::FoamFile(std::string name, std::string bytes) : name_(std::move(name)), bytes_(std::move(bytes)) {
  read_header();
}

FoamFile::FoamFile(const fs::path& folder, std::string_view name, std::uint64_t max_memory, bool included) {
  const fs::path path = found_file(folder, name);
  name_ = short_name(path);
  try {
    bytes_ = bytes_of(path, max_memory);
  } catch (const InvalidMesh& e) {
    throw InvalidMesh(fmt::format("{}: {}", name_, e.what()));
  }
  if (!included || (next() == 'F' && std::string_view(bytes_).substr(at_).starts_with("FoamFile"))) read_header();
}

void FoamFile::read_header() {
  if (next() == '\0' && at_ == bytes_.size()) fail("the file is empty");
  if (word("'FoamFile'") != "FoamFile") fail("the header 'FoamFile { ... }' should stand here");
  expect('{', "behind FoamFile");
  std::string arch;
  while (!take('}')) {
    const std::string key(word("a key of the header"));
    if (key == "format") {
      const std::string_view format = word("the format");
      if (format != "ascii" && format != "binary")
        fail(fmt::format("format {}: it must be ascii or binary", printable(format)));
      binary_ = format == "binary";
    } else if (key == "class") {
      class_ = word("the class");
    } else if (key == "arch") {
      arch = word("the architecture");
    }
    skip_entry();
  }
  if (arch.find("MSB") != std::string::npos) order_ = std::endian::big;
  if (arch.find("label=64") != std::string::npos) label_bytes_ = 8;
  if (arch.find("scalar=32") != std::string::npos) scalar_bytes_ = 4;
}

// Tokens.

void FoamFile::skip_blank() {
  while (at_ < bytes_.size()) {
    if (is_space(bytes_[at_])) {
      ++at_;
    } else if (bytes_[at_] == '/' && at_ + 1 < bytes_.size() && bytes_[at_ + 1] == '/') {
      at_ = std::min(bytes_.find('\n', at_), bytes_.size());
    } else if (bytes_[at_] == '/' && at_ + 1 < bytes_.size() && bytes_[at_ + 1] == '*') {
      const std::size_t end = bytes_.find("*/", at_ + 2);
      if (end == std::string::npos) fail("a comment does not end");
      at_ = end + 2;
    } else {
      return;
    }
  }
}

char FoamFile::next() {
  skip_blank();
  return at_ < bytes_.size() ? bytes_[at_] : '\0';
}

bool FoamFile::take(char c) {
  if (next() != c || at_ == bytes_.size()) return false;
  ++at_;
  return true;
}

void FoamFile::expect(char c, std::string_view where) {
  if (!take(c)) fail(fmt::format("'{}' should stand {}", c, where));
}

std::string_view FoamFile::word(std::string_view what) {
  const bool quoted = take('"');
  if (!quoted) skip_blank();
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && (quoted ? bytes_[at_] != '"' : !ends_word(bytes_[at_]))) ++at_;
  if (at_ == bytes_.size()) fail(fmt::format("the file ends where {} should stand; it is truncated", what));
  const std::string_view found(bytes_.data() + begin, at_ - begin);
  if (quoted) ++at_;
  if (found.empty()) fail(fmt::format("{} should stand here, not '{}'", what, printable({&bytes_[at_], 1})));
  if (found[0] == '#' || found[0] == '$')
    fail(fmt::format("'{}': directives and macros of dictionaries are not read here; write their values",
                     printable(found)));
  return found;
}

std::int64_t FoamFile::integer(std::string_view what, std::int64_t low, std::int64_t high) {
  skip_blank();
  std::int64_t value = 0;
  const char* const end = bytes_.data() + bytes_.size();
  const auto [after, error] = std::from_chars(bytes_.data() + at_, end, value);
  if (error == std::errc::invalid_argument || (after != end && !ends_word(*after)))
    fail(fmt::format("'{}' is not a whole number, where {} should stand", printable(word(what)), what));
  if (error != std::errc() || value < low || value > high)
    fail(fmt::format("{} is out of range as {}", printable(word(what)), what));
  at_ = static_cast<std::size_t>(after - bytes_.data());
  return value;
}

double FoamFile::number(std::string_view what) {
  skip_blank();
  double value = 0.0;
  const char* const end = bytes_.data() + bytes_.size();
  const auto [after, error] = std::from_chars(bytes_.data() + at_, end, value);
  if (error == std::errc::invalid_argument || (after != end && !ends_word(*after)))
    fail(fmt::format("'{}' is not a number, where {} should stand", printable(word(what)), what));
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(word(what)).c_str(), nullptr);
  at_ = static_cast<std::size_t>(after - bytes_.data());
  return value;
}

void FoamFile::skip_entry() {
  const bool block = next() == '{';
  std::size_t depth = 0;
  for (;;) {
    const char c = next();
    if (c == '\0' && at_ == bytes_.size()) fail("an entry does not end");
    if (c == '"') {
      const std::size_t end = bytes_.find('"', at_ + 1);
      if (end == std::string::npos) fail("a text in quotes does not end");
      at_ = end;
    }
    ++at_;
    if (c == '(' || c == '{') ++depth;
    if ((c == ')' || c == '}') && depth-- == 0) fail(fmt::format("'{}' closes what was not opened", c));
    if (depth == 0 && c == (block ? '}' : ';')) return;
  }
}

std::string FoamFile::entry() {
  constexpr std::size_t longest = 4096;
  const bool block = next() == '{';
  const std::size_t begin = at_;
  skip_entry();
  return block || at_ - begin > longest ? std::string() : bytes_.substr(begin, at_ - 1 - begin);
}

std::string FoamFile::directive() {
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  const std::string_view line = std::string_view(bytes_).substr(at_, end - at_);
  at_ = end;
  const std::size_t open = line.find('"');
  const std::string_view name = line.substr(0, line.find_first_of(" \t\""));
  if (open == std::string_view::npos || (name != "#include" && name != "#includeIfPresent" && name != "#sinclude"))
    return {};
  const std::string_view path = line.substr(open + 1, line.find('"', open + 1) - open - 1);
  return path.starts_with('/') || path.find_first_of("$<~") != std::string_view::npos ? std::string()
                                                                                      : std::string(path);
}

void FoamFile::expand(const FoamMacros& values) {
  constexpr unsigned most = 100;  // more stand for themselves
  for (unsigned n = 0; next() == '$'; ++n) {
    std::size_t end = at_ + 1;
    while (end < bytes_.size() && (!ends_word(bytes_[end]) || (bytes_[end] == '{' && end == at_ + 1))) ++end;
    std::string_view name = std::string_view(bytes_).substr(at_ + 1, end - at_ - 1);
    if (name.starts_with('{')) {
      name.remove_prefix(1);
      if (end < bytes_.size() && bytes_[end] == '}') ++end;
    }
    const auto found = values.find(name);
    if (found == values.end() || found->second.empty() || n == most)
      fail(fmt::format("'${}' has no plain value in this file or in one that it includes: write the value here",
                       printable(name)));
    bytes_.replace(at_, end - at_, found->second);
  }
}

// Lists.

void FoamFile::take_type_of_list() {
  constexpr std::string_view list = "List<";
  if (next() == 'L' && std::string_view(bytes_).substr(at_, list.size()) == list) word("the type of a list");
}

// Calls ascii() for each item, or binary(bytes of all, their number), whose items have `bytes_each` bytes.
template <class Ascii, class Binary>
void FoamFile::read_list(std::string_view what, std::size_t bytes_each, Ascii&& ascii, Binary&& binary) {
  take_type_of_list();
  if (!binary_ && take('(')) {
    while (!take(')')) ascii();
    return;
  }
  const auto n = static_cast<std::size_t>(
      integer(fmt::format("the number of {}", what), 0, std::numeric_limits<std::int64_t>::max()));
  if (take('{')) {
    // One value for all: no more of them than a file of this size could list.
    if (n > bytes_.size()) fail(fmt::format("{} {} are announced, more than the file has bytes", n, what));
    const std::size_t value = at_;
    for (std::size_t i = 0; i < n; ++i) {
      at_ = value;
      ascii();
    }
    if (n == 0) at_ = std::min(bytes_.find('}', at_), bytes_.size());
    expect('}', fmt::format("behind the value of all {}", what));
    return;
  }
  if (binary_ && n == 0) {
    if (take('(')) expect(')', fmt::format("behind no {}", what));
    return;
  }
  expect('(', fmt::format("before the {}", what));
  const std::size_t left = bytes_.size() - at_;
  if (n > left / (binary_ ? bytes_each : 2)) {
    fail(fmt::format("{} {} are announced, but only {} bytes are left in the file; it is truncated or damaged", n, what,
                     left));
  }
  if (binary_) {
    binary(std::string_view(bytes_).substr(at_, n * bytes_each), n);
    at_ += n * bytes_each;
  } else {
    for (std::size_t i = 0; i < n; ++i) ascii();
  }
  expect(')', fmt::format("behind the {} {}", n, what));
}

std::int64_t FoamFile::raw_label(std::string_view raw, std::size_t i) const {
  const std::string_view bytes = raw.substr(i * label_bytes_, label_bytes_);
  return label_bytes_ == 4 ? raw_number<std::int32_t>(bytes, order_) : raw_number<std::int64_t>(bytes, order_);
}

double FoamFile::raw_scalar(std::string_view raw, std::size_t i) const {
  const std::string_view bytes = raw.substr(i * scalar_bytes_, scalar_bytes_);
  return scalar_bytes_ == 4 ? raw_number<float>(bytes, order_) : raw_number<double>(bytes, order_);
}

template <class Label, class Checked>
std::vector<Label> FoamFile::read_labels(std::string_view what, Checked&& checked) {
  std::vector<Label> out;
  read_list(
      what, label_bytes_, [&] { out.push_back(checked(integer("a label", INT64_MIN, INT64_MAX), out.size())); },
      [&](std::string_view raw, std::size_t n) {
        out.reserve(n);
        for (std::size_t i = 0; i < n; ++i) out.push_back(checked(raw_label(raw, i), i));
      });
  return out;
}

std::vector<std::uint32_t> FoamFile::labels(std::string_view what, std::uint64_t limit) {
  return read_labels<std::uint32_t>(what, [&](std::int64_t label, std::size_t item) {
    if (label < 0 || static_cast<std::uint64_t>(label) >= limit)
      fail(fmt::format("{}: item {} is {}; it must be from 0 to less than {}", what, item, label, limit));
    return static_cast<std::uint32_t>(label);
  });
}

std::vector<std::int64_t> FoamFile::signed_labels(std::string_view what, std::uint64_t limit) {
  const auto last = static_cast<std::int64_t>(std::min<std::uint64_t>(limit, INT64_MAX));
  return read_labels<std::int64_t>(what, [&](std::int64_t label, std::size_t item) {
    if (label < -last || label > last)
      fail(fmt::format("{}: item {} is {}; it must be from {} to {}", what, item, label, -last, last));
    return label;
  });
}

FoamLists FoamFile::lists(std::string_view what, std::uint64_t limit) {
  FoamLists out;
  if (class_ != "faceCompactList") {
    const bool binary = std::exchange(binary_, false);  // lists of lists have no bytes of their own
    const auto one = [&] {
      binary_ = binary;
      const std::vector<std::uint32_t> list = labels(what, limit);
      binary_ = false;
      out.labels.insert(out.labels.end(), list.begin(), list.end());
      out.offsets.push_back(out.labels.size());
      // Many lists of one value each, as 1000{0}, could be more than any memory.
      if (out.labels.size() > bytes_.size()) fail(fmt::format("the {} have more labels than the file has bytes", what));
    };
    read_list(what, 2, one, [](std::string_view, std::size_t) {});
    binary_ = binary;
    return out;
  }
  const std::vector<std::uint32_t> offsets = labels("the offsets of the faces", no_label_limit);
  out.labels = labels(what, limit);
  out.offsets.assign(offsets.begin(), offsets.end());
  if (out.offsets.empty() && out.labels.empty()) return {};
  if (out.offsets.empty() || out.offsets.front() != 0 || out.offsets.back() != out.labels.size() ||
      !std::is_sorted(out.offsets.begin(), out.offsets.end()))
    fail(fmt::format("the offsets of the faces do not fit their {} labels", out.labels.size()));
  return out;
}

std::vector<double> FoamFile::numbers(std::string_view what, std::size_t components) {
  std::vector<double> out;
  const auto one = [&] {
    if (components > 1) expect('(', fmt::format("before a vector of the {}", what));
    for (std::size_t k = 0; k < components; ++k) out.push_back(number("a number"));
    if (components > 1) expect(')', fmt::format("behind a vector of the {}", what));
  };
  read_list(what, components * scalar_bytes_, one, [&](std::string_view raw, std::size_t n) {
    out.reserve(n * components);
    for (std::size_t i = 0; i < n * components; ++i) out.push_back(raw_scalar(raw, i));
  });
  return out;
}

std::vector<Vec3> FoamFile::vectors(std::string_view what) {
  const std::vector<double> all = numbers(what, 3);
  std::vector<Vec3> out;
  out.reserve(all.size() / 3);
  for (std::size_t i = 0; i < all.size(); i += 3) out.push_back({all[i], all[i + 1], all[i + 2]});
  return out;
}

void FoamFile::skip_bools() {
  read_list(
      "flags", 1, [&] { word("a flag"); }, [](std::string_view, std::size_t) {});
}

void FoamFile::fail(std::string_view message) const {
  if (binary_) throw InvalidMesh(fmt::format("{}, byte {}: {}", name_, at_, message));
  const auto lines = std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
  throw InvalidMesh(fmt::format("{}, line {}: {}", name_, 1 + lines, message));
}

}  // namespace dartcast
