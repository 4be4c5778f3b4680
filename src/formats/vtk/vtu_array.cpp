// Decodes one array of a .vtu file: ASCII, base64, raw, compressed.
#include "formats/vtk/vtu_array.hpp"

#include <fmt/format.h>
#include <vtkDataCompressor.h>
#include <vtkLZ4DataCompressor.h>
#include <vtkLZMADataCompressor.h>
#include <vtkSmartPointer.h>
#include <vtkZLibDataCompressor.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/vtk/vtk_errors.hpp"

namespace dartcast {
namespace {

struct Type {
  std::string_view name;
  std::size_t bytes;
  bool real;
  std::int64_t low;
  std::int64_t high;
};

constexpr std::array<Type, 11> array_types = {{{"Int8", 1, false, INT8_MIN, INT8_MAX},
                                               {"UInt8", 1, false, 0, UINT8_MAX},
                                               {"Int16", 2, false, INT16_MIN, INT16_MAX},
                                               {"UInt16", 2, false, 0, UINT16_MAX},
                                               {"Int32", 4, false, INT32_MIN, INT32_MAX},
                                               {"UInt32", 4, false, 0, UINT32_MAX},
                                               {"Int64", 8, false, INT64_MIN, INT64_MAX},
                                               {"UInt64", 8, false, 0, INT64_MAX},
                                               {"Float32", 4, true, 0, 0},
                                               {"Float64", 8, true, 0, 0},
                                               {"String", 1, false, INT8_MIN, UINT8_MAX}}};

const Type* find_type(std::string_view name) {
  const auto* found =
      std::find_if(array_types.begin(), array_types.end(), [&](const Type& t) { return t.name == name; });
  return found == array_types.end() ? nullptr : found;
}

/// Bytes in base64, read from the start; each call of take() decodes one run with its own padding.
class Base64 {
 public:
  explicit Base64(std::string_view text) : text_(text) {}

  /// The next n bytes; shorter where the text ends.
  std::string take(std::uint64_t n) {
    std::string out;
    while (out.size() < n) {
      std::array<unsigned, 4> quad{};
      unsigned padding = 0;
      for (unsigned& digit : quad) {
        const std::optional<unsigned> value = next();
        if (!value.has_value()) return out;
        padding += *value == 64 ? 1 : 0;
        digit = *value % 64;
      }
      const unsigned bits = (quad[0] << 18U) | (quad[1] << 12U) | (quad[2] << 6U) | quad[3];
      const unsigned count = 3 - std::min(padding, 3U);
      for (unsigned k = 0; k < count; ++k) out.push_back(static_cast<char>((bits >> (16U - 8U * k)) & 0xffU));
      if (padding > 0) break;
    }
    out.resize(std::min<std::uint64_t>(out.size(), n));
    return out;
  }

 private:
  /// Value of the next digit, 64 for padding; nothing at the end or at a byte that is no digit, because VTK skips
  /// none either.
  std::optional<unsigned> next() {
    if (at_ >= text_.size()) return std::nullopt;
    const char c = text_[at_++];
    if (c >= 'A' && c <= 'Z') return static_cast<unsigned>(c - 'A');
    if (c >= 'a' && c <= 'z') return static_cast<unsigned>(c - 'a') + 26;
    if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    if (c == '=') return 64;
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The encoded bytes of an array: first a header, then its data, each a separate run of base64.
class Source {
 public:
  Source(const VtuArray& array, const VtuEncoding& encoding)
      : raw_(array.format == "appended" && encoding.appended_raw), text_(array.text), base64_(std::string_view()) {
    if (array.format == "appended") {
      if (array.offset >= encoding.appended.size()) fail_array(array, "its data lie behind the end of the file");
      text_ = encoding.appended.substr(array.offset);
    } else {
      text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size()));
    }
    base64_ = Base64(text_);
  }

  std::string take(std::uint64_t n) {
    if (!raw_) return base64_.take(n);
    const std::string_view out = text_.substr(0, n);
    text_.remove_prefix(out.size());
    return std::string(out);
  }
  /// Continues after a padding: a compressed array's header is encoded in two runs that VTK decodes as one.
  void restart(std::uint64_t bytes) {
    if (raw_) return;
    base64_ = Base64(text_.substr(std::min<std::uint64_t>((bytes + 2) / 3 * 4, text_.size())));
  }

