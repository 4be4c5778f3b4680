// Numbered files, and collections of files with their times (.pvd).
#pragma once

#include <filesystem>
#include <vector>

namespace dartcast {

/// Files of a series, and their times where a collection gives them.
struct FieldSeries {
  std::vector<std::filesystem::path> files;
  std::vector<double> times;  ///< s, one for each file; empty: unknown
};

/// The files of a folder with a whole number in place of the star in the path's last part, by number. Throws Error where
/// there is no such file, or the last part has not exactly one star.
FieldSeries numbered_files(const std::filesystem::path& pattern);

/// The files of a ParaView collection, in its order, relative to its folder. Throws Error, with the file's name, where
/// it cannot be read, or has no file, files of several parts, or times that are missing or do not increase.
FieldSeries read_pvd(const std::filesystem::path& path);

}  // namespace dartcast
