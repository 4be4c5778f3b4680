// An object may serve one call at a time. Calls release Python's lock while they compute, so another thread could enter
// the same object. It gets an error instead.
#pragma once

#include <atomic>
#include <string>

#include "dartcast/error.hpp"

namespace dartcast::python {

/// A second call on an object while one runs: from another thread, or from a response that this call waits for.
class InUse : public Error {
 public:
  using Error::Error;
};

/// Whether a call runs on an object. All objects that share data share one of these.
class Usage {
 public:
  [[nodiscard]] bool begin() { return !used_.exchange(true, std::memory_order_acquire); }
  void end() { used_.store(false, std::memory_order_release); }

 private:
  std::atomic<bool> used_ = false;
};

/// Holds an object for one call. Throws InUse, which names the object, if a call has it already.
class Use {
 public:
  Use(Usage& usage, const char* what) : usage_(usage) {
    if (!usage.begin()) {
      throw InUse(std::string(what) +
                  " is in use by another call: by another thread, or by the call that this response answers. Let that "
                  "call end first, or use an object of its own in each thread");
    }
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use() { usage_.end(); }

 private:
  Usage& usage_;
};

}  // namespace dartcast::python