 private:
  bool raw_;
  std::string_view text_;
  Base64 base64_;
};

std::uint64_t integer_at(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t b = 0; b < size; ++b) {
    value = (value << 8U) | static_cast<unsigned char>(bytes[at + (big_endian ? b : size - 1 - b)]);
  }
  return value;
}

/// Sizes that the header of compressed data announces.
struct Blocks {
  std::vector<std::uint64_t> compressed;
  std::uint64_t size = 0;  // of each block except the last, decompressed
  std::uint64_t last = 0;

  [[nodiscard]] std::uint64_t size_of(std::size_t b) const {
    return b + 1 == compressed.size() && last != 0 ? last : size;
  }
};

Blocks read_blocks(const VtuArray& array, const VtuEncoding& encoding, Source& source, std::uint64_t available) {
  const std::size_t h = encoding.header_bytes;
  const auto get = [&](std::string_view bytes, std::size_t i) {
    return integer_at(bytes, i * h, h, encoding.big_endian);
  };
  std::string head = source.take(3 * h);
  if (head.size() < 3 * h) fail_array(array, "its header is cut off; the file is truncated");
  Blocks blocks;
  const std::uint64_t n = get(head, 0);
  blocks.size = get(head, 1);
  blocks.last = get(head, 2);
  if (n > available / h) fail_array(array, fmt::format("its header announces {} blocks, more than the file holds", n));
  if (blocks.size > available * 1100 + 65536 || blocks.last > blocks.size)
    fail_array(array, "its header announces blocks too large");
  source = Source(array, encoding);
  head = source.take((3 + n) * h);
  if (head.size() < (3 + n) * h) fail_array(array, "its header is cut off; the file is truncated");
  std::uint64_t left = available;
  for (std::uint64_t b = 0; b < n; ++b) {
    blocks.compressed.push_back(get(head, 3 + b));
    if (blocks.compressed.back() > left) fail_array(array, "its compressed data are cut off; the file is truncated");
    left -= blocks.compressed.back();
    if (blocks.size_of(b) > 1100 * blocks.compressed.back() + 65536)
      fail_array(array, "a block would grow too much when decompressed");
  }
  source.restart((3 + n) * h);
  return blocks;
}

std::uint64_t available_bytes(const VtuArray& array, const VtuEncoding& encoding) {
  return array.format == "appended"
             ? encoding.appended.size() - std::min<std::uint64_t>(array.offset, encoding.appended.size())
             : array.text.size();
}

std::uint64_t total_bytes(const Blocks& blocks) {
  std::uint64_t total = 0;
  for (std::size_t b = 0; b < blocks.compressed.size(); ++b) total += blocks.size_of(b);
  return total;
}

vtkSmartPointer<vtkDataCompressor> make_compressor(const VtuArray& array, const std::string& name) {
  if (name == "vtkZLibDataCompressor") return vtkSmartPointer<vtkZLibDataCompressor>::New();
  if (name == "vtkLZ4DataCompressor") return vtkSmartPointer<vtkLZ4DataCompressor>::New();
  if (name == "vtkLZMADataCompressor") return vtkSmartPointer<vtkLZMADataCompressor>::New();
  fail_array(array, fmt::format("the compressor '{}' is not known", name.substr(0, 40)));
}

std::string decompress(const VtuArray& array, const VtuEncoding& encoding, Source& source) {
  const Blocks blocks = read_blocks(array, encoding, source, available_bytes(array, encoding));
  const VtkErrors errors;  // the size that the compressor returns reports its errors
  const auto compressor = make_compressor(array, encoding.compressor);
  std::uint64_t all = 0;
  for (const std::uint64_t c : blocks.compressed) all += c;
  const std::string packed = source.take(all);
  if (packed.size() < all) fail_array(array, "its compressed data are cut off; the file is truncated");
  std::string out(total_bytes(blocks), '\0');
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t b = 0; b < blocks.compressed.size(); ++b) {
    const std::size_t size = blocks.size_of(b);
    const std::size_t done =
        compressor->Uncompress(reinterpret_cast<const unsigned char*>(packed.data()) + from, blocks.compressed[b],
                               reinterpret_cast<unsigned char*>(out.data()) + to, size);
    if (done != size) fail_array(array, fmt::format("block {} cannot be decompressed; the file is damaged", b));
    from += blocks.compressed[b];
    to += size;
  }
  return out;
}

