// Progress and colours on a terminal.
#include "terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <string_view>

namespace dartcast::app {

namespace {

std::size_t width_of(std::FILE* file) {
  winsize size{};
  const bool known = ioctl(fileno(file), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

// "14 s", "3 min 20 s", "2 h 5 min".
std::string duration(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::ceil(std::min(seconds, 1e9)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

}  // namespace

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool is_terminal(std::FILE* file) { return isatty(fileno(file)) != 0; }

bool has_colours(std::FILE* file) {
  const char* terminal = std::getenv("TERM");
  const bool is_dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return is_terminal(file) && !is_dumb && !is_set("NO_COLOR");
}

std::string with_bold_subjects(const std::string& table) {
  std::string out;
  for (std::size_t at = 0; at < table.size();) {
    const std::size_t end = std::min(table.find('\n', at), table.size() - 1) + 1;
    const std::string_view line = std::string_view(table).substr(at, end - at);
    const std::size_t subject = std::min(line.find("  "), line.size() - 1);
    out += subject == 0 ? std::string(line)
                        : fmt::format("\x1b[1m{}\x1b[0m{}", line.substr(0, subject), line.substr(subject));
    at = end;
  }
  return out;
}

std::string progress_text(std::uint64_t step, std::uint64_t all, std::uint64_t measured, double seconds,
                          std::size_t width) {
  std::string text =
      fmt::format("{:3.0f} %  step {} of {}", 100.0 * static_cast<double>(step) / static_cast<double>(all), step, all);
  if (measured > 0 && seconds > 0.0) {
    const double rate = static_cast<double>(measured) / seconds;
    text += fmt::format("  {:.{}f} steps/s", rate, rate < 10.0 ? 1 : 0);
    if (step < all) text += fmt::format("  {} left", duration(static_cast<double>(all - step) / rate));
  }
  constexpr std::size_t bar = 24;
  if (text.size() + bar + 4 <= width) {
    const std::uint64_t filled = step * bar / all;
    text = fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", bar - filled) + text;
  }
  return text.substr(0, width);
}

void ProgressLine::show(std::uint64_t step, std::uint64_t all) {
  const auto now = Clock::now();
  if (start_ == Clock::time_point()) {  // the first step is not timed: it counts from its end
    start_ = now;
    first_ = step;
  }
  if (is_shown_ && step < all && now - shown_ < std::chrono::milliseconds(200)) return;
  shown_ = now;
  is_shown_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  // One column stays free: some terminals break a line that fills them.
  fmt::print(stderr, "\r{}\x1b[K", progress_text(step, all, step - first_, seconds, width_of(stderr) - 1));
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!is_shown_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  is_shown_ = false;
}

WaitingLine::WaitingLine(const std::string& what, bool shows) {
  if (!shows || !is_terminal(stderr)) return;
  thread_ = std::jthread([this, what](const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    std::condition_variable_any end;
    bool is_shown = false;
    while (!stop.stop_requested()) {
      const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - start);
      is_shown = seconds.count() > 0;
      if (is_shown)
        fmt::print(stderr, "\r{}{}{}: {}\x1b[K", what, stage_.empty() ? "" : ", ", stage_,
                   duration(static_cast<double>(seconds.count())));
      std::fflush(stderr);
      end.wait_for(lock, stop, std::chrono::milliseconds(200), [] { return false; });
    }
    if (is_shown) fmt::print(stderr, "\r\x1b[K");
  });
}

void WaitingLine::enter(std::string_view stage) {
  const std::scoped_lock lock(mutex_);
  stage_ = stage;
}

void WaitingLine::end() { thread_ = std::jthread(); }

}  // namespace dartcast::app
