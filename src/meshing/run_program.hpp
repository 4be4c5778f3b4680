// Runs another program in a folder, within limits of time and memory, never through a shell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace dartcast {

/// How a program ended.
struct ProgramEnd {
  bool found = true;       ///< whether there is such a program
  bool in_time = true;     ///< false: it was stopped
  int status = 0;          ///< its exit status; 128 and its signal if one ended it
  std::string last_words;  ///< the end of its output, for messages
  [[nodiscard]] bool well() const { return found && in_time && status == 0; }
};

/// A new folder for temporary files. It is removed with all its content when the object ends, or when a signal ends
/// this process before. A small process of its own waits for that.
class TemporaryFolder {
 public:
  /// Throws Error if none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The program that runs in it, which ends with this process. 0: none.
  void set_program(int process) const;

 private:
  std::filesystem::path path_;
  int guard_ = -1;     // a process
  int to_guard_ = -1;  // a connection, open as long as this process is there
};

/// Runs words[0], found as a shell finds it, with the other words. Its output goes to a file in the folder. It is stopped
/// after so many seconds, and cannot take more memory than so many bytes. Throws Error if no process can be made.
ProgramEnd run_program(const std::vector<std::string>& words, const TemporaryFolder& folder, double seconds,
                       std::uint64_t memory);

}  // namespace dartcast
