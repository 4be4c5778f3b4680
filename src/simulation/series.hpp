// The names and times of a series: files, or arrays of a mesh.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

/// Whether a name has a star, in whose place numbers stand.
inline bool is_pattern(std::string_view name) { return name.find('*') != std::string_view::npos; }

/// Those of the names that have a whole number in place of the pattern's only star, by number; by name if two numbers are
/// equal.
std::vector<std::string> numbered(std::string_view pattern, const std::vector<std::string>& names);

/// The times of so many samples: those given, or from 0 on at a distance. `owner`: "the field 'U'"; `items`: "arrays",
/// "files". Throws InvalidArgument if the number of times is another one, or several samples have none.
std::vector<double> sample_times(std::string_view owner, const std::vector<double>& times, double spacing,
                                 std::size_t count, std::string_view items);

}  // namespace dartcast
