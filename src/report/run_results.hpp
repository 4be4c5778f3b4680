// The results of a run in words and tables, from its files. Not installed.
#pragma once

#include <filesystem>
#include <string>

namespace dartcast {

/// Some sentences, plain text: how many particles, how long, through what, what came out. Empty without a summary.
std::string run_caption(const std::filesystem::path& folder);
/// Tables: what became of the particles, deposition by patch, times in the scene; solids, bodies and catheters. As HTML.
std::string run_results(const std::filesystem::path& folder);
/// Version, date, the command that makes the run again, the text of the scene, and all numbers of the summary. As HTML.
std::string run_origin(const std::filesystem::path& folder);

}  // namespace dartcast
