// Writes Gmsh's .msh, versions 2.2 and 4.1, as text.
#include <fmt/format.h>

#include <array>
#include <iterator>
#include <set>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/gmsh.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

/// Gmsh's number of an element type.
int element_type(CellType type, std::size_t corners) {
  switch (type) {
    case CellType::tetrahedron: return 4;
    case CellType::hexahedron: return 5;
    case CellType::prism: return 6;
    case CellType::pyramid: return 7;
    case CellType::triangle: return 2;
    case CellType::quadrilateral: return 3;
    case CellType::polygon: return static_cast<int>(corners) - 1;
    case CellType::polyhedron: break;
  }
  throw InternalError("Gmsh's format has no polyhedra");
}

/// The same, for an edge, a triangle or a quadrilateral.
int face_type(std::size_t corners) { return static_cast<int>(corners) - 1; }

/// Elements in the order of the file: patch faces, then cells.
struct Element {
  int dimension;
  int type;
  std::int32_t tag;
  std::span<const std::uint32_t> corners;
};

std::vector<Element> elements_of(const MeshData& mesh) {
  const int dimension = static_cast<int>(mesh.dimension());
  std::vector<Element> elements;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t begin = mesh.patch_offsets[f];
    const std::size_t size = mesh.patch_offsets[f + 1] - begin;
    elements.push_back({dimension - 1, face_type(size), mesh.patch_tags[f], {mesh.patch_faces.data() + begin, size}});
  }
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    elements.push_back({dimension, element_type(mesh.types[c], mesh.cell(c).size()), region_of(mesh, c), mesh.cell(c)});
  }
  return elements;
}

void append_corners(std::string& out, const Element& element) {
  for (const std::uint32_t v : element.corners) fmt::format_to(std::back_inserter(out), " {}", std::uint64_t{v} + 1);
  out += '\n';
}

void append_names(std::string& out, const MeshData& mesh) {
  const std::size_t n = mesh.patch_names.size() + mesh.region_names.size();
  if (n == 0) return;
  fmt::format_to(std::back_inserter(out), "$PhysicalNames\n{}\n", n);
  const auto append = [&](unsigned dimension, const std::map<std::int32_t, std::string>& names) {
    for (const auto& [tag, name] : names)
      fmt::format_to(std::back_inserter(out), "{} {} \"{}\"\n", dimension, tag, name);
  };
  append(mesh.dimension() - 1, mesh.patch_names);
  append(mesh.dimension(), mesh.region_names);
  out += "$EndPhysicalNames\n";
}

void append_point(std::string& out, const Vec3& p) {
  fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x, p.y, p.z);
}

}  // namespace

std::string format_gmsh_2(const MeshData& mesh) {
  const std::vector<Element> elements = elements_of(mesh);
  std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  append_names(out, mesh);
  fmt::format_to(std::back_inserter(out), "$Nodes\n{}\n", mesh.points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    fmt::format_to(std::back_inserter(out), "{} ", p + 1);
    append_point(out, mesh.points[p]);
  }
  fmt::format_to(std::back_inserter(out), "$EndNodes\n$Elements\n{}\n", elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    fmt::format_to(std::back_inserter(out), "{} {} 2 {} {}", e + 1, elements[e].type, elements[e].tag, elements[e].tag);
    append_corners(out, elements[e]);
  }
  return out + "$EndElements\n";
}

std::string format_gmsh_4(const MeshData& mesh) {
  const std::vector<Element> elements = elements_of(mesh);
  // One entity for each tag, numbered by it; all nodes belong to the first.
  std::set<std::pair<int, std::int32_t>> entities;
  for (const Element& e : elements) entities.emplace(e.dimension, e.tag);
  std::array<std::size_t, 4> counts = {};
  for (const auto& entity : entities) ++counts[static_cast<std::size_t>(entity.first)];
  std::string out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  append_names(out, mesh);
  const auto append = std::back_inserter(out);
  fmt::format_to(append, "$Entities\n0 {} {} {}\n", counts[1], counts[2], counts[3]);
  for (const auto& [dimension, tag] : entities) {
    fmt::format_to(append, "{} 0 0 0 0 0 0 {} 0\n", tag, tag == 0 ? "0" : fmt::format("1 {}", tag));
  }
  const std::size_t n = mesh.points.size();
  const auto first = entities.empty() ? std::pair<int, std::int32_t>(3, 0) : *entities.begin();
  fmt::format_to(append, "$EndEntities\n$Nodes\n1 {} 1 {}\n{} {} 0 {}\n", n, n, first.first, first.second, n);
  for (std::size_t p = 0; p < n; ++p) fmt::format_to(append, "{}\n", p + 1);
  for (const Vec3& p : mesh.points) append_point(out, p);
  // Only equal neighbours in the list share a block, so that the elements keep their order.
  std::string blocks;
  std::size_t count = 0;
  for (std::size_t e = 0, end = 0; e < elements.size(); e = end, ++count) {
    const auto same = [&](const Element& x) {
      return x.dimension == elements[e].dimension && x.tag == elements[e].tag && x.type == elements[e].type;
    };
    for (end = e + 1; end < elements.size() && same(elements[end]);) ++end;
    fmt::format_to(std::back_inserter(blocks), "{} {} {} {}\n", elements[e].dimension, elements[e].tag,
                   elements[e].type, end - e);
    for (std::size_t k = e; k < end; ++k) {
      fmt::format_to(std::back_inserter(blocks), "{}", k + 1);
      append_corners(blocks, elements[k]);
    }
  }
  fmt::format_to(append, "$EndNodes\n$Elements\n{} {} 1 {}\n", count, elements.size(), elements.size());
  return out + blocks + "$EndElements\n";
}

}  // namespace dartcast
