// The walls of free cells with their hits, as the content of a file for ParaView. Not installed.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/statistics.hpp"
#include "formats/vtp_write.hpp"

namespace dartcast {

/// The walls of all free cells, in the order of cells and their faces.
struct WallFaceList {
  std::vector<Vertex> vertices;            ///< in the order of coming
  std::vector<std::uint32_t> corners;      ///< of the faces, as places in `vertices`
  std::vector<std::size_t> offsets = {0};  ///< of the faces in `corners`; one more than faces
  std::vector<CellFace> faces;
};
/// Cost: linear in the cells.
WallFaceList wall_face_list(const CombinatorialMap& map);

/// As write_wall_hits() describes it. Cost: linear in the cells.
VtpFile wall_faces_file(const Environment& environment, const WallHits& hits);

}  // namespace dartcast
