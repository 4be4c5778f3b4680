// Writes meshes as OpenFOAM's cases, in every form that its programs write: the truth for the reader's tests.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast::test {

/// How a case is written.
struct FoamStyle {
  bool binary = false;
  int label_bytes = 4;
  int scalar_bytes = 8;
  bool big_endian = false;
  bool gzip = false;
};

inline std::vector<FoamStyle> foam_styles() {
  return {{},
          {.gzip = true},
          {.binary = true},
          {.binary = true, .gzip = true},
          {.binary = true, .label_bytes = 8},
          {.binary = true, .label_bytes = 8, .big_endian = true}};
}

/// One polyMesh: faces, each with the cell that owns it and the one behind it, or -1.
struct FoamMesh {
  struct Patch {
    std::string name, type;
    std::size_t size = 0;
    std::string refers{};     ///< of a processorCyclic
    std::string neighbour{};  ///< of a cyclic one
  };
  using Zones = std::vector<std::pair<std::string, std::vector<std::int64_t>>>;

  std::vector<Vec3> points;
  std::vector<std::vector<std::int64_t>> faces;
  std::vector<std::int64_t> owner, neighbour;
  std::vector<Patch> patches;
  Zones cell_zones, face_zones;
};

/// `types`: by the patches' names; of a cyclic one with its partner behind a blank, if it has one.
/// The faces of a mesh, those inside first, then patch by patch. Boundary faces without a patch are in the patch
/// "walls"; patch faces inside are a zone of faces.
inline FoamMesh foam_mesh(const MeshData& mesh, const std::map<std::string, std::string>& types = {}) {
  struct Face {
    std::vector<std::int64_t> corners;
    std::int64_t owner, neighbour = -1;
    std::int32_t tag = 0;
  };
  std::vector<Face> faces;
  std::map<std::set<std::int64_t>, std::size_t> by_corners;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> corners) {
      const std::set<std::int64_t> key(corners.begin(), corners.end());
      const auto [at, added] = by_corners.try_emplace(key, faces.size());
      if (added)
        faces.push_back({{corners.begin(), corners.end()}, static_cast<std::int64_t>(c)});
      else
        faces[at->second].neighbour = static_cast<std::int64_t>(c);
    });
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto corners = mesh.patch_face(f);
    faces[by_corners.at({corners.begin(), corners.end()})].tag = mesh.patch_tags[f];
  }
  FoamMesh out;
  out.points = mesh.points;
  std::map<std::int32_t, std::string> names = mesh.patch_names;
  names[0] = "walls";
  const auto add = [&](const Face& f) {
    out.faces.push_back(f.corners);
    out.owner.push_back(f.owner);
    if (f.neighbour >= 0) out.neighbour.push_back(f.neighbour);
  };
  std::map<std::int32_t, std::vector<std::int64_t>> zones;
  for (const Face& f : faces) {
    if (f.neighbour < 0) continue;
    if (f.tag != 0) zones[f.tag].push_back(static_cast<std::int64_t>(out.faces.size()));
    add(f);
  }
  for (const auto& [tag, labels] : zones) out.face_zones.emplace_back(names[tag], labels);
  for (const auto& [tag, name] : names) {
    const auto type = types.find(name);
    const std::string words = type == types.end() ? "patch" : type->second;
    FoamMesh::Patch patch{name, words.substr(0, words.find(' '))};
    if (words != patch.type) patch.neighbour = words.substr(patch.type.size() + 1);
    for (const Face& f : faces) {
      if (f.neighbour >= 0 || f.tag != tag) continue;
      add(f);
      ++patch.size;
    }
    out.patches.push_back(patch);
  }
  std::map<std::int32_t, std::vector<std::int64_t>> regions;
  for (std::size_t c = 0; c < mesh.regions.size(); ++c)
    regions[mesh.regions[c]].push_back(static_cast<std::int64_t>(c));
  for (const auto& [tag, labels] : regions) out.cell_zones.emplace_back(mesh.region_names.at(tag), labels);
  return out;
}

