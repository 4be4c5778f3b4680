// Child processes that share their counts with their parent: it looks whether they fail, crash, or take too long.
#include "soak/apart.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <new>
#include <system_error>
#include <thread>

#include "dartcast/replay.hpp"
#include "soak/run.hpp"

namespace dartcast::soak {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The news of a child to its parent, in memory that both have.
struct Slot {
  std::atomic<std::uint64_t> seed{0};
  std::atomic<std::uint64_t> begun{0};  // cases
  std::atomic<bool> stop{false};
  std::array<char, 2000> wrong{};
  Counts counts;
};

class SharedSlot {
 public:
  SharedSlot() {
    void* memory = mmap(nullptr, sizeof(Slot), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
    slot_ = new (memory) Slot;
  }
  ~SharedSlot() { munmap(slot_, sizeof(Slot)); }
  SharedSlot(const SharedSlot&) = delete;
  SharedSlot& operator=(const SharedSlot&) = delete;
  Slot& operator*() { return *slot_; }
  Slot* operator->() { return slot_; }

 private:
  Slot* slot_;
};

void tell(Slot& slot, const std::string& wrong) {
  std::strncpy(slot.wrong.data(), wrong.c_str(), slot.wrong.size() - 1);
}

template <class Work>
pid_t child_of(Work&& work) {
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child > 0) return child;
  work();
  _exit(0);
}

std::string ending(int status, const Slot& slot) {
  if (slot.wrong[0] != 0) return slot.wrong.data();
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "ended with an error";
}

// A child process that runs cases.
class Child {
 public:
  Child(const SoakOptions& options, unsigned job) : options_(options) {
    pid_ = child_of([&] { work(job); });
  }
  ~Child() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Whether it has ended. `failure`: gets how, unless all went well.
  bool has_ended(std::vector<Failure>& failures) {
    if (slot_->begun != last_begun_) {
      last_begun_ = slot_->begun;
      since_ = Clock::now();
    }
    int status = 0;
    std::string wrong;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      wrong = ending(status, *slot_);
    } else if (seconds_since(since_) > options_.limit) {
      wrong = fmt::format("did not end within {} s", options_.limit);
    } else {
      return false;
    }
    if (!wrong.empty()) failures.push_back({case_of_seed(slot_->seed), wrong});
    return true;
  }
  void stop() { slot_->stop = true; }
  [[nodiscard]] const Counts& counts() { return slot_->counts; }

 private:
  [[nodiscard]] Case case_of_seed(std::uint64_t seed) const {
    Case c = draw_case(seed);
    if (options_.change) options_.change(c);
    return c;
  }
  void work(unsigned job) {
    Seen seen(slot_->counts);
    for (std::uint64_t k = job; k < options_.cases && !slot_->stop; k += options_.jobs) {
      const std::uint64_t seed = options_.seed + k;
      slot_->seed = seed;
      ++slot_->begun;
      const std::string wrong = run_case(case_of_seed(seed), seen);
      if (wrong.empty()) continue;
      tell(*slot_, wrong);
      _exit(1);
    }
  }

  const SoakOptions& options_;
  SharedSlot slot_;
  pid_t pid_ = -1;
  std::uint64_t last_begun_ = 0;
  Clock::time_point since_ = Clock::now();
};

}  // namespace

std::string run_apart(const Case& c, double limit, const std::string& file) {
  SharedSlot slot;
  const pid_t child = child_of([&] {
    Seen seen(slot->counts);
    const std::string wrong = run_case(c, seen);
    tell(*slot, wrong);
    if (seen.replay && !file.empty()) {
      seen.replay->reason = wrong;
      write_replay(*seen.replay, file);
    }
    _exit(wrong.empty() ? 0 : 1);
  });
  const auto start = Clock::now();
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (seconds_since(start) > limit) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return fmt::format("did not end within {} s", limit);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return ending(status, *slot);
}

SoakResult soak(const SoakOptions& options) {
  std::vector<std::unique_ptr<Child>> children;
  for (unsigned job = 0; job < options.jobs; ++job) children.push_back(std::make_unique<Child>(options, job));
  SoakResult result;
  const auto start = Clock::now();
  double said = 0.0;
  while (!children.empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const double seconds = seconds_since(start);
    const bool over = seconds > options.seconds || !result.failures.empty();
    for (auto& child : children)
      if (over) child->stop();
    if (options.say && seconds > said + 60.0) {
      said = seconds;
      Counts so_far = result.counts;
      for (auto& child : children) so_far += child->counts();
      options.say(seconds, so_far);
    }
    std::erase_if(children, [&](std::unique_ptr<Child>& child) {
      if (!child->has_ended(result.failures)) return false;
      result.counts += child->counts();
      return true;
    });
  }
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace dartcast::soak
