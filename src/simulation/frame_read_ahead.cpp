// The thread that reads frames ahead, and the exchange with those who need them.
#include "simulation/frame_read_ahead.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

// Those that are needed and one to read ahead, or more if they fit.
std::size_t frames_that_fit(std::size_t vertices, std::size_t needed) {
  const std::size_t bytes = std::max<std::size_t>(vertices, 1) * sizeof(Vec3);
  return std::clamp<std::size_t>(frame_memory / bytes, needed + 1, max_frames_held);
}

void check(const std::vector<Vec3>& points, std::size_t frame, std::size_t vertices) {
  if (points.size() != vertices)
    throw InvalidMesh(fmt::format("deformation: frame {} has {} positions; the mesh has {} vertices", frame,
                                  points.size(), vertices));
  const auto bad = std::find_if_not(points.begin(), points.end(), is_finite);
  if (bad != points.end())
    throw InvalidMesh(fmt::format("deformation: frame {}: position {} is not finite", frame, bad - points.begin()));
}

}  // namespace

FrameReadAhead::FrameReadAhead(FrameReader reader, const SampleTimes& times, std::size_t vertices)
    : reader_(std::move(reader)),
      count_(times.size()),
      vertices_(vertices),
      capacity_(frames_that_fit(vertices, times.needed())),
      repeat_(times.repeat()) {}

FrameReadAhead::~FrameReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wanted_.notify_one();
  if (thread_.joinable()) thread_.join();
}

FrameReadAhead::Frames FrameReadAhead::get(std::span<const std::size_t> frames) {
  const std::lock_guard turn(turn_);
  std::unique_lock lock(mutex_);
  if (!thread_.joinable()) start();
  first_ = frames.front();
  // The frames from the first to the last one that is needed, in the order in which they are read.
  const auto place = [&](std::size_t frame) { return (frame + count_ - first_) % count_; };
  std::size_t last = 0;
  for (const std::size_t frame : frames) last = std::max(last, place(frame));
  std::erase_if(frames_, [&](const auto& f) {
    return !is_wanted(f.first) || (place(f.first) <= last && f.second->error != nullptr);
  });
  wanted_.notify_one();
  const auto missing = [&](std::size_t frame) { return !frames_.contains(frame); };
  ready_.wait(lock, [&] { return std::none_of(frames.begin(), frames.end(), missing) || !next().has_value(); });
  rethrow_error(last);
  Frames found;
  for (std::size_t k = 0; k < frames.size(); ++k) found[k] = frames_.at(frames[k]);
  return found;
}

// Throws the error of the first frame that could not be read, if one is among the first ones up to this place. Behind it
// no further one has been read.
void FrameReadAhead::rethrow_error(std::size_t last) const {
  for (std::size_t k = 0; k <= last; ++k) {
    const auto found = frames_.find((first_ + k) % count_);
    if (found != frames_.end() && found->second->error != nullptr) std::rethrow_exception(found->second->error);
  }
}

bool FrameReadAhead::is_wanted(std::size_t frame) const {
  if (repeat_) return (frame + count_ - first_) % count_ < capacity_;
  return frame >= first_ && frame - first_ < capacity_;
}

void FrameReadAhead::start() {
  try {
    thread_ = std::thread([this] { read_on(); });
  } catch (const std::system_error& e) {
    throw Error(fmt::format("deformation: no thread can be started to read frames: {}", e.what()));
  }
}

void FrameReadAhead::read_on() {
  std::unique_lock lock(mutex_);
  while (true) {
    wanted_.wait(lock, [this] { return ends_ || next().has_value(); });
    if (ends_) return;
    const std::size_t frame = *next();
    lock.unlock();
    std::shared_ptr<const ReadFrame> found = read(frame);
    lock.lock();
    if (is_wanted(frame)) frames_.emplace(frame, std::move(found));
    ready_.notify_one();
  }
}

// The first frame that is wanted and not there. After one that cannot be read no further ones are read.
std::optional<std::size_t> FrameReadAhead::next() const {
  for (std::size_t k = 0; k < std::min(capacity_, count_) && (repeat_ || first_ + k < count_); ++k) {
    const std::size_t frame = (first_ + k) % count_;
    const auto found = frames_.find(frame);
    if (found == frames_.end()) return frame;
    if (found->second->error != nullptr) break;
  }
  return std::nullopt;
}

std::shared_ptr<const ReadFrame> FrameReadAhead::read(std::size_t frame) const {
  auto result = std::make_shared<ReadFrame>();
  try {
    result->points = reader_(frame);
    check(result->points, frame, vertices_);
    const auto off =
        std::find_if(result->points.begin(), result->points.end(), [](const Vec3& x) { return x.z != 0.0; });
    if (off != result->points.end()) result->off_plane = static_cast<std::size_t>(off - result->points.begin());
  } catch (...) {
    result->points = {};
    result->error = std::current_exception();
  }
  return result;
}

}  // namespace dartcast
