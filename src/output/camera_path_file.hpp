// A camera's path as a file for ParaView.
#pragma once

#include <filesystem>

#include "dartcast/catheter.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// The content of the file; of a path without a camera a line without points.
XmlDataSet camera_path_data(const CameraPath& path);

/// Writes a .vtp: one polyline through the cameras with the point arrays "direction" (3), "up" (3) and "arc_length"
/// (1), doubles. Throws InvalidArgument where the path has no camera or the name does not end in .vtp; Error where the
/// file cannot be written.
void write_camera_path(const CameraPath& path, const std::filesystem::path& file);

}  // namespace dartcast
