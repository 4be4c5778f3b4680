// Pathlines: points on their way to a file, and the file of all of them. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "dartcast/statistics.hpp"
#include "formats/vtp_write.hpp"

namespace dartcast {

/// Collects points, those of each particle in the order of time, and makes the file of write_pathlines(). It holds 65
/// bytes for each point.
class PathlinesBuilder {
 public:
  /// Throws Error if there are more points than a file can number (2^32 - 1).
  void add(const PathPoint& point);
  /// Precondition: it is called once.
  VtpFile file();

 private:
  std::vector<Vec3> positions_;
  std::vector<double> times_;
  std::vector<Vec3> velocities_;
  std::vector<std::uint8_t> contacts_;
  std::vector<std::uint32_t> line_of_;                     // of each point
  std::unordered_map<std::uint64_t, std::uint32_t> line_;  // by id, in the order of coming
  std::vector<std::uint64_t> ids_;                         // of the lines
  std::vector<std::size_t> sizes_;
};

/// The first line of a file of packed points.
inline constexpr std::string_view pathlines_header = "dartcast pathlines 1";

/// A point as bytes of this machine's kind.
std::string packed(const PathPoint& point);

/// The lines of a file of packed points. Throws Error if it cannot be read or is none.
VtpFile read_packed_pathlines(const std::filesystem::path& path);

}  // namespace dartcast
