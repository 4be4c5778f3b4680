// Ctrl-C during a run: the step is finished, and what is needed to go on is written.
#pragma once

namespace dartcast::app {

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM only asks for an end. A second one ends the program at once. At
/// most one at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// The signal that asked for an end; 0: none.
  [[nodiscard]] static int signal();
};

}  // namespace dartcast::app
