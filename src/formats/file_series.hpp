// Series of files: numbered ones, collections with their times (.pvd), and those that a scene names.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace dartcast {

/// Files of a series, and their times if a collection gives them.
struct FieldSeries {
  std::vector<std::filesystem::path> files;
  std::vector<double> times;  ///< s, one for each file; empty: unknown
};

/// The files of a folder with a whole number in place of the star in the path's last part, by number. Throws Error if
/// there is no such file, or the last part has not exactly one star.
FieldSeries numbered_files(const std::filesystem::path& pattern);

/// The files of a ParaView collection, in its order, relative to its folder. Throws Error, with the file's name, if it
/// cannot be read, has no file, or has files of several parts. Throws it, too, if times are missing or do not increase.
FieldSeries read_pvd(const std::filesystem::path& path);

/// A series as a scene gives it.
struct NamedSeries {
  std::string owner;  ///< in messages: "the field 'U'"
  std::string array;  ///< of a field; empty: frames
  std::vector<std::filesystem::path> files;
  std::vector<double> times;
  double spacing = 0.0;
};

/// Whether this name alone stands for a series.
bool names_series(const std::filesystem::path& file);

/// Throws InvalidMesh, with the name of the first file that is not there.
void check_exist(std::span<const std::filesystem::path> files);

/// The files and their times, of a field or of frames. A single name may be a collection (.pvd) or a case of OpenFOAM,
/// which have their own times. It may also have a star in place of a number. Throws Error and its kinds if it has no
/// file, or not the right times.
FieldSeries file_series(const NamedSeries& named);

}  // namespace dartcast
