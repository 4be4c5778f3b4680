// One array of VTK's XML files, as raw bytes for the appended data.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// VTK's name of a type of numbers. Sizes are below 2^63.
template <class T>
constexpr std::string_view xml_type() {
  if constexpr (std::same_as<T, double> || std::same_as<T, Vec3>) return "Float64";
  if constexpr (std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t>) return "Int64";
  if constexpr (std::same_as<T, std::int32_t>) return "Int32";
  if constexpr (std::unsigned_integral<T> && sizeof(T) == 4) return "UInt32";  // sizes of 32 bits, too
  if constexpr (std::same_as<T, std::uint8_t>) return "UInt8";
  if constexpr (std::same_as<T, char>) return "String";
}

/// An array as it stands in a file.
struct XmlBlock {
  std::string head;    ///< its size, or the sizes of its compressed blocks
  std::string packed;  ///< the compressed blocks
};

/// A name and numbers in contiguous memory, which every copy shares.
class XmlArray {
 public:
  /// Takes the values over. `components`: of Vec3, 3.
  template <class T>
  XmlArray(std::string name, std::vector<T>&& values, std::size_t components = 1)
      : XmlArray(std::move(name), std::make_shared<const std::vector<T>>(std::move(values)), components) {}

  /// Values in memory that the owner keeps.
  template <class T>
  XmlArray(std::string name, std::span<const T> values, std::shared_ptr<const void> owner, std::size_t components = 1)
      : name_(std::move(name)),
        type_(xml_type<T>()),
        components_(std::same_as<T, Vec3> ? 3 : components),
        owner_(std::move(owner)),
        bytes_(reinterpret_cast<const char*>(values.data()), values.size_bytes()) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string_view type() const { return type_; }
  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] std::string_view bytes() const { return bytes_; }
  /// The number of items in field data; 0: as many as the array's section says.
  [[nodiscard]] std::size_t tuples() const { return tuples_; }
  void set_tuples(std::size_t tuples) { tuples_ = tuples; }

  /// Keeps the block that is made first: for arrays that stand in many files, all of one compression.
  void keep() { kept_ = std::make_shared<std::shared_ptr<const XmlBlock>>(); }
  /// If it is kept, one thread at a time may call this. Cost: that of the compression.
  [[nodiscard]] std::shared_ptr<const XmlBlock> block(Compression compression) const;

 private:
  template <class T>
  XmlArray(std::string name, std::shared_ptr<const std::vector<T>> values, std::size_t components)
      : XmlArray(std::move(name), std::span<const T>(*values), values, components) {}

  std::string name_;
  std::string_view type_;
  std::size_t components_ = 1;
  std::size_t tuples_ = 0;
  std::shared_ptr<const void> owner_;
  std::string_view bytes_;
  std::shared_ptr<std::shared_ptr<const XmlBlock>> kept_;
};

}  // namespace dartcast
