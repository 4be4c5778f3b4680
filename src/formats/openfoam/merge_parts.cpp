// The addressing files of each part say which label of the whole a point, face or cell has. A face between two parts is
// in both. It has a positive sign in the part of its owner. In the other it is turned over, with a negative sign. A
// cyclic pair on two parts has a face in a patch of each (processorCyclic). Both belong to the patch that it refers to.
#include "formats/openfoam/merge_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {
namespace {

namespace fs = std::filesystem;

struct Part {
  fs::path folder;
  PolyMesh mesh;
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> cells;
  std::vector<std::int64_t> faces;  // label + 1, negative if the face is turned over
};

[[noreturn]] void refuse(const Part& part, const std::string& message) {
  throw InvalidMesh(fmt::format("{}: {}; the parts do not fit together. Run reconstructParMesh, or decomposePar again",
                                (part.folder.parent_path().parent_path().filename() / "constant/polyMesh").string(),
                                message));
}

Part read_part(const fs::path& folder, std::uint64_t max_memory) {
  Part part{folder, read_poly_mesh(folder, max_memory), {}, {}, {}};
  part.points = part_labels(folder, "pointProcAddressing", max_memory);
  part.cells = part_labels(folder, "cellProcAddressing", max_memory);
  FoamFile faces(folder, "faceProcAddressing", max_memory);
  part.faces = faces.signed_labels("face labels", no_label_limit);
  const auto check = [&](std::string_view what, std::size_t labels, std::size_t items) {
    if (labels != items) refuse(part, fmt::format("{} labels for {} {}", labels, items, what));
  };
  check("points", part.points.size(), part.mesh.points.size());
  check("cells", part.cells.size(), part.mesh.cells);
  check("faces", part.faces.size(), part.mesh.faces.size());
  return part;
}

bool between_parts(const PolyPatch& patch) { return patch.type.starts_with("processor"); }

class Whole {
 public:
  explicit Whole(std::vector<Part> parts) : parts_(std::move(parts)) {}

  PolyMesh merge() {
    for (const Part& part : parts_) {
      cells_ += part.mesh.cells;
      points_ += part.mesh.points.size();
      faces_ += part.mesh.faces.size();
    }
    mesh_.cells = cells_;
    check_cells();
    for (const Part& part : parts_) {
      for (const PolyPatch& patch : part.mesh.patches) {
        if (!between_parts(patch)) patch_of(patch);  // in their order, also those without faces
      }
    }
    place_points();
    place_faces();
    write_faces();
    place_zones();
    return std::move(mesh_);
  }

 private:
  struct Place {
    const Part* part = nullptr;
    std::uint32_t face = none;
    bool turned = false;
  };

  void check_cells() const {
    std::vector<bool> taken(cells_);
    for (const Part& part : parts_) {
      for (std::size_t c = 0; c < part.cells.size(); ++c) {
        if (part.cells[c] >= cells_ || taken[part.cells[c]])
          refuse(part, fmt::format("cell {} has the label {}, which is taken or beyond all cells", c, part.cells[c]));
        taken[part.cells[c]] = true;
      }
    }
  }

  void place_points() {
    for (const Part& part : parts_) {
      for (std::size_t i = 0; i < part.points.size(); ++i) {
        if (part.points[i] >= points_) refuse(part, fmt::format("point {} has the label {}", i, part.points[i]));
        if (mesh_.points.size() <= part.points[i]) mesh_.points.resize(part.points[i] + std::size_t{1});
        mesh_.points[part.points[i]] = part.mesh.points[i];
      }
    }
  }

  // The cells on both sides of each face of the whole, and the part in which it lies with its own orientation.
  void place_faces() {
    for (const Part& part : parts_) {
      for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
        const std::int64_t signed_label = part.faces[f];
        const auto label = static_cast<std::size_t>(std::abs(signed_label)) - 1;
        if (signed_label == 0 || label >= faces_)
          refuse(part, fmt::format("face {} has the label {}", f, signed_label));
        if (places_.size() <= label) {
          places_.resize(label + 1);
          mesh_.owner.resize(label + 1, none);
          mesh_.neighbour.resize(label + 1, none);
          mesh_.patch.resize(label + 1, none);
        }
        place_face(part, f, label, signed_label < 0);
      }
    }
  }

