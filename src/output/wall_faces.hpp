// The walls of free cells with their hits, as the content of a file for ParaView. Not installed.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/exact_sum.hpp"
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

/// The areas of the walls of free cells by the number of the patch, in the plane lengths. They do not depend on the order
/// of the cells, nor on ranks that have parts of them. `is_own`: whether a cell counts here. Cost: linear in the cells.
std::vector<ExactSum> wall_areas(const Environment& environment, const std::function<bool(Cell)>& is_own);

/// As write_wall_hits() describes it, and the other sums of the faces if asked for. Cost: linear in the cells.
VtpFile wall_faces_file(const Environment& environment, const WallHits& hits, bool with_impacts);

}  // namespace dartcast
