// Checks tetrahedra against the surfaces that they were made for. From the box inwards each triangle of a surface leads
// into the region that it encloses, or out of it again. So the tetrahedra need no marks of the program.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "meshing/tetrahedra.hpp"

namespace dartcast {
namespace {

/// The largest relative difference of a region's volume from the volume that its surfaces enclose. Both are rounded sums;
/// a leak changes them by far more.
constexpr double volume_tolerance = 1e-9;

constexpr std::uint32_t nothing = 0xffffffffU;
constexpr std::array<std::array<unsigned, 3>, 4> faces_of_tetrahedron = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

TriangleCorners sorted(TriangleCorners t) {
  std::sort(t.begin(), t.end());
  return t;
}

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(cross(b - a, c - a), d - a) / 6.0;
}

class Regions {
 public:
  Regions(const ClosedSurfaces& surfaces, const SurfaceScene& scene, Tetrahedra tetrahedra)
      : surfaces_(surfaces), scene_(scene), made_(std::move(tetrahedra)) {}

  MeshData build() {
    turn_cells();
    match_faces();
    flood();
    check_volumes();
    return mesh();
  }

 private:
  struct Face {
    std::uint32_t cells[2] = {nothing, nothing};
    std::uint32_t triangle = nothing;
  };

  void turn_cells() {
    for (auto& c : made_.cells) {
      for (const std::uint32_t p : c) {
        if (p >= made_.points.size()) throw Error("the mesher has made a tetrahedron of points that do not exist");
      }
      if (orient3d(made_.points[c[0]], made_.points[c[1]], made_.points[c[2]], made_.points[c[3]]) == Sign::negative)
        std::swap(c[2], c[3]);
    }
  }

  void match_faces() {
    for (std::uint32_t c = 0; c < made_.cells.size(); ++c) {
      for (const auto& f : faces_of_tetrahedron) {
        Face& face = faces_[sorted({made_.cells[c][f[0]], made_.cells[c][f[1]], made_.cells[c][f[2]]})];
        if (face.cells[1] != nothing) throw Error("the mesher has made a face of three tetrahedra");
        face.cells[face.cells[0] == nothing ? 0 : 1] = c;
      }
    }
    for (std::uint32_t t = 0; t < surfaces_.triangles.size(); ++t) {
      const auto found = faces_.find(sorted(surfaces_.triangles[t]));
      if (found == faces_.end() || found->second.cells[1] == nothing)
        throw Error(fmt::format("the mesher has not kept face {} of {}", surfaces_.source[t],
                                scene_.surfaces[surfaces_.surface[t]].file.string()));
      found->second.triangle = t;
    }
  }

  // The surfaces around each tetrahedron, the innermost one last, from the box inwards.
  void flood() {
    std::vector<std::array<std::uint32_t, 4>> across(made_.cells.size(), {nothing, nothing, nothing, nothing});
    std::vector<std::array<std::uint32_t, 4>> triangle = across;
    std::vector<std::uint32_t> open;
    within_.resize(made_.cells.size());
    std::vector<std::uint8_t> count(made_.cells.size(), 0);
    for (const auto& [corners, face] : faces_) {
      for (int side = 0; side < 2 && face.cells[1] != nothing; ++side) {
        const std::uint32_t c = face.cells[side];
        across[c][count[c]] = face.cells[1 - side];
        triangle[c][count[c]++] = face.triangle;
      }
      if (face.cells[1] == nothing && !within_[face.cells[0]]) {
        within_[face.cells[0]].emplace();
        open.push_back(face.cells[0]);
      }
    }
    while (!open.empty()) {
      const std::uint32_t c = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < count[c]; ++k) pass(c, across[c][k], triangle[c][k], open);
    }
    if (std::any_of(within_.begin(), within_.end(), [](const auto& w) { return !w; }))
      throw Error("some tetrahedra are not connected with the box");
  }

  // From one tetrahedron to the next one, through a triangle of a surface or not.
  void pass(std::uint32_t from, std::uint32_t to, std::uint32_t triangle, std::vector<std::uint32_t>& open) {
    std::vector<std::uint32_t> within = *within_[from];
    if (triangle != nothing) {
      const std::uint32_t s = surfaces_.surface[triangle];
      const auto found = std::find(within.begin(), within.end(), s);
      if (found == within.end()) {
        within.push_back(s);
      } else {
        within.erase(found);
      }
    }
    if (!within_[to]) {
      within_[to] = std::move(within);
      open.push_back(to);
    } else if (*within_[to] != within) {
      throw Error("the surface leaks: a tetrahedron is inside on one way and outside on another");
    }
  }

