// Finds the parts of a case. A case has a mesh of its own in constant/polyMesh, or only parts in the folders processor0,
// processor1 ... Points and fields of a time may be in either, whatever the mesh is in.
#include "formats/openfoam/foam_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/openfoam/merge_parts.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

bool has_faces(const fs::path& folder) { return has_foam_file(folder, "faces"); }

std::optional<double> time_of(std::string_view name) {
  double time = 0.0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), time);
  if (error != std::errc() || end != name.data() + name.size() || !std::isfinite(time)) return std::nullopt;
  return time;
}

std::vector<std::string> names_in(const fs::path& folder, bool folders) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_directory(ignored) == folders) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The folders processor0, processor1 ... of a case, by number.
std::vector<fs::path> processors_of(const fs::path& root) {
  std::vector<fs::path> found;
  std::error_code error;
  for (std::size_t k = 0;; ++k) {
    fs::path folder = root / fmt::format("processor{}", k);
    if (!fs::is_directory(folder, error)) break;
    found.push_back(std::move(folder));
  }
  return found;
}

fs::path without_slash(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

bool is_collated(const fs::path& root) {
  const std::vector<std::string> names = names_in(root, true);
  return std::any_of(names.begin(), names.end(), [](const std::string& n) { return n.starts_with("processors"); });
}

std::optional<FoamCase> FoamCase::find(const fs::path& path) {
  const fs::path plain = without_slash(path);
  std::error_code error;
  FoamCase found;
  if (fs::is_directory(plain, error) && has_faces(plain) && has_foam_file(plain, "owner")) {
    found.mesh_ = plain;
    found.root_ = plain.parent_path().parent_path();
    found.folder_alone_ = true;
    return found;
  }
  const auto take = [&](const fs::path& root) {
    found.root_ = root.empty() ? "." : root;
    found.mesh_ = found.root_ / "constant" / "polyMesh";
    found.processors_ = processors_of(found.root_);
    if (has_faces(found.mesh_)) return true;
    found.parts_ = found.processors_;
    return !found.parts_.empty();
  };
  if (plain.extension() == ".foam" && !fs::is_directory(plain, error)) {
    if (take(plain.parent_path())) return found;
    return std::nullopt;
  }
  if (fs::is_directory(plain, error) && take(plain)) return found;
  const std::string name = plain.filename().string();
  if ((name == "constant" || time_of(name)) && take(plain.parent_path())) {
    found.time_ = name;
    found.names_time_ = true;
    const bool there = fs::is_directory(plain, error) ||
                       (!found.processors_.empty() && fs::is_directory(found.processors_.front() / name, error));
    if (there) return found;
  }
  return std::nullopt;
}

std::vector<FoamTime> FoamCase::times() const {
  std::set<std::string> names;
  for (const std::string& name : names_in(root_, true)) names.insert(name);
  if (!processors_.empty()) {
    for (const std::string& name : names_in(processors_.front(), true)) names.insert(name);
  }
  std::vector<FoamTime> times;
  for (const std::string& name : names) {
    if (const auto time = time_of(name)) times.push_back({*time, name});
  }
  std::stable_sort(times.begin(), times.end(), [](const FoamTime& a, const FoamTime& b) { return a.time < b.time; });
  for (const FoamTime& t : times) {
    for (const char* file : {"polyMesh/faces", "polyMesh/owner"}) {
      if (has(t.name, file))
        throw InvalidMesh(
            fmt::format("{}: the mesh has other faces from the time {} on; a mesh that changes its cells "
                        "cannot be followed: use the times before it",
                        (root_ / t.name / "polyMesh").string(), t.name));
    }
  }
  return times;
}

bool FoamCase::has(std::string_view time, std::string_view file) const {
  const fs::path name(file);
  const auto in = [&](const fs::path& folder) {
    return has_foam_file(folder / time / name.parent_path(), name.filename().string());
  };
  return in(root_) || (!processors_.empty() && std::all_of(processors_.begin(), processors_.end(), in));
}

std::vector<fs::path> FoamCase::mesh_folders() const {
  std::vector<fs::path> folders;
  for (const fs::path& part : parts_) folders.push_back(part / "constant" / "polyMesh");
  return folders;
}

PolyMesh FoamCase::read(std::uint64_t max_memory) const {
  PolyMesh mesh = parts_.empty() ? read_poly_mesh(mesh_, max_memory) : merged_parts(mesh_folders(), max_memory);
  if (time_of_points() == "constant") return mesh;
  std::vector<Vec3> points = this->points(max_memory);
  if (points.size() != mesh.points.size())
    throw InvalidMesh(fmt::format("{}/polyMesh/points: {} points; constant/polyMesh has {}", time_of_points(),
                                  points.size(), mesh.points.size()));
  mesh.points = std::move(points);
  return mesh;
}

std::string FoamCase::time_of_points() const {
  std::string last = "constant";
  if (time_ == "constant") return last;
  if (has(time_, "polyMesh/points")) return time_;
  const double end = *time_of(time_);
  for (const FoamTime& t : times()) {
    if (t.time <= end && has(t.name, "polyMesh/points")) last = t.name;
  }
  return last;
}

std::vector<Vec3> FoamCase::points(std::uint64_t max_memory) const {
  const std::string time = time_of_points();
  if (time == "constant" && parts_.empty()) return read_poly_points(mesh_, max_memory);
  const fs::path whole = folder_of(time) / "polyMesh";
  if (has_foam_file(whole, "points")) return read_poly_points(whole, max_memory);
  struct Part {
    std::vector<std::uint32_t> labels;
    std::vector<Vec3> points;
  };
  std::vector<Part> parts;
  std::size_t most = 0;  // points of the whole: no more than those of the parts together
  for (const fs::path& processor : processors_) {
    auto labels = part_labels(processor / "constant" / "polyMesh", "pointProcAddressing", max_memory);
    std::vector<Vec3> own = read_poly_points(processor / time / "polyMesh", max_memory);
    if (own.size() != labels.size())
      throw InvalidMesh(fmt::format("{}/{}/polyMesh/points: {} points, but pointProcAddressing has {}",
                                    processor.filename().string(), time, own.size(), labels.size()));
    most += own.size();
    parts.push_back({std::move(labels), std::move(own)});
  }
  std::vector<Vec3> points;
  for (const Part& part : parts) {
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      if (part.labels[i] >= most)
        throw InvalidMesh(fmt::format("pointProcAddressing: a point has the label {}; there are at most {} points",
                                      part.labels[i], most));
      if (part.labels[i] >= points.size()) points.resize(part.labels[i] + std::size_t{1});
      points[part.labels[i]] = part.points[i];
    }
  }
  return points;
}

