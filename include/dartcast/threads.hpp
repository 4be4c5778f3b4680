// How many threads a call may use. Results never depend on it.
#pragma once

namespace dartcast {

/// How many threads a loop may use; 0: all that the machine has, or as many of them as the system gives.
struct Threads {
  unsigned count = 0;
};

/// The most threads that can be asked for: 256, or as many as the machine has where these are more.
unsigned max_threads();

/// Throws InvalidArgument where there are more threads than max_threads(), and Error where the system does not give so
/// many now: their number, or memory, is limited. Loops ask for themselves, too: call it to hear of it early. Cost:
/// the first time for a number, to start and end so many threads; then none.
void check_threads(Threads threads);

}  // namespace dartcast
