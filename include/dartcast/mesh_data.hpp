// A mesh as plain arrays. Files are read into it, generators fill it, and the map is built from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// The form of a cell, by its number of corners and faces.
enum class CellType : std::uint8_t {
  tetrahedron,
  hexahedron,
  prism,
  pyramid,
  polyhedron,
  triangle,
  quadrilateral,
  polygon
};
inline constexpr std::array<std::string_view, 8> cell_type_names = {
    "tetrahedron", "hexahedron", "prism", "pyramid", "polyhedron", "triangle", "quadrilateral", "polygon"};

/// 2 for cells of the plane, 3 for those of space.
constexpr unsigned dimension(CellType type) { return type < CellType::triangle ? 3 : 2; }

/// Values given at points or cells in the file, kept for fields and masks. Row-major: `components` doubles per item.
struct DataArray {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;
};

/// Two patches that lead to each other: a particle that leaves through `a` enters through `b`, and the other way round. A
/// motion takes the points of a to those of b: a rotation about a line, then a translation. Each wall face of a has a
/// partner among those of b, with the same corners.
struct PeriodicPair {
  std::string a;  ///< names of two patches
  std::string b;
  Vec3 translate{};
  Vec3 axis{};         ///< of the rotation, of any length; zero: there is none
  Vec3 centre{};       ///< a point of the rotation's line
  double angle = 0.0;  ///< degrees, counterclockwise as seen against the axis.
  /// The largest distance of a corner from its partner, as a share of the diagonal of the box around a. It is above 0,
  /// and at most 0.1. It only chooses the partners.
  double tolerance = 1e-6;

  bool operator==(const PeriodicPair&) const = default;
};

/// Points and cells. Units are SI by convention (metres); nothing in the library depends on it.
///
/// Corners of a positive cell:
///
///  - tetrahedron 0 1 2 3: det[p1 - p0, p2 - p0, p3 - p0] > 0;
///  - hexahedron: 0 1 2 3 the base, counterclockwise as seen from the inside, 4 5 6 7 above them (as in VTK and Gmsh);
///  - prism: 0 1 2 the base, counterclockwise as seen from the inside, 3 4 5 above them (as in Gmsh; VTK has the mirror
///    image);
///  - pyramid: 0 1 2 3 the base, counterclockwise as seen from the inside, 4 the apex (as in VTK and Gmsh);
///  - polyhedron: connectivity holds the number of faces, then for each face its number of corners and the corners,
///    counterclockwise as seen from the outside;
///  - triangle, quadrilateral, polygon: counterclockwise as seen from above, if z = 0 for all points.
///
/// All cells have the same dimension. In the plane the faces of a cell, and those of patches, are edges of two corners.
struct MeshData {
  std::vector<Vec3> points;

  std::vector<CellType> types;              ///< one per cell
  std::vector<std::size_t> offsets = {0};   ///< cells + 1; cell c owns connectivity[offsets[c] .. offsets[c + 1])
  std::vector<std::uint32_t> connectivity;  ///< point indices in the order above
  std::vector<std::uint32_t> source;        ///< the cell's index in the input file; empty: the cell's own index

  std::vector<std::int32_t> regions;  ///< tag per cell; empty: all 0
  std::map<std::int32_t, std::string> region_names;

  std::vector<std::uint32_t> patch_faces;           ///< faces in named groups: corners, one face after another
  std::vector<std::size_t> patch_offsets = {0};     ///< patch faces + 1, into patch_faces
  std::vector<std::int32_t> patch_tags;             ///< tag per patch face
  std::vector<std::uint32_t> patch_source;          ///< the face's index in the input file; empty: its own index
  std::map<std::int32_t, std::string> patch_names;  ///< an empty name: no patch
  std::vector<std::int32_t>
      patch_order;  ///< tags, in the order of the patches' numbers; those left out follow, by face
  /// Tags of patches whose faces are walls although two cells have them, as OpenFOAM's baffles. If both cells' sides
  /// are patch faces, each has the corners as its cell has them.
  std::vector<std::int32_t> baffle_tags;

  std::vector<PeriodicPair> periodic;  ///< pairs of patches; a patch is in one pair at most

  std::vector<std::uint8_t> free;  ///< 1 free, 0 blocked, per cell; empty: all free

  std::vector<DataArray> point_data;
  std::vector<DataArray> cell_data;

  [[nodiscard]] std::size_t cell_count() const { return types.size(); }
  /// The dimension of the first cell; 3 if there is none.
  [[nodiscard]] unsigned dimension() const { return types.empty() ? 3 : dartcast::dimension(types.front()); }
  [[nodiscard]] std::span<const std::uint32_t> cell(std::size_t c) const {
    return {connectivity.data() + offsets[c], offsets[c + 1] - offsets[c]};
  }
  void add_cell(CellType type, std::span<const std::uint32_t> corners) {
    types.push_back(type);
    connectivity.insert(connectivity.end(), corners.begin(), corners.end());
    offsets.push_back(connectivity.size());
  }
  void add_patch_face(std::span<const std::uint32_t> corners, std::int32_t tag) {
    patch_faces.insert(patch_faces.end(), corners.begin(), corners.end());
    patch_offsets.push_back(patch_faces.size());
    patch_tags.push_back(tag);
  }
  [[nodiscard]] std::span<const std::uint32_t> patch_face(std::size_t f) const {
    return {patch_faces.data() + patch_offsets[f], patch_offsets[f + 1] - patch_offsets[f]};
  }
};

}  // namespace dartcast
