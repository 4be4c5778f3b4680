// A mesh as the arrays of a .vtu file.
#pragma once

#include <memory>

#include "dartcast/mesh_data.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// Cells, patch faces and data as write_vtu() writes them. Arrays that stand in the mesh as in the file are not copied:
/// the mesh stays as it is while the data set is used.
XmlDataSet vtu_data_set(const std::shared_ptr<const MeshData>& mesh);

/// The points' array, for a data set of other positions.
XmlArray vtu_points(std::span<const Vec3> points, std::shared_ptr<const void> owner);

}  // namespace dartcast
