// The verbs of the command. Each adds itself to the command line, and writes its exit status when it has run.
#pragma once

#include <CLI/CLI.hpp>

namespace dartcast::app {

/// Exit status of the command.
inline constexpr int done = 0;
inline constexpr int failed = 1;
inline constexpr int wrong_usage = 2;
inline constexpr int interrupted = 128;  ///< and the number of the signal: 130 after Ctrl-C

void add_run(CLI::App& app, int& status);
void add_report(CLI::App& app, int& status);
void add_view(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_info(CLI::App& app, int& status);
void add_convert(CLI::App& app, int& status);
void add_mesh(CLI::App& app, int& status);
void add_partition(CLI::App& app, int& status);
void add_plan(CLI::App& app, int& status);
void add_lagrangian(CLI::App& app, int& status);
void add_trace(CLI::App& app, int& status);
#ifdef DARTCAST_BENCH
void add_bench(CLI::App& app, int& status);
#endif

}  // namespace dartcast::app
