// The charts and tables of a run, from its files. Not installed.
#pragma once

#include <filesystem>
#include <string>

namespace dartcast {

/// The name of the scene, from summary.json; that of the folder if it has none.
std::string scene_name(const std::filesystem::path& folder);
/// Charts of stats.csv and summary.json in a run's folder, as HTML. Charts without values, or
/// with zeros alone, are left out. Throws Error, which names the file, if one is damaged.
std::string run_charts(const std::filesystem::path& folder);
/// Tables of summary.json and the text of scene.toml.
std::string run_tables(const std::filesystem::path& folder);

}  // namespace dartcast
