// Positions that are given at times: from memory, or read ahead from their reader.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/deformation.hpp"
#include "simulation/frame_read_ahead.hpp"
#include "simulation/sample_times.hpp"

namespace dartcast {

/// The frames that count at a time, and their weights. One alone is copied.
struct FrameBlend {
  std::array<std::span<const Vec3>, 4> frames;
  SampleWeights use;
  FrameReadAhead::Frames read = {};  ///< keeps them; empty if they are in memory

  /// Writes the positions of the vertices in [begin, end).
  void copy(std::size_t begin, std::size_t end, std::span<Vec3> out) const;
};

class DeformationFrames {
 public:
  /// Takes times, and frames or reader. Throws InvalidArgument if times, or frames in memory, are out of the range
  /// that DeformationStep has for them.
  DeformationFrames(DeformationStep step, std::size_t vertices);

  /// For a mesh of the plane: throws InvalidArgument if a frame in memory has a point with z != 0.
  void check_plane() const;

  /// The frames at a time. Waits for them, and throws, as Deformation::load_frames().
  FrameBlend at(double time, bool in_plane);

 private:
  SampleTimes times_;
  std::vector<std::vector<Vec3>> frames_;
  std::unique_ptr<FrameReadAhead> ahead_;  // none if all frames are in memory
};

}  // namespace dartcast
