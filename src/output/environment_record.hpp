// The environment as files for ParaView, with all that its input file gave at points and cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/mesh_data.hpp"
#include "formats/xml_write.hpp"

namespace dartcast {

/// Keeps the cells, regions and arrays of a mesh, and gives them at the environment's positions. Cells also get `free`,
/// and `source`: the cell's index in the input file, which particles have as `cell`. An array of that name in the input
/// is replaced. After edits a cell has the values of the input cell that it came from. A point that an edit made has
/// the weighted mean of those that it was made between.
class EnvironmentRecord {
 public:
  /// `mesh`: the environment's, as check_and_repair() left it.
  explicit EnvironmentRecord(MeshData mesh);

  /// To be called after each edit. Cost: the vertices made, and the arrays' growth.
  void update_after_edit(const Environment& environment);

  /// As it is in the mesh.
  [[nodiscard]] XmlDataSet at_rest() const;
  /// As it is now: with a copy of the positions, and arrays that all data sets share until the next edit. They must be
  /// written with the same compression, by one thread at a time. Cost: that of the copy; after an edit linear.
  [[nodiscard]] XmlDataSet data_set(const Environment& environment);
  /// Later data sets have these, too: values of all cells, in the order of CombinatorialMap::cells().
  void set_cell_arrays(std::vector<DataArray> arrays) { cell_arrays_ = std::move(arrays); }

 private:
  [[nodiscard]] MeshData edited_mesh(const CellComplex& complex);
  [[nodiscard]] std::size_t row(std::uint32_t source) const { return row_of_.empty() ? source : row_of_[source]; }
  [[nodiscard]] std::vector<std::size_t> rows(const MeshData& edited) const;
  void keep(const std::shared_ptr<const MeshData>& mesh);

  std::shared_ptr<const MeshData> mesh_;               // without patches
  std::vector<std::uint32_t> row_of_;                  // by index in the input file; empty: the index itself
  std::optional<std::vector<DataArray>> at_vertices_;  // mesh_'s arrays at points, since the first edit
  std::optional<XmlDataSet> kept_;                     // without the points
  std::vector<Vertex> vertices_;                       // of its points
  std::vector<DataArray> cell_arrays_;
  std::uint64_t edits_ = 0;  // that it has followed
};

}  // namespace dartcast
