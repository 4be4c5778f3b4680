// Bytes into files: whole files in few calls of the system, replaced at once or not at all. Not installed.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace dartcast {

/// The end of a file's name while it is written. A whole file gets its own name.
inline constexpr std::string_view part_ending = ".part";

/// Writes the pieces to a file, one after the other, over what it held. Throws Error if that fails.
void write_pieces(const std::filesystem::path& path, std::span<const std::string_view> pieces);

/// Writes the pieces to a file beside the path, which then takes its place. Whenever the process ends, the path names
/// the old file or the new one, whole. Throws Error, with the path's name, if that fails; the old file is left then.
void replace_file(const std::filesystem::path& path, std::span<const std::string_view> pieces);

/// Writes behind the end of a file, which exists. Throws Error if that fails.
void append_bytes(const std::filesystem::path& path, std::string_view bytes);

}  // namespace dartcast
