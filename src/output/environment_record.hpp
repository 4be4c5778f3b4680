// The environment as files for ParaView, with all that its input file gave at points and cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Keeps the cells, regions and arrays of a mesh, and writes them at the environment's positions. Cells also get
/// `free`, and `source`: the cell's index in the input file, which particles have as `cell`; an array of that name in
/// the input is replaced. After edits a cell has the values of the input cell that it came from, and a point that an
/// edit made the weighted mean of those that it was made between.
class EnvironmentRecord {
 public:
  /// `mesh`: the environment's, as check_and_repair() left it.
  explicit EnvironmentRecord(MeshData mesh);

  /// To be called after each edit. Cost: the vertices made, and the arrays' growth.
  void update_after_edit(const Environment& environment);

  /// As it is in the mesh.
  void write_at_rest(const std::filesystem::path& file) const;
  /// As it is now. Throws Error where the file cannot be written. Cost: linear.
  void write(const Environment& environment, const std::filesystem::path& file);

 private:
  void write_edited(const CellComplex& complex, const std::filesystem::path& file) const;
  [[nodiscard]] std::vector<std::size_t> rows(const MeshData& edited) const;

  MeshData mesh_;                      // without patches
  std::vector<std::uint32_t> row_of_;  // by index in the input file; empty: the index itself
};

}  // namespace dartcast
