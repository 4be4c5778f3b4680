// Values as bytes of this machine's kind, one after another. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "dartcast/error.hpp"

namespace dartcast {

class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  template <class T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  /// As they are, without their number.
  void put_bytes(std::span<const std::byte> bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// Keeps the memory.
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

/// Every function throws Error if the bytes end too early.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_trivially_copyable_v<T> T take() {
    T value;
    std::memcpy(&value, next(sizeof value), sizeof value);
    return value;
  }
  /// A size in 64 bits.
  std::size_t take_size() {
    const auto size = take<std::uint64_t>();
    if (size > SIZE_MAX) fail();
    return static_cast<std::size_t>(size);
  }
  template <class T>
  std::vector<T> take_list() {
    const std::size_t count = take_size();
    if (count > bytes_.size() / sizeof(T)) fail();
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), next(count * sizeof(T)), count * sizeof(T));
    return values;
  }
  std::span<const std::byte> take_bytes(std::size_t size) {
    return {reinterpret_cast<const std::byte*>(next(size)), size};
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  std::string take_text() {
    const std::size_t size = take_size();
    return std::string(next(size), size);
  }

 private:
  [[noreturn]] static void fail() { throw Error("it is damaged: a list is longer than what holds it"); }
  const char* next(std::size_t size) {
    if (size > bytes_.size()) fail();
    const char* at = bytes_.data();
    bytes_.remove_prefix(size);
    return at;
  }

  std::string_view bytes_;
};

}  // namespace dartcast
