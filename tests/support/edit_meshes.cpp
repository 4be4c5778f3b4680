#include "support/edit_meshes.hpp"

#include <ostream>

#include "support/mixed_mesh.hpp"

namespace dartcast::test {

void PrintTo(const EditMesh& m, std::ostream* out) { *out << m.name; }

MeshData edit_box(CellType type, bool mixed, std::uint32_t size) {
  BoxOptions o;
  o.cells = {size, size, size};
  o.size = {1.0, 1.0, 1.0};
  o.type = type;
  o.mixed = mixed;
  o.blocked_share = 0.1;
  return generate_box(o);
}

std::vector<EditMesh> edit_meshes() {
  return {{"tetrahedra", [] { return edit_box(CellType::tetrahedron, false, 3); }},
          {"hexahedra", [] { return edit_box(CellType::hexahedron); }},
          {"prisms", [] { return edit_box(CellType::prism, false, 3); }},
          {"pyramids", [] { return edit_box(CellType::pyramid, false, 3); }},
          {"mixed", [] { return edit_box(CellType::hexahedron, true); }},
          {"octahedra",
           [] {
             OctahedraOptions o;
             o.cells = {3, 2, 2};
             o.size = {1.0, 1.0, 1.0};
             o.blocked_share = 0.1;
             return generate_octahedra(o);
           }},
          {"handmade", [] { return mixed_mesh(); }}};
}

MeshData edit_rectangle(CellType type, bool mixed) {
  RectangleOptions o;
  o.cells = {8, 8};
  o.size = {1.0, 1.0};
  o.type = type;
  o.mixed = mixed;
  o.blocked_share = 0.1;
  return generate_rectangle(o);
}

std::vector<EditMesh> planar_edit_meshes() {
  return {{"triangles", [] { return edit_rectangle(CellType::triangle); }},
          {"quadrilaterals", [] { return edit_rectangle(CellType::quadrilateral); }},
          {"polygons", [] { return edit_rectangle(CellType::quadrilateral, true); }}};
}

std::vector<EditMesh> all_edit_meshes() {
  std::vector<EditMesh> all = edit_meshes();
  for (const EditMesh& m : planar_edit_meshes()) all.push_back(m);
  return all;
}

}  // namespace dartcast::test