/// The bytes of data that are not ASCII.
std::string decode_bytes(const VtuArray& array, const VtuEncoding& encoding) {
  const std::uint64_t size = count_numbers(array, encoding) * vtu_type_bytes(array.type);
  Source source(array, encoding);
  // VTK encodes the header and the data in one run where they are not compressed.
  std::string bytes = encoding.compressor.empty()
                          ? source.take(encoding.header_bytes + size).substr(encoding.header_bytes)
                          : decompress(array, encoding, source);
  if (bytes.size() != size) fail_array(array, "its data are cut off; the file is truncated");
  return bytes;
}

/// Calls take(value) for every number of ASCII data; returns how many there are.
template <class Take>
std::uint64_t read_ascii(const VtuArray& array, const Type& type, Take&& take) {
  FileText text(array.text);
  std::uint64_t n = 0;
  try {
    for (; !text.at_end(); ++n) {
      if (!type.real) {
        take(text.integer("a whole number", type.low, type.high));
      } else if (const double x = text.number("a number"); !(x - x == 0.0)) {
        text.fail("a number is not finite");
      }
    }
  } catch (const InvalidMesh& error) {
    fail_array(array, error.what());
  }
  return n;
}

}  // namespace

void fail_array(const VtuArray& array, std::string_view message) {
  throw InvalidMesh(fmt::format("array '{}': {}", array.name.substr(0, 60), message));
}

std::size_t vtu_type_bytes(std::string_view type) {
  const Type* found = find_type(type);
  return found == nullptr ? 0 : found->bytes;
}

std::uint64_t count_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  const Type& type = *find_type(array.type);
  if (array.format == "ascii") return read_ascii(array, type, [](std::int64_t) {});
  Source source(array, encoding);
  const std::uint64_t available = available_bytes(array, encoding);
  std::uint64_t bytes = 0;
  if (encoding.compressor.empty()) {
    const std::string head = source.take(encoding.header_bytes);
    if (head.size() < encoding.header_bytes) fail_array(array, "its header is cut off; the file is truncated");
    bytes = integer_at(head, 0, encoding.header_bytes, encoding.big_endian);
    const bool raw = array.format == "appended" && encoding.appended_raw;
    if (bytes > (raw ? available - encoding.header_bytes : available / 4 * 3)) {
      fail_array(array,
                 fmt::format("it announces {} bytes, more than the file holds; it is truncated or damaged", bytes));
    }
  } else {
    bytes = total_bytes(read_blocks(array, encoding, source, available));
  }
  if (bytes % type.bytes != 0) fail_array(array, "its size is not a multiple of the size of its numbers");
  return bytes / type.bytes;
}

std::uint64_t max_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  return array.format == "ascii" ? (array.text.size() + 1) / 2 : count_numbers(array, encoding);
}

void check_bytes(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.format != "ascii") decode_bytes(array, encoding);
}

std::vector<std::int64_t> decode_integers(const VtuArray& array, const VtuEncoding& encoding) {
  const Type& type = *find_type(array.type);
  if (type.real) fail_array(array, "it must be of whole numbers");
  std::vector<std::int64_t> out;
  if (array.format == "ascii") {
    read_ascii(array, type, [&](std::int64_t value) { out.push_back(value); });
    return out;
  }
  const std::string bytes = decode_bytes(array, encoding);
  for (std::uint64_t at = 0; at < bytes.size(); at += type.bytes) {
    const std::uint64_t bits = integer_at(bytes, at, type.bytes, encoding.big_endian);
    const unsigned shift = 64 - 8 * static_cast<unsigned>(type.bytes);
    out.push_back(type.low < 0 ? static_cast<std::int64_t>(bits << shift) >> shift : static_cast<std::int64_t>(bits));
  }
  return out;
}

std::optional<std::vector<double>> decode_reals(const VtuArray& array, const VtuEncoding& encoding) {
  const Type& type = *find_type(array.type);
  if (!type.real || array.format == "ascii") return std::nullopt;
  const std::string bytes = decode_bytes(array, encoding);
  std::vector<double> out(bytes.size() / type.bytes);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint64_t bits = integer_at(bytes, i * type.bytes, type.bytes, encoding.big_endian);
    out[i] = type.bytes == 8 ? std::bit_cast<double>(bits) : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  }
  return out;
}

}  // namespace dartcast
