// How numbers stand in a report: quantised, as differences, compressed, in base64. Not installed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/recorded.hpp"

namespace dartcast {

/// The box of all positions. Each coordinate is one of 65536 values in it.
struct QuantisedBox {
  std::array<double, 3> low{};
  std::array<double, 3> high{};

  /// Grows around a point.
  void add(const RecordedPoint& p);
  [[nodiscard]] std::array<std::uint16_t, 3> quantised(const RecordedPoint& p) const;

 private:
  bool empty_ = true;
};

/// Values of several frames as bytes. The first frame stays, the second is differences from the first, all others are
/// differences of differences. They are modulo 2^16, signs in the lowest bit; all low bytes come before all high bytes.
/// `values`: `each` for a frame, frame by frame. Smooth motions become small numbers, which compress well.
std::string second_differences(std::span<const std::uint16_t> values, std::size_t each);
/// The same with differences alone, modulo 2^8.
std::string first_differences(std::span<const std::uint8_t> values, std::size_t each);

template <class T>
std::string_view bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// As a gzip stream.
std::string gzipped(std::string_view bytes);
std::string base64(std::string_view bytes);

}  // namespace dartcast
