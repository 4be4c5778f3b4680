// The fields of a scene: arrays of its mesh as samples at times.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast {

/// Whether a name has a star, in whose place numbers stand.
bool is_pattern(std::string_view name);

/// Those of the names that have a whole number in place of the pattern's only star, by number; by name where two
/// numbers are equal.
std::vector<std::string> numbered(std::string_view pattern, const std::vector<std::string>& names);

/// An array of three components as vectors. Throws InvalidMesh that names the arrays there are.
std::vector<Vec3> field_values(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

/// The place of the values that field_values() takes.
FieldPlace field_place(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at);

/// The times of so many samples: those given, or from 0 on at a distance. `owner`: "the field 'U'"; `items`: "arrays",
/// "files". Throws InvalidArgument where the number of times is another one, or several samples have none.
std::vector<double> sample_times(std::string_view owner, const std::vector<double>& times, double spacing,
                                 std::size_t count, std::string_view items);

/// The arrays of a mesh that the scene names, as samples. Throws InvalidMesh, and as sample_times().
FieldSamples field_samples_of(const FieldScene& scene, const MeshData& mesh);

/// None where the scene has no such field. `name`: in messages. Throws InvalidArgument where its files have not been
/// read; InvalidMesh; as VectorField.
std::optional<VectorField> scene_field(const FieldScene& scene, const std::string& name, const MeshData& mesh,
                                       const CellComplex& complex);

}  // namespace dartcast
