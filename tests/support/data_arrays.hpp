// Arrays of values in files, by name.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_data.hpp"
#include "formats/point_file.hpp"

namespace dartcast::test {

/// Throws Error where there is no array of this name.
inline const DataArray& array(const std::vector<DataArray>& arrays, const std::string& name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
  if (found == arrays.end()) throw Error("no array " + name);
  return *found;
}
inline const DataArray& array(const PointFile& file, const std::string& name) { return array(file.arrays, name); }

}  // namespace dartcast::test
