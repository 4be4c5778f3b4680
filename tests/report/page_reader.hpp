// Reads the data of a report's page again, by code of its own: the inverse of what docs/report.md describes.
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace dartcast::test {

class PageReader {
 public:
  explicit PageReader(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    text = {std::istreambuf_iterator<char>(file), {}};
    meta = nlohmann::json::parse(between("<script type=\"application/json\" id=\"meta\">", "</script>"));
  }

  template <class T>
  [[nodiscard]] std::vector<T> block(const nlohmann::json& number) const {
    const std::string bytes = inflated(decoded(
        between("<script type=\"text/plain\" id=\"b" + std::to_string(number.get<int>()) + "\">", "</script>")));
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }

  /// All frames of a series, one after another.
  template <class T>
  [[nodiscard]] std::vector<T> series(const nlohmann::json& description, std::size_t each) const {
    std::vector<T> all;
    for (const nlohmann::json& group : description.at("groups")) {
      const auto bytes = block<std::uint8_t>(group.at("block"));
      const std::size_t n = group.at("count").get<std::size_t>() * each;
      const std::size_t base = all.size();
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t code = sizeof(T) == 1 ? bytes.at(i) : bytes.at(i) | bytes.at(n + i) << 8U;
        const std::uint32_t difference = (code & 1U) != 0 ? ~(code >> 1U) : code >> 1U;
        std::uint32_t value = code;
        if (i >= each && (sizeof(T) == 1 || i < 2 * each)) value = all[base + i - each] + difference;
        if (i >= 2 * each && sizeof(T) == 2) value = 2U * all[base + i - each] - all[base + i - 2 * each] + difference;
        all.push_back(static_cast<T>(value));
      }
    }
    return all;
  }

  /// A quantised position in the run's coordinates.
  [[nodiscard]] std::array<double, 3> position(const std::uint16_t* q) const {
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = meta.at("box").at(0).at(k);
      const double high = meta.at("box").at(1).at(k);
      x[k] = low + (high - low) * q[k] / 65535.0;
    }
    return x;
  }
  /// Half of a step between two positions, and the error of a float.
  [[nodiscard]] double tolerance() const {
    double size = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      size = std::max(size, meta.at("box").at(1).at(k).get<double>() - meta.at("box").at(0).at(k).get<double>());
    return size * (0.5 / 65535.0 + 1e-6);
  }

  std::string text;
  nlohmann::json meta;

 private:
  [[nodiscard]] std::string between(const std::string& start, const std::string& end) const {
    const std::size_t a = text.find(start);
    if (a == std::string::npos) throw std::runtime_error("the page has no " + start);
    const std::size_t b = text.find(end, a);
    return text.substr(a + start.size(), b - a - start.size());
  }
  static std::string decoded(const std::string& base64) {
    static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    std::uint32_t word = 0;
    int bits = 0;
    for (const char c : base64) {
      const std::size_t digit = digits.find(c);
      if (digit == std::string::npos) continue;
      word = word << 6U | static_cast<std::uint32_t>(digit);
      bits += 6;
      if (bits < 8) continue;
      bits -= 8;
      out += static_cast<char>(word >> static_cast<unsigned>(bits) & 0xffU);
    }
    return out;
  }
  static std::string inflated(std::string packed) {
    z_stream stream{};
    inflateInit2(&stream, 15 + 16);
    stream.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_in = static_cast<uInt>(packed.size());
    std::string out;
    int status = Z_OK;
    while (status == Z_OK) {
      std::array<char, 65536> buffer{};
      stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
      stream.avail_out = static_cast<uInt>(buffer.size());
      status = inflate(&stream, Z_NO_FLUSH);
      out.append(buffer.data(), buffer.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("a block is no gzip stream");
    return out;
  }
};

}  // namespace dartcast::test
