// The verbs of the command. Each adds itself to the command line, and writes its exit status when it has run.
#pragma once

#include "program.hpp"

namespace dartcast::app {

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

}  // namespace dartcast::app
