// The command dartcast: its verbs, and its errors as one line and an exit status.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "commands.hpp"
#include "dartcast/run.hpp"

namespace {

// Errors are one line: the lines of a library's message are joined.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

struct Outcome {
  int status = dartcast::app::done;
  std::string error;  // empty: none, or said already
};

Outcome run(int argc, char** argv) {
  namespace verbs = dartcast::app;
  CLI::App app("Carries particles through deforming meshes, exactly.", "dartcast");
  app.set_version_flag("--version", dartcast::version());
  app.require_subcommand(0, 1);
  int status = verbs::done;
  verbs::add_run(app, status);
  verbs::add_report(app, status);
  verbs::add_view(app, status);
  verbs::add_check(app, status);
  verbs::add_info(app, status);
  verbs::add_convert(app, status);
  verbs::add_mesh(app, status);
  verbs::add_partition(app, status);
  verbs::add_plan(app, status);
  verbs::add_lagrangian(app, status);
  verbs::add_trace(app, status);
#ifdef DARTCAST_BENCH
  verbs::add_bench(app, status);
#endif
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty())
      throw CLI::RequiredError("one of run, report, view, check, info, convert, trace, bench");
  } catch (const CLI::Success& e) {
    return {app.exit(e), ""};  // help, version
  } catch (const CLI::ParseError& e) {
    return {verbs::wrong_usage, fmt::format("{}; see dartcast --help", e.what())};
  } catch (const std::bad_alloc&) {
    return {verbs::failed, "there is not enough memory for this"};
  } catch (const std::exception& e) {
    return {verbs::failed, e.what()};
  }
  return {status, ""};
}

// Printed text may still wait in a buffer. A full disk, or a closed pipe, shows only when it is sent.
bool send_output() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good(); }

}  // namespace

int main(int argc, char** argv) {
  Outcome outcome = run(argc, argv);
  if (!send_output() && outcome.error.empty())
    outcome = {dartcast::app::failed, "the output cannot be written to stdout; check the disk's space"};
  if (!outcome.error.empty()) fmt::print(stderr, "dartcast: {}\n", one_line(outcome.error));
  return outcome.status;
}
