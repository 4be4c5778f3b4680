// A queue of jobs, bounded by the bytes that they hold, and the thread that does them.
#include "output/writing_thread.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "dartcast/error.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

WritingThread::WritingThread(std::size_t most_bytes) : most_bytes_(most_bytes) {
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error& e) {
    throw Error(fmt::format("the system gives no thread to write files: {}", e.what()));
  }
}

WritingThread::~WritingThread() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void WritingThread::add(std::size_t bytes, std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return error_ || undone_ == 0 || bytes_ + bytes <= most_bytes_; });
  throw_error();
  jobs_.push_back({bytes, std::move(job)});
  bytes_ += bytes;
  ++undone_;
  lock.unlock();
  changed_.notify_all();
}

void WritingThread::check() {
  const std::scoped_lock lock(mutex_);
  throw_error();
}

void WritingThread::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return undone_ == 0; });
  throw_error();
}

double WritingThread::seconds() const {
  const std::scoped_lock lock(mutex_);
  return seconds_;
}

void WritingThread::throw_error() const {
  if (error_) std::rethrow_exception(error_);
}

void WritingThread::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ends_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    const std::size_t bytes = job.bytes;
    const bool wanted = !error_;
    lock.unlock();
    std::exception_ptr error;
    double seconds = 0.0;
    if (wanted) error = run(std::move(job), seconds);
    lock.lock();
    if (error) error_ = error;
    seconds_ += seconds;
    bytes_ -= bytes;
    --undone_;
    changed_.notify_all();
  }
}

// Returns the exception that the job threw, if any. The job's memory is free then.
std::exception_ptr WritingThread::run(Job&& job, double& seconds) {
  const ScopeTimer timer(seconds);
  const Job own = std::move(job);
  try {
    own.run();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace dartcast
