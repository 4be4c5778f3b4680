// The files of a run that a report quotes. Not installed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace dartcast {

using RunJson = nlohmann::ordered_json;

/// The text of a file; empty if it cannot be read.
std::string run_text(const std::filesystem::path& path);
/// summary.json of a run's folder; an empty object if it is missing or damaged.
RunJson run_summary(const std::filesystem::path& folder);
/// A whole number of a summary by its path, as "/particles/start"; 0 if it is missing.
std::uint64_t count_in(const RunJson& summary, const char* path);

}  // namespace dartcast
