// Codes numbers for a report.
#include "report/encode.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// The sign goes to the lowest bit, so that small differences of both signs are small numbers.
std::uint16_t zigzag(std::uint16_t d) {
  return static_cast<std::uint16_t>((d << 1U) ^ ((d & 0x8000U) != 0 ? 0xffffU : 0U));
}
std::uint8_t zigzag(std::uint8_t d) { return static_cast<std::uint8_t>((d << 1U) ^ ((d & 0x80U) != 0 ? 0xffU : 0U)); }

}  // namespace

void QuantisedBox::add(const RecordedPoint& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[k];
    low[k] = empty_ ? x : std::min(low[k], x);
    high[k] = empty_ ? x : std::max(high[k], x);
  }
  empty_ = false;
}

std::array<std::uint16_t, 3> QuantisedBox::quantised(const RecordedPoint& p) const {
  std::array<std::uint16_t, 3> q{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = high[k] - low[k];
    const double share = size > 0.0 ? (static_cast<double>(p[k]) - low[k]) / size : 0.0;
    q[k] = static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * 65535.0));
  }
  return q;
}

std::string second_differences(std::span<const std::uint16_t> values, std::size_t each) {
  const std::size_t n = values.size();
  std::string bytes(2 * n, '\0');
  for (std::size_t i = 0; i < n; ++i) {
    unsigned expected = 0;
    if (i >= 2 * each)
      expected = 2U * values[i - each] - values[i - 2 * each];
    else if (i >= each)
      expected = values[i - each];
    const std::uint16_t code = i < each ? values[i] : zigzag(static_cast<std::uint16_t>(values[i] - expected));
    bytes[i] = static_cast<char>(code & 0xffU);
    bytes[n + i] = static_cast<char>(code >> 8U);
  }
  return bytes;
}

std::string first_differences(std::span<const std::uint8_t> values, std::size_t each) {
  std::string bytes(values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i)
    bytes[i] =
        static_cast<char>(i < each ? values[i] : zigzag(static_cast<std::uint8_t>(values[i] - values[i - each])));
  return bytes;
}

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  constexpr int gzip_window = 15 + 16;
  constexpr int level = 3;  // 5 takes a seventh more time, for a fiftieth of the size
  if (deflateInit2(&stream, level, Z_DEFLATED, gzip_window, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error("report: there is not enough memory to compress it");
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  if (bytes.size() > 0xffffffffU || packed.size() > 0xffffffffU) {
    deflateEnd(&stream);
    throw Error("report: a block has more than 4 GB; take fewer particles or frames");
  }
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw InternalError("report: a block could not be compressed");
  return packed;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8U) | (k < n ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[(word >> (18U - 6U * k)) & 63U] : '=';
  }
  return out;
}

}  // namespace dartcast
