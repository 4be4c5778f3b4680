// The frames of a run, read back one by one. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "dartcast/vec3.hpp"
#include "formats/file_series.hpp"

namespace dartcast {

/// The walls of free cells as polygons; in the plane as lines.
struct RunWalls {
  std::vector<Vec3> points;
  std::vector<std::size_t> offsets = {0};
  std::vector<std::uint32_t> corners;
  [[nodiscard]] bool are_lines() const { return offsets.size() > 1 && offsets[1] == 2; }
};

struct RunFrame {
  std::uint64_t step = 0;
  double time = 0.0;
  std::vector<Vec3> points;      ///< of the particles
  std::vector<Vec3> velocities;  ///< one each
  std::vector<double> radii;     ///< one each
  std::vector<std::uint64_t> ids;
};

class RunFrames {
 public:
  /// Throws InvalidArgument if the folder has no list of frames.
  explicit RunFrames(const std::filesystem::path& folder);

  [[nodiscard]] std::size_t size() const { return particles_.files.size(); }
  /// Whether the walls stand still: then those of frame 0 are those of all.
  [[nodiscard]] bool walls_stand() const { return environment_.files.size() == 1; }
  [[nodiscard]] const std::vector<double>& times() const { return particles_.times; }
  /// Throws Error if its file cannot be read.
  [[nodiscard]] RunFrame read(std::size_t frame) const;
  [[nodiscard]] RunWalls walls(std::size_t frame) const;

 private:
  FieldSeries particles_;
  FieldSeries environment_;
};

}  // namespace dartcast
