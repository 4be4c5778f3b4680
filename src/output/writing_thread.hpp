// A thread that writes a run's files, in the order in which the run hands them over. Not installed.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace dartcast {

/// Does jobs one after the other. After a job that throws, no other is done: what is on the disk stays as a run leaves
/// it that is cut off there.
class WritingThread {
 public:
  /// `most_bytes`: of the jobs that wait or are being done. One alone may be larger.
  explicit WritingThread(std::size_t most_bytes = std::size_t{64} << 20U);
  WritingThread(const WritingThread&) = delete;
  WritingThread& operator=(const WritingThread&) = delete;
  /// Does the jobs that wait.
  ~WritingThread();

  /// Waits until there is place for a job that holds so many bytes, and leaves it to the thread. The job must own what
  /// it uses. Throws what an earlier job threw.
  void add(std::size_t bytes, std::function<void()> job);
  /// Throws what a job threw.
  void check();
  /// Waits until all jobs are done. Throws what a job threw.
  void finish();
  /// Spent in jobs so far.
  [[nodiscard]] double seconds() const;

 private:
  struct Job {
    std::size_t bytes;
    std::function<void()> run;
  };

  void work();
  static std::exception_ptr run(Job&& job, double& seconds);
  void throw_error() const;

  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::size_t bytes_ = 0;   // of all jobs that are not done
  std::size_t undone_ = 0;  // jobs that are not done
  bool ends_ = false;
  std::exception_ptr error_;
  double seconds_ = 0.0;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace dartcast
