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

void FramePair::copy(std::size_t begin, std::size_t end, std::span<Vec3> out) const {
  if (before.data() == after.data()) {
    std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(begin), end - begin,
                out.begin() + static_cast<std::ptrdiff_t>(begin));
    return;
  }
  for (std::size_t v = begin; v < end; ++v) out[v] = before[v] * (1 - weight) + after[v] * weight;
}

DeformationFrames::DeformationFrames(DeformationStep step, std::size_t vertices)
    : times_(std::move(step.times)), frames_(std::move(step.frames)) {
  require(!step.reader || frames_.empty(), "give frames or a reader of them, not both");
  require(!times_.empty() && (step.reader || times_.size() == frames_.size()),
          "give one time per frame, and at least one frame");
  for (std::size_t i = 0; i < times_.size(); ++i)
    require(std::isfinite(times_[i]) && (i == 0 || times_[i] > times_[i - 1]), "times must be finite and increasing");
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    require(frames_[i].size() == vertices, fmt::format("frame {} must have one position per vertex", i));
    require(std::all_of(frames_[i].begin(), frames_[i].end(), is_finite), fmt::format("frame {} must be finite", i));
  }
  if (step.reader) ahead_ = std::make_unique<FrameReadAhead>(std::move(step.reader), times_.size(), vertices);
}

void DeformationFrames::check_plane() const {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const auto out = std::find_if(frames_[i].begin(), frames_[i].end(), [](const Vec3& x) { return x.z != 0.0; });
    if (out == frames_[i].end()) continue;
    throw InvalidArgument(off_plane(i, static_cast<std::size_t>(out - frames_[i].begin()), out->z));
  }
}

FramePair DeformationFrames::at(double time, bool in_plane) {
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  std::size_t after = static_cast<std::size_t>(next - times_.begin());
  const std::size_t before = after == 0 ? 0 : after - 1;
  after = std::min(after, times_.size() - 1);
  const double weight = before == after ? 0.0 : (time - times_[before]) / (times_[after] - times_[before]);
  if (!ahead_) return {frames_[before], frames_[after], weight};
  FrameReadAhead::Pair read = ahead_->get(before, after);
  if (in_plane) {
    check_in_plane(*read.before, before);
    check_in_plane(*read.after, after);
  }
  return {read.before->points, read.after->points, weight, read};
}

}  // namespace dartcast