  void check_volumes() const {
    const std::size_t n = scene_.surfaces.size();
    std::vector<double> held(n, 0.0);
    for (std::size_t c = 0; c < made_.cells.size(); ++c) {
      const auto& k = made_.cells[c];
      for (const std::uint32_t s : *within_[c])
        held[s] += volume(made_.points[k[0]], made_.points[k[1]], made_.points[k[2]], made_.points[k[3]]);
    }
    const std::vector<double> enclosed = enclosed_volumes();
    for (std::size_t s = 0; s < n; ++s) {
      if (!(held[s] > 0.0)) throw Error(fmt::format("the region {} has no tetrahedra", scene_.surfaces[s].region));
      if (!(std::abs(held[s] - enclosed[s]) <= volume_tolerance * enclosed[s]))
        throw Error(fmt::format("{} encloses {:.15g}, but the tetrahedra in it have {:.15g}",
                                scene_.surfaces[s].file.string(), enclosed[s], held[s]));
    }
  }

  // By the divergence theorem, each triangle seen from outside the region that its surface encloses. Its inner side is
  // the tetrahedron that lies in the surface.
  [[nodiscard]] std::vector<double> enclosed_volumes() const {
    std::vector<double> enclosed(scene_.surfaces.size(), 0.0);
    const Vec3& origin = surfaces_.points.front();
    for (std::uint32_t t = 0; t < surfaces_.triangles.size(); ++t) {
      const std::uint32_t s = surfaces_.surface[t];
      const Face& face = faces_.at(sorted(surfaces_.triangles[t]));
      const auto inside = [&](std::uint32_t c) {
        return std::find(within_[c]->begin(), within_[c]->end(), s) != within_[c]->end();
      };
      const std::uint32_t inner = inside(face.cells[0]) ? face.cells[0] : face.cells[1];
      const auto& corners = surfaces_.triangles[t];
      const auto& cell = made_.cells[inner];
      const auto apex = std::find_if(cell.begin(), cell.end(), [&](std::uint32_t p) {
        return std::find(corners.begin(), corners.end(), p) == corners.end();
      });
      const Vec3 &a = surfaces_.points[corners[0]], &b = surfaces_.points[corners[1]],
                 &c = surfaces_.points[corners[2]];
      const double towards = volume(a, b, c, made_.points[*apex]) > 0.0 ? -1.0 : 1.0;  // the apex lies inside
      enclosed[s] += towards * volume(origin, a, b, c);
    }
    return enclosed;
  }

  MeshData mesh() {
    MeshData out;
    out.points = std::move(made_.points);
    std::map<std::string, std::int32_t> tags;
    for (const NamedSurface& s : scene_.surfaces)
      tags.try_emplace(s.region, static_cast<std::int32_t>(tags.size() + 1));
    tags.try_emplace(scene_.outside, static_cast<std::int32_t>(tags.size() + 1));
    for (const auto& [name, tag] : tags) out.region_names[tag] = name;
    for (std::size_t c = 0; c < made_.cells.size(); ++c) {
      out.add_cell(CellType::tetrahedron, made_.cells[c]);
      const bool outer = within_[c]->empty();
      out.regions.push_back(tags.at(outer ? scene_.outside : scene_.surfaces[within_[c]->back()].region));
      out.free.push_back(outer ? 0 : 1);
    }
    out.patch_names = surfaces_.patch_names;
    for (std::size_t t = 0; t < surfaces_.triangles.size(); ++t)
      out.add_patch_face(surfaces_.triangles[t], surfaces_.patch[t]);
    const std::int32_t box = out.patch_names.rbegin()->first + 1;
    out.patch_names[box] = "box";
    for (const auto& [corners, face] : faces_) {
      if (face.cells[1] == nothing) out.add_patch_face(corners, box);
    }
    return out;
  }

  const ClosedSurfaces& surfaces_;
  const SurfaceScene& scene_;
  Tetrahedra made_;
  std::map<TriangleCorners, Face> faces_;
  std::vector<std::optional<std::vector<std::uint32_t>>> within_;
};

}  // namespace

MeshData mesh_with_regions(const ClosedSurfaces& surfaces, const SurfaceScene& scene, Tetrahedra tetrahedra) {
  return Regions(surfaces, scene, std::move(tetrahedra)).build();
}

}  // namespace dartcast
