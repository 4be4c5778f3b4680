// Meshes in calls: checked before C++ code reads them, and unchanged while it does.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast::python {

/// Marks a mesh as in use by a call that releases Python's lock. Any number of calls may read a mesh at once; one that
/// changes it must be alone. Throws InUse otherwise. Make and destroy it with the lock held.
class MeshUse {
 public:
  explicit MeshUse(const MeshData& mesh, bool changes = false);
  MeshUse(const MeshUse&) = delete;
  MeshUse& operator=(const MeshUse&) = delete;
  ~MeshUse();

 private:
  const MeshData* mesh_;
};

/// Throws InvalidArgument if the arrays of a mesh contradict each other: sizes, offsets, numbers of points. Cost:
/// linear.
void check_arrays(const MeshData& mesh);

/// The text of a mesh's first defect, with its first places.
std::string first_defect(const MeshReport& report);

/// Does nothing if a mesh was read from the file. Throws FileNotFoundError if there is no such file. Throws
/// InvalidArgument, which names the right call, if it is a surface.
void expect_mesh_file(const std::filesystem::path& path, const MeshFile& file);

/// A copy as check_and_repair() repairs it. Throws InvalidMesh, with the first defect, if that refuses it. May be
/// called without Python's lock.
MeshData checked_mesh(const MeshData& mesh);

/// Throws InvalidMesh as checked_mesh() does, and InvalidArgument if check_and_repair() would change it. May be
/// called without Python's lock.
void require_checked(const MeshData& mesh);

}  // namespace dartcast::python
