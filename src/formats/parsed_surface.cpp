// Faces, points and regions of a surface, as its reader finds them.
#include "formats/parsed_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "dartcast/error.hpp"
#include "formats/parsed_mesh.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

constexpr std::size_t surface_face_limit = std::size_t{1} << 29U;

[[noreturn]] void fail_in_surface(const FileText& text, bool binary, std::string_view message) {
  if (binary) text.fail_at_byte(message);
  text.fail(message);
}

}  // namespace

void ParsedSurface::add_face(std::span<const std::uint32_t> corners, const FileText& text, bool binary) {
  const std::size_t number = mesh.types.size() + short_faces.count;
  if (corners.size() == 1 || corners.size() == 2) {
    if (short_faces.count == 0) {
      mesh.source.resize(mesh.types.size());
      std::iota(mesh.source.begin(), mesh.source.end(), 0U);
    }
    short_faces.add(number);
    return;
  }
  if (corners.empty() || corners.size() > polyhedron_limit) {
    fail_in_surface(text, binary,
                    fmt::format("a face of {} corners; remove it or divide it: a face has 3 to {}", corners.size(),
                                polyhedron_limit));
  }
  if (number >= surface_face_limit) fail_in_surface(text, binary, "more than 2^29 faces");
  mesh.add_cell(plane_type(corners.size()), corners);
  mesh.regions.push_back(region_);
  if (short_faces.count > 0) mesh.source.push_back(static_cast<std::uint32_t>(number));
}

void ParsedSurface::add_point(const Vec3& point, const FileText& text, bool binary) {
  if (!is_finite(point)) fail_in_surface(text, binary, "a coordinate is not a finite number");
  if (mesh.points.size() >= no_point) fail_in_surface(text, binary, "more than 2^32 - 2 points");
  mesh.points.push_back(point);
}

void ParsedSurface::enter_region(std::string_view name) {
  constexpr std::string_view spaces = " \t\r\v\f";
  name.remove_prefix(std::min(name.find_first_not_of(spaces), name.size()));
  name.remove_suffix(name.size() - (name.find_last_not_of(spaces) + 1));
  if (name.empty()) {
    region_ = 0;
    return;
  }
  auto found = tags_.find(name);
  if (found == tags_.end()) found = tags_.emplace(name, static_cast<std::int32_t>(tags_.size() + 1)).first;
  region_ = found->second;
}

void ParsedSurface::warn(std::string_view message) {
  const auto known =
      std::find_if(warnings.begin(), warnings.end(), [&](const Finding& w) { return w.message == message; });
  Finding& warning =
      known != warnings.end() ? *known : warnings.emplace_back(Finding{"form", 0, {}, std::string(message)});
  ++warning.count;
}

void ParsedSurface::finish() {
  add_finding(warnings, short_faces);
  if (mesh.types.empty()) throw InvalidMesh("the file has no faces; it is truncated, or has points and lines only");
  std::vector<bool> used(tags_.size() + 1, false);
  for (const std::int32_t tag : mesh.regions) used[static_cast<std::size_t>(tag)] = true;
  for (const auto& [name, tag] : tags_) {
    if (used[static_cast<std::size_t>(tag)]) mesh.region_names[tag] = name;
  }
  if (mesh.region_names.empty()) mesh.regions.clear();
}

}  // namespace dartcast
