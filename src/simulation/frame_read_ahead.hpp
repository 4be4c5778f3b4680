// Reads the frames of a motion ahead of the time that is needed, by a thread.
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "dartcast/deformation.hpp"
#include "simulation/sample_times.hpp"

namespace dartcast {

/// A frame that has been read, or the reason why not.
struct ReadFrame {
  std::vector<Vec3> points;
  std::optional<std::size_t> off_plane;  ///< the first point with z != 0
  std::exception_ptr error;
};

/// Holds the frames from the one before the time that is needed, as many as fit in the memory for them. If time
/// jumps the frames from there are read instead.
class FrameReadAhead {
 public:
  /// Frames of so many vertices at these times. The thread starts with the first call of get().
  FrameReadAhead(FrameReader reader, const SampleTimes& times, std::size_t vertices);
  /// Waits for the frame that is being read.
  ~FrameReadAhead();
  FrameReadAhead(const FrameReadAhead&) = delete;
  FrameReadAhead& operator=(const FrameReadAhead&) = delete;

  using Frames = std::array<std::shared_ptr<const ReadFrame>, 4>;
  /// Waits for frames, at most SampleTimes::needed(), in the order of their times; of a cycle again from 0 behind the
  /// last. Any thread may call it; one at a time is served. Throws if one cannot be read: now, not only when it was
  /// tried ahead of its time. Throws Error if no thread can be started.
  Frames get(std::span<const std::size_t> frames);

  /// Frames that are held at most.
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

 private:
  void start();
  void read_on();
  [[nodiscard]] std::optional<std::size_t> next() const;
  [[nodiscard]] bool is_wanted(std::size_t frame) const;
  [[nodiscard]] std::shared_ptr<const ReadFrame> read(std::size_t frame) const;
  void rethrow_error(std::size_t last) const;

  const FrameReader reader_;
  const std::size_t count_, vertices_, capacity_;
  const bool repeat_;
  std::mutex turn_;   // held by the caller who is served
  std::mutex mutex_;  // guards the members below
  std::condition_variable wanted_, ready_;
  std::size_t first_ = 0;  // of the frames that are wanted
  std::map<std::size_t, std::shared_ptr<const ReadFrame>> frames_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace dartcast
