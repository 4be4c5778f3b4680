// A camera's path as a file for ParaView.
#pragma once

#include "dartcast/catheter.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// The content of a .vtp: one polyline through the cameras with the point arrays "direction" (3), "up" (3) and
/// "arc_length" (1), doubles. A path without a camera is a line without points.
XmlDataSet camera_path_data(const CameraPath& path);

}  // namespace dartcast
