// The walls of free cells with their hits, as the content of a file for ParaView. Not installed.
#pragma once

#include "dartcast/environment.hpp"
#include "dartcast/statistics.hpp"
#include "formats/vtp_write.hpp"

namespace dartcast {

/// As write_wall_hits() describes it. Cost: linear in the cells.
VtpFile wall_faces_file(const Environment& environment, const WallHits& hits);

}  // namespace dartcast