class FoamWriter {
 public:
  FoamWriter(std::filesystem::path folder, FoamStyle style) : folder_(std::move(folder)), style_(style) {}

  void write(const FoamMesh& mesh) const {
    points("constant", mesh.points);
    std::string faces = style_.binary ? "" : std::to_string(mesh.faces.size()) + "\n(\n";
    std::vector<std::int64_t> offsets = {0}, corners;
    for (const auto& face : mesh.faces) {
      corners.insert(corners.end(), face.begin(), face.end());
      offsets.push_back(static_cast<std::int64_t>(corners.size()));
      if (!style_.binary) faces += labels(face) + "\n";
    }
    faces += style_.binary ? labels(offsets) + "\n" + labels(corners) : ")\n";
    file("constant/polyMesh/faces", style_.binary ? "faceCompactList" : "faceList", faces);
    file("constant/polyMesh/owner", "labelList", labels(mesh.owner));
    file("constant/polyMesh/neighbour", "labelList", labels(mesh.neighbour));
    boundary(mesh);
    if (!mesh.cell_zones.empty()) zones("cellZones", "cellZone", "cellLabels", mesh.cell_zones);
    if (!mesh.face_zones.empty()) zones("faceZones", "faceZone", "faceLabels", mesh.face_zones);
  }

  void points(const std::string& time, const std::vector<Vec3>& points) const {
    file(time + "/polyMesh/points", "vectorField", vectors(points));
  }

  void field(const std::string& time, const std::string& name, const std::vector<Vec3>& values,
             const std::string& type = "volVectorField") const {
    file(time + "/" + name, type,
         "dimensions [0 1 -1 0 0 0 0];\ninternalField nonuniform List<vector>\n" + vectors(values) +
             ";\nboundaryField\n{\n  walls { type zeroGradient; }\n}\n");
  }

  void labels_file(const std::string& name, const std::vector<std::int64_t>& list) const {
    file("constant/polyMesh/" + name, "labelList", labels(list));
  }

