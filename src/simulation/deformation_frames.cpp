// Which frames a time needs, and the checks of those in memory.
#include "simulation/deformation_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

// Frames are always the first step of a deformation.
void require(bool holds, std::string_view text) {
  if (!holds) throw InvalidArgument(fmt::format("deformation 1 (frames): {}", text));
}

std::string off_plane(std::size_t frame, std::size_t point, double z) {
  return fmt::format(
      "deformation 1 (frames) moves points out of the plane z = 0, which a planar mesh must not leave: frame {} must "
      "have z = 0 everywhere, and its position {} has z = {}",
      frame, point, z);
}

void check_in_plane(const ReadFrame& read, std::size_t frame) {
  if (read.off_plane) throw InvalidMesh(off_plane(frame, *read.off_plane, read.points[*read.off_plane].z));
}

}  // namespace

void FrameBlend::copy(std::size_t begin, std::size_t end, std::span<Vec3> out) const {
  const std::array<double, 4>& w = use.weights;
  if (use.count == 1) {
    std::copy_n(frames[0].begin() + static_cast<std::ptrdiff_t>(begin), end - begin,
                out.begin() + static_cast<std::ptrdiff_t>(begin));
    return;
  }
  for (std::size_t v = begin; v < end; ++v) out[v] = frames[0][v] * w[0] + frames[1][v] * w[1];
  for (std::size_t k = 2; k < use.count; ++k) {
    for (std::size_t v = begin; v < end; ++v) out[v] += frames[k][v] * w[k];
  }
}

DeformationFrames::DeformationFrames(DeformationStep step, std::size_t vertices) : frames_(std::move(step.frames)) {
  require(!step.reader || frames_.empty(), "give frames or a reader of them, not both");
  require(!step.times.empty() && (step.reader || step.times.size() == frames_.size()),
          "give one time per frame, and at least one frame");
  times_ = SampleTimes("deformation 1 (frames)", std::move(step.times), step.interpolation, step.cycle);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    require(frames_[i].size() == vertices, fmt::format("frame {} must have one position per vertex", i));
    require(std::all_of(frames_[i].begin(), frames_[i].end(), is_finite), fmt::format("frame {} must be finite", i));
  }
  if (step.reader) ahead_ = std::make_unique<FrameReadAhead>(std::move(step.reader), times_, vertices);
}

void DeformationFrames::check_plane() const {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const auto out = std::find_if(frames_[i].begin(), frames_[i].end(), [](const Vec3& x) { return x.z != 0.0; });
    if (out == frames_[i].end()) continue;
    throw InvalidArgument(off_plane(i, static_cast<std::size_t>(out - frames_[i].begin()), out->z));
  }
}

FrameBlend DeformationFrames::at(double time, bool in_plane) {
  FrameBlend blend{{}, times_.at(time), {}};
  const std::span<const std::size_t> used(blend.use.samples.data(), blend.use.count);
  if (ahead_) blend.read = ahead_->get(used);
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (ahead_ && in_plane) check_in_plane(*blend.read[k], used[k]);
    blend.frames[k] = ahead_ ? std::span<const Vec3>(blend.read[k]->points) : frames_[used[k]];
  }
  return blend;
}

}  // namespace dartcast
