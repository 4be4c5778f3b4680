// Collects the walls of free cells, their areas and hits.
#include "output/wall_faces.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/statistics_files.hpp"
#include "formats/file_write.hpp"

namespace dartcast {

namespace {

// The walls are the triangles of the face's fan. In the plane: the length of the edge.
double area_of(const CellComplex& complex, CellFace face) {
  const CellView view = complex.map().view(face.cell);
  double area = 0.0;
  for (std::uint16_t t = 0; t < view.shape().triangle_count(face.face); ++t) {
    std::array<Vec3, 3> x;
    const auto triangle = view.shape().triangle(face.face, t);
    for (std::size_t k = 0; k < 3; ++k) x[k] = complex.positions()[view.vertex(triangle[k]).value];
    area += complex.map().dimension() == 2 ? norm(x[1] - x[0]) : 0.5 * norm(cross(x[1] - x[0], x[2] - x[0]));
  }
  return area;
}

// The values of the faces.
struct FaceValues {
  std::vector<std::int64_t> hits;
  std::vector<double> hits_per_area;
  std::vector<std::int32_t> patch;
  std::vector<std::uint32_t> cell;
  std::vector<double> mass;
  std::vector<double> energy;
  std::array<std::vector<std::int64_t>, 9> angles;

  FaceValues(const CellComplex& complex, const std::vector<CellFace>& faces, const WallHits& counted) {
    for (const CellFace face : faces) {
      const FaceHits sums = counted.at(face);
      const std::uint64_t n = sums.hits;
      mass.push_back(sums.mass);
      energy.push_back(sums.energy);
      for (std::size_t i = 0; i < angles.size(); ++i) angles[i].push_back(static_cast<std::int64_t>(sums.angles[i]));
      const double area = area_of(complex, face);
      hits.push_back(static_cast<std::int64_t>(n));
      hits_per_area.push_back(area > 0.0 ? static_cast<double>(n) / area : 0.0);
      patch.push_back(complex.map().patch(face).value);
      cell.push_back(complex.map().source(face.cell));
    }
  }
};

}  // namespace

WallFaceList wall_face_list(const CombinatorialMap& map) {
  constexpr std::uint32_t none = 0xffffffffU;
  WallFaceList walls;
  std::vector<std::uint32_t> number(map.vertex_count(), none);
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) {
      if (!view.is_wall(f)) continue;
      for (const std::uint16_t k : view.shape().corners(f)) {
        std::uint32_t& n = number[view.vertex(k).value];
        if (n == none) {
          n = static_cast<std::uint32_t>(walls.vertices.size());
          walls.vertices.push_back(view.vertex(k));
        }
        walls.corners.push_back(n);
      }
      walls.offsets.push_back(walls.corners.size());
      walls.faces.push_back({c, f});
    }
  }
  return walls;
}

std::vector<ExactSum> wall_areas(const Environment& environment, const std::function<bool(Cell)>& is_own) {
  std::vector<ExactSum> areas(environment.map().patch_names().size());
  for (const CellFace face : wall_face_list(environment.map()).faces) {
    if (is_own(face.cell)) areas[environment.map().patch(face).value].add(area_of(environment.complex(), face));
  }
  return areas;
}

VtpFile wall_faces_file(const Environment& environment, const WallHits& hits, bool with_impacts) {
  const CombinatorialMap& map = environment.map();
  const WallFaceList walls = wall_face_list(map);
  std::vector<Vec3> points;
  points.reserve(walls.vertices.size());
  for (const Vertex v : walls.vertices) points.push_back(environment.positions()[v.value]);
  VtpFile file(std::move(points));
  if (map.dimension() == 2)
    file.add_lines(walls.offsets, walls.corners);
  else
    file.add_polygons(walls.offsets, walls.corners);
  FaceValues values(environment.complex(), walls.faces, hits);
  file.add_for_cells("hits", std::move(values.hits));
  file.add_for_cells("hits_per_area", std::move(values.hits_per_area));
  if (with_impacts) {
    file.add_for_cells("impact_mass", std::move(values.mass));
    file.add_for_cells("impact_energy", std::move(values.energy));
    for (std::size_t i = 0; i < values.angles.size(); ++i)
      file.add_for_cells(fmt::format("impacts_from_{}_degrees", 10 * i), std::move(values.angles[i]));
  }
  file.add_for_cells("patch", std::move(values.patch));
  file.add_for_cells("cell", std::move(values.cell));
  std::vector<std::string> names;
  for (std::size_t i = 1; i < map.patch_names().size(); ++i)
    names.push_back(fmt::format("{} {}", i, map.patch_names()[i]));
  file.add_texts("patch_names", names);
  return file;
}

void write_wall_hits(const Environment& environment, const WallHits& hits, const std::filesystem::path& file) {
  if (file.extension() != ".vtp")
    throw InvalidArgument(fmt::format("{}: wall hits are written as .vtp; give the file this ending", file.string()));
  write_xml(file, wall_faces_file(environment, hits, false).data(), Compression::none, write_pieces);
}

}  // namespace dartcast
