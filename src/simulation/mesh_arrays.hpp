// The arrays of a mesh, by name.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast {

/// The values of a point array of so many components. Throws InvalidMesh that names the arrays there are.
const std::vector<double>& point_values(const MeshData& mesh, const std::string& array, std::size_t components);

/// An array of three components as vectors. If they are wanted at the points, but are at the cells, these give each point
/// theirs (mesh/point_weights.hpp). Throws as point_values().
std::vector<Vec3> field_values(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

/// The place of the values that field_values() takes.
FieldPlace field_place(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

/// The arrays of a mesh that the scene names, as samples. Throws InvalidMesh, and as sample_times().
FieldSamples field_samples_of(const FieldScene& scene, const MeshData& mesh);

/// An array of any number of components.
struct ArrayInMesh {
  std::size_t components = 1;
  FieldPlace place = FieldPlace::points;
  std::vector<double> values;
};

/// The first array of this name, points before cells, brought to where it is wanted. Throws InvalidMesh if there is none.
ArrayInMesh array_in_mesh(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

/// The components 3 part, 3 part + 1 and 3 part + 2; 0 behind the last.
std::vector<Vec3> three_components(const ArrayInMesh& array, std::size_t part);

/// An array of the mesh, at one time. Throws likewise.
ArraySamples array_samples_of(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

}  // namespace dartcast
