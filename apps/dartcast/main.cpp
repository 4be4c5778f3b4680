// The command dartcast: its verbs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

#include "commands.hpp"
#include "dartcast/run.hpp"

namespace dartcast::app {

namespace {

// The benchmark is not part of the command. All that it is asked for gets the same answer.
void add_bench(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand("bench", "Say where the benchmark is: the program dartcast-bench.");
  verb->prefix_command();
  verb->callback([&status] {
    fmt::print(stderr,
               "dartcast: the benchmark is a program of its own, dartcast-bench; ./dev bench builds and runs it\n");
    status = wrong_usage;
  });
}

}  // namespace

}  // namespace dartcast::app

int main(int argc, char** argv) {
  namespace verbs = dartcast::app;
  CLI::App app("Carries particles through deforming meshes, exactly.", "dartcast");
  app.set_version_flag("-V,--version", dartcast::version(), "Print the version and exit");
  app.require_subcommand(0, 1);
  app.parse_complete_callback([&app] {
    if (app.get_subcommands().empty())
      throw CLI::RequiredError(fmt::format("one of {}", fmt::join(verbs::verbs_of(app), ", ")));
  });
  int status = verbs::done;
  verbs::add_run(app, status);
  verbs::add_report(app, status);
  verbs::add_view(app, status);
  verbs::add_live(app, status);
  verbs::add_check(app, status);
  verbs::add_info(app, status);
  verbs::add_convert(app, status);
  verbs::add_mesh(app, status);
  verbs::add_partition(app, status);
  verbs::add_plan(app, status);
  verbs::add_lagrangian(app, status);
  verbs::add_trace(app, status);
  verbs::add_replay(app, status);
  verbs::add_bench(app, status);
  verbs::add_completion(app, status);
  verbs::add_help(app, status);
  return verbs::run_program(app, argc, argv, status);
}
