// Decodes one array of a .vtu file: ASCII, base64, raw, compressed.
#include "formats/vtk/vtu_array.hpp"

#include <fmt/format.h>
#include <lz4.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <concepts>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/raw_number.hpp"

namespace dartcast {
namespace {

/// Calls use(T()) with the type of an array's numbers; returns false if the name is none.
template <class Use>
bool with_type(std::string_view name, Use&& use) {
  if (name == "Int8") return use(std::int8_t()), true;
  if (name == "UInt8" || name == "String") return use(std::uint8_t()), true;
  if (name == "Int16") return use(std::int16_t()), true;
  if (name == "UInt16") return use(std::uint16_t()), true;
  if (name == "Int32") return use(std::int32_t()), true;
  if (name == "UInt32") return use(std::uint32_t()), true;
  if (name == "Int64") return use(std::int64_t()), true;
  if (name == "UInt64") return use(std::uint64_t()), true;
  if (name == "Float32") return use(float()), true;
  if (name == "Float64") return use(double()), true;
  return false;
}

/// Bytes in base64, read from the start; each call of take() decodes one run with its own padding.
class Base64 {
 public:
  explicit Base64(std::string_view text) : text_(text) {}

  /// The next n bytes; shorter if the text ends.
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
    static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
    static constexpr auto values = [] {
      std::array<unsigned char, 256> table{};
      table.fill(255);
      for (std::size_t v = 0; v < digits.size(); ++v)
        table[static_cast<unsigned char>(digits[v])] = static_cast<unsigned char>(v);
      return table;
    }();
    if (at_ >= text_.size()) return std::nullopt;
    const unsigned value = values[static_cast<unsigned char>(text_[at_++])];
    return value == 255 ? std::nullopt : std::optional(value);
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

std::endian order_of(const VtuEncoding& encoding) {
  return encoding.big_endian ? std::endian::big : std::endian::little;
}

/// Number i of a header.
std::uint64_t header_number(std::string_view header, std::size_t i, const VtuEncoding& encoding) {
  const std::size_t h = encoding.header_bytes;
  const std::string_view bytes = header.substr(i * h, h);
  return h == 8 ? raw_number<std::uint64_t>(bytes, order_of(encoding))
                : raw_number<std::uint32_t>(bytes, order_of(encoding));
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

bool is_lz4(const VtuArray& array, const VtuEncoding& encoding) {
#ifdef __EMSCRIPTEN__
  constexpr bool lz4 = false;
#else
  const bool lz4 = encoding.compressor == "vtkLZ4DataCompressor";
#endif
  if (!lz4 && encoding.compressor != "vtkZLibDataCompressor")
    fail_array(array, fmt::format("the compressor '{}' is not supported: write it with vtkZLibDataCompressor",
                                  encoding.compressor.substr(0, 40)));
  return lz4;
}

Blocks read_blocks(const VtuArray& array, const VtuEncoding& encoding, Source& source, std::uint64_t available) {
  (void)is_lz4(array, encoding);
  const std::size_t h = encoding.header_bytes;
  const auto get = [&](std::string_view bytes, std::size_t i) { return header_number(bytes, i, encoding); };
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

/// Decompresses a block; false if it does not give exactly the bytes of `out`.
bool unpack(std::string_view packed, std::span<char> out, bool lz4) {
  if (lz4) {
    if (packed.size() > INT_MAX || out.size() > INT_MAX) return false;
    return LZ4_decompress_safe(packed.data(), out.data(), static_cast<int>(packed.size()),
                               static_cast<int>(out.size())) == static_cast<int>(out.size());
  }
  uLongf size = out.size();
  return ::uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                      packed.size()) == Z_OK &&
         size == out.size();
}

std::string decompress(const VtuArray& array, const VtuEncoding& encoding, Source& source) {
  const Blocks blocks = read_blocks(array, encoding, source, available_bytes(array, encoding));
  const std::uint64_t all = std::accumulate(blocks.compressed.begin(), blocks.compressed.end(), std::uint64_t{0});
  const std::string packed = source.take(all);
  if (packed.size() < all) fail_array(array, "its compressed data are cut off; the file is truncated");
  std::string out(total_bytes(blocks), '\0');
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t b = 0; b < blocks.compressed.size(); ++b) {
    const std::size_t size = blocks.size_of(b);
    if (!unpack(std::string_view(packed).substr(from, blocks.compressed[b]), std::span(out).subspan(to, size),
                is_lz4(array, encoding)))
      fail_array(array, fmt::format("block {} cannot be decompressed; the file is damaged", b));
    from += blocks.compressed[b];
    to += size;
  }
  return out;
}

/// The bytes of data that are not ASCII.
std::string decode_bytes(const VtuArray& array, const VtuEncoding& encoding) {
  const std::uint64_t size = count_numbers(array, encoding) * vtu_type_bytes(array.type);
  Source source(array, encoding);
  std::string bytes;
  if (encoding.compressor.empty()) {
    // If they are not compressed, VTK encodes the header and the data in one run. Others encode the header apart.
    const std::size_t head = encoding.header_bytes;
    bytes = source.take(head + size);
    if (bytes.size() == head) bytes += source.take(size);
    bytes.erase(0, head);
  } else {
    bytes = decompress(array, encoding, source);
  }
  if (bytes.size() != size) fail_array(array, "its data are cut off; the file is truncated");
  return bytes;
}

/// Calls take(value) for every number of ASCII data.
template <class T, class Take>
void read_ascii(const VtuArray& array, Take&& take) {
  // Characters of texts may be written with a sign.
  const std::int64_t low = array.type == "String" ? INT8_MIN : static_cast<std::int64_t>(std::numeric_limits<T>::min());
  constexpr std::uint64_t high = std::min<std::uint64_t>(std::numeric_limits<T>::max(), INT64_MAX);
  FileText text(array.text);
  try {
    while (!text.at_end()) take(static_cast<T>(text.integer("a whole number", low, static_cast<std::int64_t>(high))));
  } catch (const InvalidMesh& error) {
    fail_array(array, error.what());
  }
}
template <std::floating_point T, class Take>
void read_ascii(const VtuArray& array, Take&& take) {
  FileText text(array.text);
  try {
    while (!text.at_end()) {
      const T x = text.number<T>("a number");
      if (!(x - x == 0)) text.fail("a number is not finite");
      take(x);
    }
  } catch (const InvalidMesh& error) {
    fail_array(array, error.what());
  }
}

template <class Out>
std::vector<Out> decode(const VtuArray& array, const VtuEncoding& encoding) {
  std::vector<Out> out;
  with_type(array.type, [&]<class T>(T /*type*/) {
    if (array.format == "ascii") return read_ascii<T>(array, [&](T x) { out.push_back(static_cast<Out>(x)); });
    const std::string bytes = decode_bytes(array, encoding);
    out.resize(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = static_cast<Out>(
          +raw_number<T>(std::string_view(bytes).substr(i * sizeof(T), sizeof(T)), order_of(encoding)));
  });
  return out;
}

}  // namespace

void fail_array(const VtuArray& array, std::string_view message) {
  throw InvalidMesh(fmt::format("array '{}': {}", array.name.substr(0, 60), message));
}

std::size_t vtu_type_bytes(std::string_view type) {
  std::size_t bytes = 0;
  with_type(type, [&]<class T>(T /*type*/) { bytes = sizeof(T); });
  return bytes;
}

std::uint64_t count_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  Source source(array, encoding);
  const std::uint64_t available = available_bytes(array, encoding);
  std::uint64_t bytes = 0;
  if (encoding.compressor.empty()) {
    const std::string head = source.take(encoding.header_bytes);
    if (head.size() < encoding.header_bytes) fail_array(array, "its header is cut off; the file is truncated");
    bytes = header_number(head, 0, encoding);
    const bool raw = array.format == "appended" && encoding.appended_raw;
    if (bytes > (raw ? available - encoding.header_bytes : available / 4 * 3)) {
      fail_array(array,
                 fmt::format("it announces {} bytes, more than the file holds; it is truncated or damaged", bytes));
    }
  } else {
    bytes = total_bytes(read_blocks(array, encoding, source, available));
  }
  const std::size_t each = vtu_type_bytes(array.type);
  if (bytes % each != 0) fail_array(array, "its size is not a multiple of the size of its numbers");
  return bytes / each;
}

std::uint64_t max_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  return array.format == "ascii" ? (array.text.size() + 1) / 2 : count_numbers(array, encoding);
}

std::vector<double> decode_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  return decode<double>(array, encoding);
}

std::vector<std::int64_t> decode_integers(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.type.starts_with("Float")) fail_array(array, "it must be of whole numbers");
  return decode<std::int64_t>(array, encoding);
}

}  // namespace dartcast
