// Cuts of a face in a draft. Private.
#pragma once

#include <cstdint>

#include "dartcast/map_edits.hpp"

namespace dartcast::detail {

/// Splits a face. It keeps its corners from u to v. A new face at the end takes those from v to u. The edge between
/// them is one between faces in one plane. Precondition: both are corners of the face, and no edge of it joins them.
/// Throws EditRefused if a draft gets more faces than numbers of 16 bits name.
void cut_face(CellDraft& draft, std::uint16_t face, Vertex u, Vertex v);

}  // namespace dartcast::detail
