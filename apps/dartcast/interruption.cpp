// Signals that ask a run for its end.
#include "interruption.hpp"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace dartcast::app {

namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t asked = 0;

void ask(int signal) {
  asked = signal;
  constexpr std::string_view text = "\ndartcast: the run ends after this step; once more ends it at once\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
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
  handle(SIGINT, ask);
  handle(SIGTERM, ask);
}

Interruption::~Interruption() {
  handle(SIGINT, SIG_DFL);
  handle(SIGTERM, SIG_DFL);
}

int Interruption::signal() { return asked; }

}  // namespace dartcast::app
