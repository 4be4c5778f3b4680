// The data of one array of a .vtu file, decoded with a check of every number that it announces.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

/// The attributes of the file's first tag, for all arrays.
struct VtuEncoding {
  bool big_endian = false;
  std::size_t header_bytes = 4;
  std::string compressor;     ///< empty: not compressed
  std::string_view appended;  ///< behind the '_' of the appended data
  bool appended_raw = false;
};

/// One <DataArray>.
struct VtuArray {
  std::string name;
  std::string type;
  std::string format;  ///< ascii, binary or appended
  std::uint64_t components = 1;
  std::uint64_t tuples = 0;  ///< announced; field data only
  std::uint64_t offset = 0;  ///< appended
  std::string_view text;     ///< inline
};

/// Throws InvalidMesh with the array's name.
[[noreturn]] void fail_array(const VtuArray& array, std::string_view message);

/// Bytes of one number of a type; 0 for a type that is not known, 1 for strings.
std::size_t vtu_type_bytes(std::string_view type);

/// The number of numbers that data announce which are not ASCII. The bytes for them are checked to exist; for
/// compressed data, the compressed ones. Throws InvalidMesh.
std::uint64_t count_numbers(const VtuArray& array, const VtuEncoding& encoding);

/// At least as many numbers as count_numbers() finds, without a look at ASCII data. Throws InvalidMesh.
std::uint64_t max_numbers(const VtuArray& array, const VtuEncoding& encoding);

/// All numbers of an array, of any type. Throws InvalidMesh.
std::vector<double> decode_numbers(const VtuArray& array, const VtuEncoding& encoding);

/// All numbers of an array of whole numbers. Throws InvalidMesh.
std::vector<std::int64_t> decode_integers(const VtuArray& array, const VtuEncoding& encoding);

}  // namespace dartcast
