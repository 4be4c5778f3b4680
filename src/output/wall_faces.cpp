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

class WallFaces {
 public:
  WallFaces(const CellComplex& complex, const WallHits& hits)
      : complex_(complex), hits_(hits), number_(complex.map().vertex_count(), none) {
    for (const Cell c : map().cells()) {
      const CellView view = map().view(c);
      for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) {
        if (view.is_wall(f)) add(view, {c, f});
      }
    }
  }

  VtpFile file() {
    VtpFile file(std::move(points_));
    if (map().dimension() == 2)
      file.add_lines(offsets_, corners_);
    else
      file.add_polygons(offsets_, corners_);
    file.add_for_cells("hits", std::move(hits_of_face_));
    file.add_for_cells("hits_per_area", std::move(hits_per_area_));
    file.add_for_cells("patch", std::move(patch_));
    file.add_for_cells("cell", std::move(cell_));
    std::vector<std::string> names;
    for (std::size_t i = 1; i < map().patch_names().size(); ++i)
      names.push_back(fmt::format("{} {}", i, map().patch_names()[i]));
    file.add_texts("patch_names", names);
    return file;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  [[nodiscard]] const CombinatorialMap& map() const { return complex_.map(); }

  void add(const CellView& view, CellFace face) {
    for (const std::uint16_t k : view.shape().corners(face.face)) corners_.push_back(number(view.vertex(k)));
    offsets_.push_back(corners_.size());
    const std::uint64_t hits = hits_.of(face);
    const double area = area_of(view, face.face);
    hits_of_face_.push_back(static_cast<std::int64_t>(hits));
    hits_per_area_.push_back(area > 0.0 ? static_cast<double>(hits) / area : 0.0);
    patch_.push_back(map().patch(face).value);
    cell_.push_back(map().source(face.cell));
  }

  // The walls are the triangles of the face's fan. In the plane: the length of the edge.
  [[nodiscard]] double area_of(const CellView& view, std::uint16_t face) const {
    double area = 0.0;
    for (std::uint16_t t = 0; t < view.shape().triangle_count(face); ++t) {
      std::array<Vec3, 3> x;
      const auto triangle = view.shape().triangle(face, t);
      for (std::size_t k = 0; k < 3; ++k) x[k] = complex_.positions()[view.vertex(triangle[k]).value];
      area += map().dimension() == 2 ? norm(x[1] - x[0]) : 0.5 * norm(cross(x[1] - x[0], x[2] - x[0]));
    }
    return area;
  }

  std::uint32_t number(Vertex v) {
    std::uint32_t& n = number_[v.value];
    if (n == none) {
      n = static_cast<std::uint32_t>(points_.size());
      points_.push_back(complex_.positions()[v.value]);
    }
    return n;
  }

  const CellComplex& complex_;
  const WallHits& hits_;
  std::vector<std::uint32_t> number_;  // of a vertex among the points
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::size_t> offsets_ = {0};
  std::vector<std::int64_t> hits_of_face_;
  std::vector<double> hits_per_area_;
  std::vector<std::int32_t> patch_;
  std::vector<std::uint32_t> cell_;
};

}  // namespace

VtpFile wall_faces_file(const Environment& environment, const WallHits& hits) {
  return WallFaces(environment.complex(), hits).file();
}

void write_wall_hits(const Environment& environment, const WallHits& hits, const std::filesystem::path& file) {
  if (file.extension() != ".vtp")
    throw InvalidArgument(fmt::format("{}: wall hits are written as .vtp; give the file this ending", file.string()));
  write_xml(file, wall_faces_file(environment, hits).data(), Compression::none, write_pieces);
}

}  // namespace dartcast
