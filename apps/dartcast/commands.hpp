// The verbs of the command. Each adds itself to the command line, and writes its exit status when it has run.
#pragma once

#include <string>

#include "dartcast/mesh_data.hpp"
#include "program.hpp"

namespace dartcast::app {

/// Writes a mesh by the file's ending. A format without a place for the free cells is a note on standard error.
void write_noting_loss(const MeshData& mesh, const std::string& file);

void add_run(CLI::App& app, int& status);
void add_report(CLI::App& app, int& status);
void add_view(CLI::App& app, int& status);
void add_live(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_info(CLI::App& app, int& status);
void add_convert(CLI::App& app, int& status);
void add_mesh(CLI::App& app, int& status);
void add_partition(CLI::App& app, int& status);
void add_plan(CLI::App& app, int& status);
void add_lagrangian(CLI::App& app, int& status);
void add_trace(CLI::App& app, int& status);
void add_replay(CLI::App& app, int& status);
/// These two know the verbs that were added before them.
void add_completion(CLI::App& app, int& status);
void add_help(CLI::App& app, int& status);

}  // namespace dartcast::app
