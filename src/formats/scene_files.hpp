// Files that a scene names beside its mesh: frames of a deformation, fields, and where particles start, and how.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// Cells of an input file that a scene's mesh has.
class CellsOfScene {
 public:
  /// All of them.
  CellsOfScene() = default;
  /// Those of this mesh, which leaves bad cells out.
  explicit CellsOfScene(const MeshData& mesh);

  [[nodiscard]] bool are_all() const { return sources_.empty(); }
  /// A file's mesh, with its arrays: checked and repaired, without the other cells and their points. Throws InvalidMesh with
  /// the file's name if it is refused.
  [[nodiscard]] MeshData mesh_of(MeshFile file) const;

 private:
  std::vector<std::uint32_t> sources_;  // ascending; empty: all
};

/// Makes a reader of frame k from file k, its points multiplied by `scale`. Each frame has the points of `mesh`, which is that
/// of the scene, in the same order. Null: it is not known here, and all have as many as the first. Checks that all files
/// exist, and reads the first one. Throws InvalidMesh, with the file's name, if one is missing, or the first is refused or has
/// another number of points. The reader throws Error with frame and file if that holds for a later one. Several threads may
/// call it at once. Adds a warning if the points stand still, and the first file has an array of displacements. Then it
/// reads two frames more. Precondition: at least one file.
FrameReader frame_reader(std::vector<std::filesystem::path> files, const MeshData* mesh, const CellsOfScene& cells,
                         double scale, const ReadOptions& options, std::vector<Finding>& warnings);

/// Makes samples of the field's files, and reads the first one. The others are read when they are needed; that they
/// exist is checked here. `mesh`: of the scene, read; null: as in the first file. `sample`: names of other arrays in the
/// same files, of which it adds the samples. Throws Error and its kinds, naming the file.
void read_field_files(FieldScene& field, const MeshData* mesh, const CellsOfScene& cells, const ReadOptions& options,
                      const std::vector<std::string>& sample, std::vector<ArraySamples>& sampled);

/// A reader of frames that are the mesh's points plus an array of the deformation's files, which it takes; their times go
/// to its step. `scale`: of displacements. Throws likewise.
FrameReader displaced_frames(DeformationScene& scene, const MeshData& mesh, const CellsOfScene& cells, double scale,
                             const ReadOptions& options);

/// Reads .csv, with the columns x, y, z and, if the file gives them, vx, vy, vz and radius. Or reads .vtp, with the
/// points' arrays velocity (of 3 components) and radius. Other arrays of a run's frames are skipped: id, cell, kind,
/// contacts, held. Only the option `max_memory` has an effect. Throws Error, with the file, if another column or array
/// is in it, or a value is out of range.
ParticleSeeds read_seeds(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dartcast
