// Several parts of one mesh as one part, and parts as bytes. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_part.hpp"

namespace dartcast {

/// All cells and points of some parts, each once: part `part` of so many. Faces that some part does not know are unknown
/// if no other has the cell behind them. Throws InvalidMesh if the parts are not of one mesh: one number stands for
/// different points or cells. It throws, too, if an own cell has an unknown face. Precondition: there is a part, and each has ascending numbers.
MeshPart merged_parts(const std::vector<MeshPart>& from, std::uint32_t parts, std::uint32_t part);

/// A part as bytes of this kind of machine.
std::string packed(const MeshPart& part);
/// Throws Error if the bytes are cut off.
MeshPart unpacked_part(std::string_view bytes);

}  // namespace dartcast
