// Finds the parts of a case. A case has a mesh of its own in constant/polyMesh, or only parts in the folders processor0,
// processor1 ... Points and fields of a time may be in either, whatever the mesh is in.
#include "formats/openfoam/foam_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
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

/// Moves to the value of internalField; false if there is none. Collects the values that stand before it, also in
/// files that this one includes. Other directives are passed over: their values are missed if they are needed.
bool find_internal_field(FoamFile& file, const fs::path& folder, std::uint64_t max_memory, FoamMacros& values,
                         unsigned depth = 0) {
  constexpr unsigned deepest = 10;
  while (file.next() != '\0') {
    if (file.next() == '#') {
      const std::string name = file.directive();
      if (name.empty() || depth == deepest || !has_foam_file(folder, name)) continue;
      FoamFile included(folder, name, max_memory, true);
      find_internal_field(included, (folder / name).parent_path(), max_memory, values, depth + 1);
    } else if (file.next() == '$') {
      file.skip_entry();
    } else {
      const std::string key(file.word("a key"));
      if (key == "internalField" && depth == 0) return true;
      values[key] = file.entry();
    }
  }
  return false;
}

std::vector<double> internal_field(const fs::path& folder, std::string_view name, std::size_t components,
                                   std::size_t items, std::uint64_t max_memory) {
  FoamFile file(folder, name, max_memory);
  FoamMacros macros;
  if (!find_internal_field(file, folder, max_memory, macros)) file.fail("there is no internalField");
  file.expand(macros);
  const std::string kind(file.word("'uniform' or 'nonuniform'"));
  if (kind == "nonuniform") {
    std::vector<double> values = file.numbers("values", components);
    if (values.size() != components * items)
      file.fail(fmt::format("{} values for {} cells or points", values.size() / components, items));
    return values;
  }
  if (kind != "uniform") file.fail(fmt::format("internalField {}: it must be uniform or nonuniform", kind));
  std::vector<double> one;
  file.expand(macros);
  if (components > 1) file.expect('(', "before the value of all");
  for (std::size_t k = 0; k < components; ++k) {
    file.expand(macros);
    one.push_back(file.number("a number"));
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < items; ++i) values.insert(values.end(), one.begin(), one.end());
  return values;
}

}  // namespace

std::optional<FoamCase::Field> FoamCase::field(std::string_view name, std::size_t cells, std::size_t points,
                                               std::uint64_t max_memory) const {
  const fs::path whole = folder_of(time_);
  const bool divided = !has_foam_file(whole, name);
  if (divided && processors_.empty()) return std::nullopt;
  const std::string type = foam_class(divided ? processors_.front() / time_ : whole, name);
  const auto* known =
      std::find_if(field_classes.begin(), field_classes.end(), [&](const FieldClass& c) { return c.name == type; });
  if (known == field_classes.end()) return std::nullopt;
  const std::size_t items = known->at_cells ? cells : points;
  Field field{std::string(name), known->at_cells, known->components, {}};
  if (!divided) {
    field.values = internal_field(whole, name, field.components, items, max_memory);
    return field;
  }
  field.values.resize(items * field.components);
  for (const fs::path& processor : processors_) {
    const auto labels = part_labels(processor / "constant" / "polyMesh",
                                    known->at_cells ? "cellProcAddressing" : "pointProcAddressing", max_memory);
    const auto values = internal_field(processor / time_, name, field.components, labels.size(), max_memory);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] >= items)
        throw InvalidMesh(fmt::format("{}/{}/{}: its item {} has the label {}; the whole has {}",
                                      processor.filename().string(), time_, name, i, labels[i], items));
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * field.components), field.components,
                  field.values.begin() + static_cast<std::ptrdiff_t>(labels[i] * field.components));
    }
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
