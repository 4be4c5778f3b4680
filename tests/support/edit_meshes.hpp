// Meshes of every cell type for edits to work on.
#pragma once

#include <iosfwd>
#include <vector>

#include "dartcast/generators.hpp"

namespace dartcast::test {

struct EditMesh {
  const char* name;
  MeshData (*make)();
};
void PrintTo(const EditMesh& m, std::ostream* out);

MeshData edit_box(CellType type, bool mixed = false, std::uint32_t size = 4);

std::vector<EditMesh> edit_meshes();

MeshData edit_rectangle(CellType type, bool mixed = false);

/// Meshes of the plane.
std::vector<EditMesh> planar_edit_meshes();

std::vector<EditMesh> all_edit_meshes();

}  // namespace dartcast::test
