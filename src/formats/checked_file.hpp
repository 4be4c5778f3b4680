// The part that meshes and surfaces in files share. Nothing in a file throws, and a caller who asks for a valid one
// gets the reason if it is not.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Calls read(file). An exception of it becomes a defect of kind "file". `what`: "mesh", "surface".
template <class Read>
MeshFile checked_file(const std::filesystem::path& path, const char* what, Read&& read) {
  MeshFile out;
  const auto refuse = [&](std::string message) { out.report.defects.push_back({"file", 1, {}, std::move(message)}); };
  try {
    read(out);
  } catch (const Error& error) {
    refuse(error.what());
  } catch (const std::bad_alloc&) {
    refuse(fmt::format("the {} is too large for this machine's memory", what));
  } catch (const std::length_error&) {
    refuse("an array is too large");
  }
  out.report.file = path.string();
  return out;
}

/// Says that a stage of reading starts.
inline void enter_stage(const ReadOptions& options, std::string_view stage) {
  if (options.on_stage) options.on_stage(stage);
}

/// The file, if it is valid. Throws InvalidMesh with its name, the first defect and the first places of it.
inline MeshFile valid_file(MeshFile file) {
  if (file.report.valid()) return file;
  const Finding& defect = file.report.defects.front();
  std::string places;
  if (!defect.first.empty())
    places = fmt::format(" ({} in all, the first: {})", defect.count, fmt::join(defect.first, ", "));
  throw InvalidMesh(fmt::format("{}: {}{}", file.report.file, defect.message, places));
}

/// Calls make(). Puts the file's name before the message of an InvalidMesh that it throws, unless it is there.
template <class Make>
auto with_file_name(const std::string& name, Make&& make) {
  try {
    return make();
  } catch (const InvalidMesh& e) {
    if (std::string_view(e.what()).starts_with(name)) throw;
    throw InvalidMesh(name + ": " + e.what());
  }
}

}  // namespace dartcast
