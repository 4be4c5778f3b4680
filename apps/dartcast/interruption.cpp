// Signals that ask a run for its end.
//
// The first one sets an alarm. A step that ends before it switches it off, and the run ends in good order. Else the alarm
// ends the program.
#include "interruption.hpp"

#include <unistd.h>

#include <csignal>
#include <string_view>

#include "program.hpp"

namespace dartcast::app {

namespace {

constexpr unsigned seconds_for_a_step = 1;

// A signal handler can reach nothing else.
volatile std::sig_atomic_t asked = 0;

void say(std::string_view text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

void ask(int signal) {
  asked = signal;
  say("\ndartcast: the run ends after this step; once more ends it at once\n");
  ::alarm(seconds_for_a_step);
}

void give_up(int) {
  say("dartcast: ended within a step, which takes longer than a second; --resume goes on from the last checkpoint\n");
  ::_exit(interrupted + asked);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);  // once more: the default, which ends the program
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

Interruption::Interruption() {
  asked = 0;
  handle(SIGALRM, give_up);
  handle(SIGINT, ask);
  handle(SIGTERM, ask);
}

Interruption::~Interruption() {
  handle(SIGINT, SIG_DFL);
  handle(SIGTERM, SIG_DFL);
  ::alarm(0);
  handle(SIGALRM, SIG_DFL);
}

int Interruption::signal() { return asked; }

bool Interruption::asked_after_step() {
  if (asked != 0) ::alarm(0);
  return asked != 0;
}

void Interruption::last_step() { handle(SIGALRM, SIG_IGN); }

}  // namespace dartcast::app
