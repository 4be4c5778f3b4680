// The processes that a launcher of MPI has started together.
#pragma once

#include <functional>

#include "dartcast/ranks.hpp"
#include "dartcast/threads.hpp"

namespace dartcast::app {

/// Runs a function on the ranks that share the work of this command; none: there is this process alone. Returns its exit
/// status, which is the same on all. If one rank fails, the first that did prints one line with its rank, and all end
/// with `failed`. Throws what `run` throws if there is one process, and Error if a launcher has started several and
/// this command is built without MPI.
int on_ranks(const std::function<int(Ranks*)>& run);

/// As many of this machine's threads as each of its ranks can have. 0, all, if there is one process.
Threads threads_of_rank(const Ranks* ranks);

}  // namespace dartcast::app
