// A run on a terminal: a line of progress, and subjects in bold. Nothing of it goes to a file or a pipe.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "dartcast/mesh_files.hpp"

namespace dartcast::app {

bool is_terminal(std::FILE* file);

/// Whether there is an environment variable of this name, and it is not empty.
bool is_set(const char* variable);

/// Whether to print colours: on a terminal that has them, unless the environment variable NO_COLOR is set and not empty
/// (no-color.org).
bool has_colours(std::FILE* file);

/// A summary with the subjects of its lines, in the first column, in bold.
std::string with_bold_subjects(const std::string& table);

/// A line on stderr that is written over, a few times a second: how far a run has come, its rate, the time left.
class ProgressLine {
 public:
  void show(std::uint64_t step, std::uint64_t all);
  /// Removes the line, so that other text takes its place.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_;
  Clock::time_point shown_;
  std::uint64_t first_ = 0;
  bool is_shown_ = false;
};

/// A line on stderr for work whose end is not known: while it lives, it says what is waited for, its stage, and since
/// when. It comes after a second, and on a terminal only.
class WaitingLine {
 public:
  /// `shows`: whether there is a line at all.
  WaitingLine(const std::string& what, bool shows);
  /// From now on the line names this stage, too.
  void enter(std::string_view stage);
  /// Removes the line, so that other text takes its place.
  void end();

 private:
  std::mutex mutex_;
  std::string stage_;
  std::jthread thread_;
};

/// The result of make(options). While it is made, there is a WaitingLine, with the stages of reading.
template <class Make>
auto while_waiting(const std::string& what, bool shows, ReadOptions options, Make&& make) {
  WaitingLine line(what, shows);
  options.on_stage = [&](std::string_view stage) { line.enter(stage); };
  return make(options);
}

/// The text of a line of progress, at most `width` characters, with a bar if there is room. `step` of `all` steps are
/// done; `measured` of them took `seconds`.
std::string progress_text(std::uint64_t step, std::uint64_t all, std::uint64_t measured, double seconds,
                          std::size_t width);

}  // namespace dartcast::app
