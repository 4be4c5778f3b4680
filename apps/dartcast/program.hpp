// The frame of a program: its arguments, its errors as one line, its exit status.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dartcast::app {

/// Exit status of a program.
inline constexpr int done = 0;
inline constexpr int failed = 1;
inline constexpr int wrong_usage = 2;
inline constexpr int interrupted = 128;  ///< and the number of the signal: 130 after Ctrl-C

/// The names of all verbs, in the order of the overview.
std::vector<std::string> verbs_of(const CLI::App& app);

/// Parses the arguments and runs what they name. An error is one line on stderr, after the program's name. For a verb or
/// an option that there is not, it has the one that was meant, if one is close. Returns
/// `status` as the callbacks have left it, or the exit status of the error.
int run_program(CLI::App& app, int argc, char** argv, const int& status);

}  // namespace dartcast::app
