// The files of a series that a scene names: of a field, or of frames.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/field_series.hpp"

namespace dartcast {

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

/// The files and their times. A single name may be a collection (.pvd) or a case of OpenFOAM, which have their own
/// times, or have a star in place of a number. Throws Error and its kinds where it has no
/// file, or not the right times.
FieldSeries file_series(const NamedSeries& named);

}  // namespace dartcast