  void place_face(const Part& part, std::uint32_t f, std::size_t label, bool turned) {
    const PolyMesh& mesh = part.mesh;
    set_cell(part, turned ? mesh_.neighbour[label] : mesh_.owner[label], mesh.owner[f], label);
    if (mesh.neighbour[f] != none)
      set_cell(part, turned ? mesh_.owner[label] : mesh_.neighbour[label], mesh.neighbour[f], label);
    if (places_[label].part == nullptr || places_[label].turned) places_[label] = {&part, f, turned};
    if (mesh.patch[f] == none) return;
    const PolyPatch& patch = mesh.patches[mesh.patch[f]];
    if (!between_parts(patch)) mesh_.patch[label] = patch_of(patch);
    if (patch.refers.empty()) return;
    const auto whole = patches_.find(patch.refers);
    if (whole == patches_.end())
      refuse(part, fmt::format("the patch {} refers to {}, which is none", patch.name, patch.refers));
    mesh_.patch[label] = whole->second;
  }

  void set_cell(const Part& part, std::uint32_t& of_face, std::uint32_t cell, std::size_t label) const {
    const std::uint32_t whole = part.cells[cell];
    if (of_face != none) refuse(part, fmt::format("face {} of the whole has two cells on one side", label));
    of_face = whole;
  }

  std::uint32_t patch_of(const PolyPatch& patch) {
    const auto [at, added] = patches_.try_emplace(patch.name, static_cast<std::uint32_t>(mesh_.patches.size()));
    if (added) mesh_.patches.push_back(patch);
    return at->second;
  }

  void write_faces() {
    for (std::size_t label = 0; label < places_.size(); ++label) {
      const Place& place = places_[label];
      if (place.part == nullptr || mesh_.owner[label] == none)
        refuse(parts_.front(), fmt::format("face {} of the whole has no owner", label));
      if ((mesh_.neighbour[label] == none) == (mesh_.patch[label] == none))
        refuse(*place.part, fmt::format("face {} of the whole has no cell behind it, and no patch", label));
      for (const std::uint32_t p : place.part->mesh.faces[place.face]) {
        mesh_.faces.labels.push_back(place.part->points[p]);
      }
      if (place.turned)
        std::reverse(mesh_.faces.labels.begin() + static_cast<std::ptrdiff_t>(mesh_.faces.offsets.back()),
                     mesh_.faces.labels.end());
      mesh_.faces.offsets.push_back(mesh_.faces.labels.size());
    }
  }

  void place_zones() {
    for (const Part& part : parts_) {
      add_zones(part.mesh.cell_zones, mesh_.cell_zones, [&](std::uint32_t c) { return part.cells[c]; });
      add_zones(part.mesh.face_zones, mesh_.face_zones,
                [&](std::uint32_t f) { return static_cast<std::uint32_t>(std::abs(part.faces[f]) - 1); });
    }
    for (auto* zones : {&mesh_.cell_zones, &mesh_.face_zones}) {
      for (PolyZone& zone : *zones) {
        std::sort(zone.labels.begin(), zone.labels.end());
        zone.labels.erase(std::unique(zone.labels.begin(), zone.labels.end()), zone.labels.end());
      }
    }
  }

  template <class Label>
  static void add_zones(const std::vector<PolyZone>& from, std::vector<PolyZone>& to, Label&& label) {
    for (const PolyZone& zone : from) {
      auto found = std::find_if(to.begin(), to.end(), [&](const PolyZone& z) { return z.name == zone.name; });
      if (found == to.end()) found = to.insert(to.end(), {zone.name, {}});
      for (const std::uint32_t l : zone.labels) found->labels.push_back(label(l));
    }
  }

  std::vector<Part> parts_;
  std::size_t cells_ = 0, points_ = 0, faces_ = 0;  // sums over the parts
  PolyMesh mesh_;
  std::vector<Place> places_;
  std::map<std::string, std::uint32_t> patches_;
};

}  // namespace

std::vector<std::uint32_t> part_labels(const fs::path& folder, std::string_view name, std::uint64_t max_memory) {
  FoamFile file(folder, name, max_memory);
  return file.labels("labels of the whole", no_label_limit);
}

PolyMesh merged_parts(std::span<const fs::path> folders, std::uint64_t max_memory) {
  std::vector<Part> parts;
  parts.reserve(folders.size());
  for (const fs::path& folder : folders) {
    try {
      parts.push_back(read_part(folder, max_memory));
    } catch (const InvalidMesh& e) {
      const std::string processor = folder.parent_path().parent_path().filename().string();
      if (std::string_view(e.what()).starts_with(processor)) throw;
      throw InvalidMesh(fmt::format("{}/{}", processor, e.what()));
    }
  }
  return Whole(std::move(parts)).merge();
}

}  // namespace dartcast
