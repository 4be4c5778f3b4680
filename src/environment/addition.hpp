// Undoes an addition of particles if an exception ends it, as that of memory. Not installed.
#pragma once

#include "dartcast/environment.hpp"

namespace dartcast {

class Addition {
 public:
  explicit Addition(Particles& particles) : particles_(particles), before_(particles.size()) {}
  Addition(const Addition&) = delete;
  Addition& operator=(const Addition&) = delete;
  ~Addition() {
    if (!kept_) particles_.truncate(before_);
  }
  /// The addition is done.
  void keep() { kept_ = true; }

 private:
  Particles& particles_;
  std::size_t before_;
  bool kept_ = false;
};

}  // namespace dartcast
