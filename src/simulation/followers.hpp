// All that must follow an edit of a simulation's environment. Not installed.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"

namespace dartcast {

/// The parts of a simulation register here, and are called in this order: the motion of the vertices; fields, walls
/// near to spheres; inlets; subdivisions. Then come the components in the order of a step, and last the simulation's
/// user.
class Followers {
 public:
  using Follow = std::function<void(const ComplexEditReport& edit, OrphanPolicy orphaned)>;

  /// `again`: whether it also follows edits that are made again, for a checkpoint. The checkpoint puts all else in place.
  void add(Follow follow, bool again = true) { all_.push_back({std::move(follow), again}); }

  void call(const ComplexEditReport& edit, OrphanPolicy orphaned) const {
    for (const Follower& f : all_) {
      if (f.again || !repeating_) f.follow(edit, orphaned);
    }
  }

  /// While it lives, edits are made again.
  class Repeating {
   public:
    explicit Repeating(Followers& followers) : followers_(followers) { followers_.repeating_ = true; }
    Repeating(const Repeating&) = delete;
    Repeating& operator=(const Repeating&) = delete;
    ~Repeating() { followers_.repeating_ = false; }

   private:
    Followers& followers_;
  };

 private:
  struct Follower {
    Follow follow;
    bool again;
  };

  std::vector<Follower> all_;
  bool repeating_ = false;
};

}  // namespace dartcast
