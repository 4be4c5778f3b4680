// The pieces that a parallel file of VTK names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast {

/// The files of the pieces, in the folder of the file at `path` or in one within it. Throws InvalidMesh, with the line,
/// if the text is no XML of this kind. Throws it, too, if a file does not have this ending, or is in another folder.
std::vector<std::filesystem::path> named_pieces(const std::filesystem::path& path, const std::string& text,
                                                std::string_view ending);

}  // namespace dartcast
