// The charts of a run, from its files. Not installed.
#pragma once

#include <filesystem>
#include <string>

namespace dartcast {

/// The name of the scene, from summary.json; that of the folder if it has none.
std::string scene_name(const std::filesystem::path& folder);
/// Charts of the results in stats.csv and summary.json of a run's folder, as HTML. Charts without values, or
/// with zeros alone, are left out. Throws Error, which names the file, if one is damaged.
std::string run_charts(const std::filesystem::path& folder);
/// The same of the method: orientation tests, forecasts, seconds.
std::string method_charts(const std::filesystem::path& folder);

}  // namespace dartcast