// Fields.

namespace {

struct FieldClass {
  std::string_view name;
  bool at_cells;
  std::size_t components;
};

constexpr std::array<FieldClass, 8> field_classes = {{{"volScalarField", true, 1},
                                                      {"volVectorField", true, 3},
                                                      {"volSymmTensorField", true, 6},
                                                      {"volTensorField", true, 9},
                                                      {"pointScalarField", false, 1},
                                                      {"pointVectorField", false, 3},
                                                      {"pointSymmTensorField", false, 6},
                                                      {"pointTensorField", false, 9}}};

std::vector<PolyPatchRange> patches_with_faces(const fs::path& mesh, std::size_t faces, std::uint64_t max_memory) {
  std::vector<PolyPatchRange> patches = read_poly_patches(mesh, max_memory);
  for (const PolyPatchRange& p : patches) {
    if (p.first > faces || p.size > faces - p.first)
      throw InvalidMesh(fmt::format("{}: the patch {} has faces beyond {}", mesh.string(), p.patch.name, faces));
  }
  return patches;
}

struct FoamPart {
  std::vector<std::uint32_t> labels;  // in the whole
  FoamFieldValues field;
};

// Values of the faces that it shares with the whole's boundary, by the whole's labels.
FoamPart read_foam_part(const fs::path& processor, const std::string& time, std::string_view name, bool at_cells,
                        std::size_t components, bool with_faces, std::uint64_t max_memory) {
  const fs::path mesh = processor / "constant" / "polyMesh";
  FoamPart part{part_labels(mesh, at_cells ? "cellProcAddressing" : "pointProcAddressing", max_memory), {}};
  std::vector<std::int64_t> faces;
  std::vector<PolyPatchRange> patches;
  if (with_faces) {
    faces = FoamFile(mesh, "faceProcAddressing", max_memory).signed_labels("face labels", no_label_limit);
    patches = patches_with_faces(mesh, faces.size(), max_memory);
  }
  part.field = read_foam_field(processor / time, name, components, part.labels.size(), patches, max_memory);
  // They count from 1; a minus says that the face is turned.
  for (std::uint32_t& f : part.field.faces.faces) f = static_cast<std::uint32_t>(std::abs(faces[f]) - 1);
  return part;
}

}  // namespace

std::optional<FoamCase::Field> FoamCase::field(std::string_view name, std::size_t cells, std::size_t points,
                                               std::uint64_t max_memory, bool with_faces) const {
  const fs::path whole = folder_of(time_);
  const bool divided = !has_foam_file(whole, name);
  if (divided && processors_.empty()) return std::nullopt;
  const std::string type = foam_class(divided ? processors_.front() / time_ : whole, name);
  const auto* known =
      std::find_if(field_classes.begin(), field_classes.end(), [&](const FieldClass& c) { return c.name == type; });
  if (known == field_classes.end()) return std::nullopt;
  const std::size_t items = known->at_cells ? cells : points;
  Field field{std::string(name), known->at_cells, known->components, {}, {}};
  if (!divided) {
    std::vector<PolyPatchRange> patches;
    if (with_faces && parts_.empty()) patches = patches_with_faces(mesh_, no_label_limit, max_memory);
    FoamFieldValues read = read_foam_field(whole, name, field.components, items, patches, max_memory);
    field.values = std::move(read.inside);
    field.faces = std::move(read.faces);
    return field;
  }
  field.values.resize(items * field.components);
  for (const fs::path& processor : processors_) {
    const auto [labels, read] =
        read_foam_part(processor, time_, name, known->at_cells, field.components, with_faces, max_memory);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] >= items)
        throw InvalidMesh(fmt::format("{}/{}/{}: its item {} has the label {}; the whole has {}",
                                      processor.filename().string(), time_, name, i, labels[i], items));
      std::copy_n(read.inside.begin() + static_cast<std::ptrdiff_t>(i * field.components), field.components,
                  field.values.begin() + static_cast<std::ptrdiff_t>(labels[i] * field.components));
    }
    field.faces.faces.insert(field.faces.faces.end(), read.faces.faces.begin(), read.faces.faces.end());
    field.faces.values.insert(field.faces.values.end(), read.faces.values.begin(), read.faces.values.end());
  }
  return field;
}

std::vector<std::string> FoamCase::files() const {
  std::set<std::string> names;
  for (const std::string& name : names_in(folder_of(time_), false)) names.insert(name);
  if (!processors_.empty()) {
    for (const std::string& name : names_in(processors_.front() / time_, false)) names.insert(name);
  }
  std::set<std::string> plain;
  for (const std::string& name : names) plain.insert(name.ends_with(".gz") ? name.substr(0, name.size() - 3) : name);
  return {plain.begin(), plain.end()};
}

}  // namespace dartcast