  void file(const std::string& name, const std::string& type, const std::string& content) const {
    const std::string label = std::to_string(8 * style_.label_bytes);
    const std::string scalar = std::to_string(8 * style_.scalar_bytes);
    std::string text = "/* a banner\n   // of two lines */\nFoamFile\n{\n  version 2.0;\n  format " +
                       std::string(style_.binary ? "binary" : "ascii") + ";\n  class " + type + ";\n";
    if (style_.binary)
      text += std::string("  arch \"") + (style_.big_endian ? "MSB" : "LSB") + ";label=" + label + ";scalar=" + scalar +
              "\";\n";
    text += "  object x;\n}\n// * * //\n\n" + content + "\n// ***** //\n";
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    if (!style_.gzip) return write_bytes(path, text);
    gzFile_s* out = gzopen((path.string() + ".gz").c_str(), "wb");
    EXPECT_EQ(gzwrite(out, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
    gzclose(out);
  }

  std::string labels(const std::vector<std::int64_t>& list) const {
    std::string out = std::to_string(list.size()) + (style_.binary ? "\n" : "");
    if (style_.binary && list.empty()) return out;
    out += "(";
    for (const std::int64_t label : list) {
      if (!style_.binary) {
        out += (out.back() == '(' ? "" : " ") + std::to_string(label);
      } else if (style_.label_bytes == 4) {
        out += raw(static_cast<std::int32_t>(label));
      } else {
        out += raw(label);
      }
    }
    return out + ")";
  }

 private:
  template <class T>
  std::string raw(T value) const {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (style_.big_endian) std::reverse(bytes.begin(), bytes.end());
    return {bytes.begin(), bytes.end()};
  }

  std::string scalar(double value) const {
    return style_.scalar_bytes == 4 ? raw(static_cast<float>(value)) : raw(value);
  }

  std::string vectors(const std::vector<Vec3>& list) const {
    std::string out = std::to_string(list.size()) + "\n";
    if (style_.binary && list.empty()) return out;
    out += "(";
    char text[120];
    for (const Vec3& x : list) {
      if (style_.binary) {
        out += scalar(x.x) + scalar(x.y) + scalar(x.z);
      } else {
        std::snprintf(text, sizeof text, "(%.17g %.17g %.17g)\n", x.x, x.y, x.z);
        out += text;
      }
    }
    return out + ")";
  }

  void boundary(const FoamMesh& mesh) const {
    std::string text = std::to_string(mesh.patches.size()) + "\n(\n";
    std::size_t start = mesh.neighbour.size();
    for (const auto& p : mesh.patches) {
      text += "  " + p.name + "\n  {\n    type " + p.type + ";\n    inGroups 1(" + p.type + ");\n    " +
              (p.refers.empty() ? "" : "referPatch " + p.refers + ";\n    ") +
              (p.neighbour.empty() ? "" : "neighbourPatch " + p.neighbour + ";\n    ") + "nFaces " +
              std::to_string(p.size) + ";\n    startFace " + std::to_string(start) + ";\n  }\n";
      start += p.size;
    }
    file("constant/polyMesh/boundary", "polyBoundaryMesh", text + ")\n");
  }

  void zones(const std::string& name, const std::string& type, const std::string& key,
             const FoamMesh::Zones& list) const {
    std::string text = std::to_string(list.size()) + "\n(\n";
    for (const auto& [zone, items] : list) {
      text += "\"" + zone + "\"\n{\n  type " + type + ";\n" + key + " List<label> " + labels(items) + ";\n";
      if (type == "faceZone") {
        const std::string flags(items.size(), style_.binary ? '\0' : '0');
        std::string ascii;
        for (std::size_t i = 0; i < items.size(); ++i) ascii += " 0";
        text += "flipMap List<bool> " + std::to_string(items.size()) + "(" + (style_.binary ? flags : ascii) + ");\n";
      }
      text += "}\n";
    }
    file("constant/polyMesh/" + name, "regIOobject", text + ")\n");
  }

  std::filesystem::path folder_;
  FoamStyle style_;
};

/// The part of one processor, as decomposePar makes it: part[c] is that of cell c.
class FoamPart {
 public:
  FoamPart(const FoamMesh& whole, const std::vector<std::size_t>& part, std::size_t own)
      : whole_(whole), part_(part), own_(own) {
    for (std::size_t c = 0; c < part.size(); ++c) {
      if (part[c] != own) continue;
      cell_number_[static_cast<std::int64_t>(c)] = static_cast<std::int64_t>(cells_.size());
      cells_.push_back(static_cast<std::int64_t>(c));
    }
    add_inner_faces();
    add_patches();
    for (std::size_t other = 0; other <= *std::max_element(part.begin(), part.end()); ++other) {
      if (other != own) add_faces_to(other);
    }
    add_cyclic();
    mesh_.cell_zones = own_zones(whole.cell_zones, cell_number_);
    mesh_.face_zones = own_zones(whole.face_zones, face_number_);
  }

  [[nodiscard]] const FoamMesh& mesh() const { return mesh_; }

  void write(const FoamWriter& writer) const {
    writer.write(mesh_);
    writer.labels_file("pointProcAddressing", points_);
    writer.labels_file("cellProcAddressing", cells_);
    writer.labels_file("faceProcAddressing", faces_);
  }

 private:
  using Numbers = std::map<std::int64_t, std::int64_t>;

  void add_inner_faces() {
    for (std::size_t f = 0; f < whole_.neighbour.size(); ++f) {
      if (part_of(whole_.owner[f]) != own_ || part_of(whole_.neighbour[f]) != own_) continue;
      add_face(f, false);
      mesh_.neighbour.push_back(cell_number_.at(whole_.neighbour[f]));
    }
  }

  void add_patches() {
    std::size_t first = whole_.neighbour.size();
    for (const auto& patch : whole_.patches) {
      mesh_.patches.push_back({patch.name, patch.type, 0, "", patch.neighbour});
      for (std::size_t f = first; f < first + patch.size; ++f) {
        if (part_of(whole_.owner[f]) != own_) continue;
        if (patch.type == "cyclic") {
          cyclic_[patch.name].push_back(f);
          continue;
        }
        add_face(f, false);
        ++mesh_.patches.back().size;
      }
      first += patch.size;
    }
  }

  // As if the other half of each cyclic patch were on another processor.
  void add_cyclic() {
    for (const auto& [name, faces] : cyclic_) {
      for (const std::size_t f : faces) add_face(f, false);
      mesh_.patches.push_back(
          {"procBoundary" + std::to_string(own_) + "through" + name, "processorCyclic", faces.size(), name});
    }
  }

  void add_faces_to(std::size_t other) {
    FoamMesh::Patch between{"procBoundary" + std::to_string(own_) + "to" + std::to_string(other), "processor"};
    for (std::size_t f = 0; f < whole_.neighbour.size(); ++f) {
      const std::size_t a = part_of(whole_.owner[f]);
      const std::size_t b = part_of(whole_.neighbour[f]);
      if (!(a == own_ && b == other) && !(a == other && b == own_)) continue;
      add_face(f, b == own_);
      ++between.size;
    }
    if (between.size > 0) mesh_.patches.push_back(between);
  }

  void add_face(std::size_t f, bool turned) {
    std::vector<std::int64_t> corners = whole_.faces[f];
    if (turned) std::reverse(corners.begin(), corners.end());
    for (std::int64_t& p : corners) {
      const auto [at, added] = point_number_.try_emplace(p, static_cast<std::int64_t>(points_.size()));
      if (added) {
        points_.push_back(p);
        mesh_.points.push_back(whole_.points[static_cast<std::size_t>(p)]);
      }
      p = at->second;
    }
    if (!turned) face_number_[static_cast<std::int64_t>(f)] = static_cast<std::int64_t>(mesh_.faces.size());
    mesh_.faces.push_back(corners);
    mesh_.owner.push_back(cell_number_.at(turned ? whole_.neighbour[f] : whole_.owner[f]));
    faces_.push_back(static_cast<std::int64_t>(f + 1) * (turned ? -1 : 1));
  }

  static FoamMesh::Zones own_zones(const FoamMesh::Zones& all, const Numbers& number) {
    FoamMesh::Zones zones;
    for (const auto& [name, labels] : all) {
      zones.emplace_back(name, std::vector<std::int64_t>());
      for (const std::int64_t l : labels) {
        if (const auto at = number.find(l); at != number.end()) zones.back().second.push_back(at->second);
      }
    }
    return zones;
  }

  [[nodiscard]] std::size_t part_of(std::int64_t cell) const { return part_[static_cast<std::size_t>(cell)]; }

  const FoamMesh& whole_;
  const std::vector<std::size_t>& part_;
  std::size_t own_;
  FoamMesh mesh_;
  std::vector<std::int64_t> cells_, points_, faces_;  // their labels in the whole
  std::map<std::string, std::vector<std::size_t>> cyclic_;
  Numbers cell_number_, point_number_, face_number_;
};

/// Writes the folders processor0, processor1 ... of a mesh of which part[c] has cell c.
inline void write_foam_parts(const std::filesystem::path& folder, const FoamStyle& style, const FoamMesh& whole,
                             const std::vector<std::size_t>& part) {
  for (std::size_t k = 0; k <= *std::max_element(part.begin(), part.end()); ++k)
    FoamPart(whole, part, k).write({folder / ("processor" + std::to_string(k)), style});
}

}  // namespace dartcast::test
