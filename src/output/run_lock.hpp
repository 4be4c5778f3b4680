// One run at a time in an output folder. Not installed.
#pragma once

#include <filesystem>

namespace dartcast {

/// Holds a run's folder while it lives, with a lock on the file run.lock in it. The kernel gives the lock back when the
/// process ends, however it ends; a file that is left behind locks nothing. On a file system without locks nothing is
/// held.
class RunLock {
 public:
  RunLock() = default;
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file.
  ~RunLock();

  /// Takes the folder, which exists; nothing happens if it is held already. Throws Error with the process that holds
  /// it, or if the file cannot be written.
  void take(const std::filesystem::path& folder);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// The lock's name in the folder.
inline constexpr const char* run_lock_name = "run.lock";

}  // namespace dartcast
