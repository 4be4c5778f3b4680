// Meshes from arrays with the names and shapes of meshio, and back.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <map>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::python {

/// The arguments of the constructor of MeshData; its docstring describes each.
struct MeshArguments {
  pybind11::object points, cells, regions, region_names, patches, patch_names, free, point_data, cell_data;
};
MeshData mesh_from_arrays(const MeshArguments& given);

/// {"tetra": (n, 4), ..., "polyhedron": [[face, ...], ...], "polygon": [corners, ...]}.
pybind11::dict cells_by_type(const MeshData& mesh);

/// {name: values}: (n,) for one component, else (n, components). Where two arrays have one name the first is taken.
pybind11::dict arrays_by_name(const std::vector<DataArray>& arrays);
/// Throws TypeError or InvalidArgument where an array does not have one value, or one row, for each of `count` items.
std::vector<DataArray> arrays_from(const pybind11::dict& named, std::size_t count, const std::string& of);

}  // namespace dartcast::python
