// Pairs of patches that lead to each other: cyclic patches, whose faces are partners in their order, and the two wedges.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "formats/openfoam/poly_cells.hpp"
#include "mesh/periodic_pairs.hpp"

namespace dartcast {
namespace {

bool is_cyclic(const PolyPatch& patch) { return patch.type.starts_with("cyclic") || patch.type == "wedge"; }

// The corners of a patch's faces, in the order of the file.
std::vector<std::vector<Vec3>> faces_of(const PolyMesh& mesh, std::size_t patch, const CornersOfFace& corners,
                                        std::span<const Vec3> points) {
  std::vector<std::vector<Vec3>> faces;
  for (std::uint32_t f = 0; f < mesh.patch.size(); ++f) {
    if (mesh.patch[f] != patch) continue;
    std::vector<Vec3>& places = faces.emplace_back();
    for (const std::uint32_t p : corners(f)) places.push_back(points[p]);
  }
  return faces;
}

Vec3 middle_of(const std::vector<Vec3>& face) {
  Vec3 sum;
  for (const Vec3& x : face) sum += x;
  return sum * (1.0 / static_cast<double>(face.size()));
}

// Out of the mesh; of twice the area's size, in the plane of the edge's.
Vec3 normal_of(const std::vector<Vec3>& face) {
  if (face.size() == 2) return {face[1].y - face[0].y, face[0].x - face[1].x, 0.0};
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < face.size(); ++k) sum += cross(face[k] - face[0], face[k + 1] - face[0]);
  return sum;
}

// A face's middle, and a place off it by its size: together they show a turn of one row of faces.
std::array<Vec3, 2> middle_and_tip(const std::vector<Vec3>& face, double side) {
  const Vec3 normal = normal_of(face);
  const double size = norm(normal);
  const Vec3 middle = middle_of(face);
  return {middle, middle + normal * (side * (face.size() == 2 ? 1.0 : 1.0 / std::sqrt(size)))};
}

class CyclicPairs {
 public:
  CyclicPairs(const PolyMesh& mesh, const CornersOfFace& corners, ParsedMesh& parsed)
      : mesh_(mesh), corners_(corners), parsed_(parsed), paired_(mesh.patches.size()) {}

  void add() {
    std::vector<std::size_t> wedges;
    for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
      if (mesh_.patches[p].type == "cyclic") add_cyclic(p);
      if (mesh_.patches[p].type == "wedge" && !faces(p).empty()) wedges.push_back(p);
    }
    if (wedges.size() == 2) add_wedges(wedges[0], wedges[1]);
    warn_of_others();
  }

 private:
  using Faces = std::vector<std::vector<Vec3>>;

  // A face that is none of the new mesh has no corners.
  [[nodiscard]] Faces faces(std::size_t patch) const {
    Faces all = faces_of(mesh_, patch, corners_, parsed_.mesh.points);
    std::erase_if(all, [](const std::vector<Vec3>& face) { return face.size() < 2; });
    return all;
  }

  void add_cyclic(std::size_t a) {
    const PolyPatch& patch = mesh_.patches[a];
    const auto leads_back = [&](const PolyPatch& other) {
      return other.name == patch.neighbour && other.type == "cyclic" && other.neighbour == patch.name;
    };
    const auto found = std::find_if(mesh_.patches.begin(), mesh_.patches.end(), leads_back);
    const auto b = static_cast<std::size_t>(found - mesh_.patches.begin());
    if (found == mesh_.patches.end() || b <= a) return;
    const Faces from = faces(a);
    const Faces to = faces(b);
    if (from.size() != to.size()) return;
    std::vector<PartnerPlaces> places;
    for (std::size_t f = 0; f < from.size(); ++f) {
      const auto x = middle_and_tip(from[f], 1.0);
      const auto y = middle_and_tip(to[f], -1.0);
      places.push_back({x[0], y[0]});
      places.push_back({x[1], y[1]});
    }
    put(a, b, fitted_pair(places));
  }

  void add_wedges(std::size_t a, std::size_t b) {
    const Faces from = faces(a);
    const Faces to = faces(b);
    put(a, b, rotation_between(middle_of(from[0]), unit_normal(from), middle_of(to[0]), unit_normal(to)));
  }

  static Vec3 unit_normal(const Faces& faces) {
    Vec3 sum;
    for (const std::vector<Vec3>& face : faces) sum += normal_of(face);
    return sum * (1.0 / norm(sum));
  }

  void put(std::size_t a, std::size_t b, std::optional<PeriodicPair> pair) {
    if (!pair) return;
    pair->a = mesh_.patches[a].name;
    pair->b = mesh_.patches[b].name;
    parsed_.mesh.periodic.push_back(std::move(*pair));
    paired_[a] = paired_[b] = true;
  }

  void warn_of_others() {
    std::vector<std::string> names;
    Finding finding{"cyclic", 0, {}, ""};
    for (std::size_t f = 0; f < mesh_.patch.size(); ++f) {
      const std::uint32_t p = mesh_.patch[f];
      if (p == none || paired_[p] || !is_cyclic(mesh_.patches[p])) continue;
      finding.add(f);
      const std::string& name = mesh_.patches[p].name;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    finding.message = fmt::format(
        "faces in cyclic patches and wedges without a known partner ({}): they are walls, unless [[periodic]] of the "
        "scene makes two of them a pair",
        fmt::join(names, ", "));
    add_finding(parsed_.warnings, finding);
  }

  const PolyMesh& mesh_;
  const CornersOfFace& corners_;
  ParsedMesh& parsed_;
  std::vector<bool> paired_;
};

}  // namespace

void add_cyclic_pairs(const PolyMesh& mesh, const CornersOfFace& corners, ParsedMesh& parsed) {
  CyclicPairs(mesh, corners, parsed).add();
}

}  // namespace dartcast
