// The number of threads that a call may use. Results never depend on it.
#pragma once

namespace dartcast {

/// The number of threads that a loop may use. 0: all threads of the machine, or as many of them as the system gives.
struct Threads {
  unsigned count = 0;
};

/// The largest number of threads that a caller can ask for: 256, or the number of the machine's threads if that is
/// more.
unsigned max_threads();

/// Throws InvalidArgument if there are more threads than max_threads(). Throws Error if the system cannot give so many
/// now, because their number or the memory is limited. Loops do this check, too; call it to get the error early. Cost:
/// the first time for a number, to start and end so many threads; then none.
void check_threads(Threads threads);

}  // namespace dartcast
