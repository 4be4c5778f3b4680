// Ctrl-C during a run: the step is finished, and what is needed to go on is written.
#pragma once

namespace dartcast::app {

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM only asks for an end. A second one ends the program at once. So
/// does the first one, after a second in which no step has ended. At most one at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// The signal that asked for an end; 0: none.
  [[nodiscard]] static int signal();
  /// To be asked after each step: whether a signal has asked for an end. Then the program has any time to end in order.
  [[nodiscard]] static bool asked_after_step();
  /// From now on there is any time, too: no step is left.
  static void last_step();
};

}  // namespace dartcast::app
