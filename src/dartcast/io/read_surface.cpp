#include "dartcast/io/read_surface.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "dartcast/base/error.hpp"
#include "dartcast/io/file_text.hpp"
#include "dartcast/io/obj.hpp"
#include "dartcast/io/off.hpp"
#include "dartcast/io/parsed_surface.hpp"
#include "dartcast/io/ply.hpp"
#include "dartcast/io/stl.hpp"
#include "dartcast/surface/inspect_surface.hpp"

namespace dartcast {
namespace {

ParsedSurface parse_surface(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool stl = ending == ".stl";
  const bool obj = ending == ".obj";
  const bool ply = ending == ".ply";
  if (!stl && !obj && !ply && ending != ".off") {
    throw InvalidMesh(fmt::format(
        "surfaces in files that end in '{}' are not supported; supported are .stl, .obj, .ply and .off", ending));
  }
  const std::string content = read_bytes(path);
  if (content.empty()) throw InvalidMesh("the file is empty");
  if (stl) return parse_stl(content);
  if (obj) return parse_obj(content);
  return ply ? parse_ply(content) : parse_off(content);
}

}  // namespace

MeshFile check_surface(const std::filesystem::path& path) {
  MeshFile out;
  const auto refuse = [&](std::string message) { out.report.defects.push_back({"file", 1, {}, std::move(message)}); };
  try {
    ParsedSurface parsed = parse_surface(path);
    out.mesh = std::move(parsed.mesh);
    out.report = inspect_surface(out.mesh);
    out.report.format = parsed.format;
    out.report.repairs.insert(out.report.repairs.begin(), parsed.repairs.begin(), parsed.repairs.end());
  } catch (const Error& error) {
    refuse(error.what());
  } catch (const std::bad_alloc&) {
    refuse("the surface is too large for this machine's memory");
  } catch (const std::length_error&) {
    refuse("an array is too large");
  }
  out.report.file = path.string();
  return out;
}

MeshFile read_surface(const std::filesystem::path& path) {
  MeshFile out = check_surface(path);
  if (!out.report.valid()) {
    const Finding& defect = out.report.defects.front();
    std::string places;
    if (!defect.first.empty())
      places = fmt::format(" ({} in all, the first: {})", defect.count, fmt::join(defect.first, ", "));
    throw InvalidMesh(fmt::format("{}: {}{}", path.string(), defect.message, places));
  }
  return out;
}

}  // namespace dartcast
