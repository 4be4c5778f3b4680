// Runs a program's callbacks, and turns what they throw into one line and an exit status.
#include "program.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>

namespace dartcast::app {

namespace {

// Errors are one line: the lines of a library's message are joined.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

struct Outcome {
  int status = done;
  std::string error;  // empty: none, or said already
};

Outcome parse(CLI::App& app, int argc, char** argv, const int& status) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return {app.exit(e), ""};  // help, version
  } catch (const CLI::ParseError& e) {
    return {wrong_usage, fmt::format("{}; see {} --help", e.what(), app.get_name())};
  } catch (const std::bad_alloc&) {
    return {failed, "there is not enough memory for this"};
  } catch (const std::exception& e) {
    return {failed, e.what()};
  }
  return {status, ""};
}

// Printed text may still wait in a buffer. A full disk, or a closed pipe, shows only when it is sent.
bool send_output() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good(); }

}  // namespace

int run_program(CLI::App& app, int argc, char** argv, const int& status) {
  Outcome outcome = parse(app, argc, argv, status);
  if (!send_output() && outcome.error.empty())
    outcome = {failed, "the output cannot be written to stdout; check the disk's space"};
  if (!outcome.error.empty()) fmt::print(stderr, "{}: {}\n", app.get_name(), one_line(outcome.error));
  return outcome.status;
}

}  // namespace dartcast::app
