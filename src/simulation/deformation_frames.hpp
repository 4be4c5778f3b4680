// Positions that are given at times: from memory, or read ahead from their reader.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/deformation.hpp"
#include "simulation/frame_read_ahead.hpp"

namespace dartcast {

/// Two frames and the place of a time between them; with weight 0 the first alone counts.
struct FramePair {
  std::span<const Vec3> before, after;
  double weight = 0.0;
  FrameReadAhead::Pair read = {};  ///< keeps them; empty where they are in memory

  /// Writes the positions of the vertices in [begin, end).
  void copy(std::size_t begin, std::size_t end, std::span<Vec3> out) const;
};

class DeformationFrames {
 public:
  /// Takes times, and frames or reader. Throws InvalidArgument where times, or frames in memory, are out of the range
  /// that DeformationStep has for them.
  DeformationFrames(DeformationStep step, std::size_t vertices);

  /// For a mesh of the plane: throws InvalidArgument where a frame in memory has a point with z != 0.
  void check_plane() const;

  /// The frames at a time. Waits for them, and throws, as Deformation::load_frames().
  FramePair at(double time, bool in_plane);

 private:
  std::vector<double> times_;
  std::vector<std::vector<Vec3>> frames_;
  std::unique_ptr<FrameReadAhead> ahead_;  // none where all frames are in memory
};

}  // namespace dartcast
