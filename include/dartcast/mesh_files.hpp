// Meshes and surfaces from and to files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

/// Endings of the files that read_mesh() takes, as ".vtu".
std::vector<std::string> mesh_endings();
/// Endings of the files that write_mesh() takes.
std::vector<std::string> writable_mesh_endings();
/// Endings of the files that check_surface() takes, as ".stl".
std::vector<std::string> surface_endings();

// Any mesh file: read, checked and repaired.

/// How a mesh file is read.
struct ReadOptions {
  /// The cell array of a .vtu or .vtk file that gives the boundary cells (triangles, quadrilaterals, polygons; in the
  /// plane lines) their patches. It holds whole numbers, where 0 is no patch, or texts, where an empty one is none.
  /// Empty: the array `patch`, else the one that gives the regions. Other formats have groups of their own, and refuse
  /// a name here.
  std::string patch_array;
  /// Bytes that this process may take while it reads one file and builds the map from it; 0: half of the machine's
  /// memory. An upper bound of the need follows from the sizes that the file announces (formats/read_memory.hpp). It is
  /// checked before the memory is taken; a file that may need more is refused with kind "file".
  std::uint64_t max_memory = 0;
  /// Cells of second order are taken by their corners. A warning has their number. Their middle points are
  /// dropped. Without it they are refused, because their sides are curved.
  bool linearise = false;
  /// A .msh file that keeps the mesh made around a scene's surfaces (SurfaceScene). If it was made of the same files
  /// with the same values, it is read, and no mesher is needed. Else the mesh is made and written there. Empty: none.
  std::filesystem::path kept_mesh = {};
  /// Called as a stage starts that may take long, with what is done, such as "tetgen fills the surface". Empty: none.
  /// The call comes in the thread of the caller.
  std::function<void(std::string_view stage)> on_stage = {};
  /// Fields at the cells of an OpenFOAM time that become arrays at the points, too, by the rule of docs/scene.md.
  std::vector<std::string> point_fields = {};
};

/// A mesh as read, and what was found in it.
struct MeshFile {
  MeshData mesh;  ///< to be used only if report.valid()
  MeshReport report;
};

/// Reads a mesh, checks and repairs it. The file's ending and content decide how. Endings: .vtu, .pvtu and .vtk
/// (legacy); .msh, .msh2, .msh4 (Gmsh 1, 2 and 4); .mesh and .meshb (Medit); .node or .ele, with the other beside it
/// (TetGen). The path may be the folder of an OpenFOAM case (formats/openfoam.hpp) or of SimVascular
/// (formats/vtp_surface.hpp). The cell array `free` of a .vtu or .vtk file becomes MeshData::free if write_mesh() has
/// written it. Nothing in the file makes this throw. A file that cannot be read has a defect of kind "file" in the
/// report, with line or byte. Cost: a few times the file's size in memory.
MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same, but throws InvalidMesh, with the file's name and the first defect, if the mesh is refused.
MeshFile read_valid_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

// Any file of a surface in space: read, checked and repaired.

/// Whether the ending is one of those that check_surface() reads.
bool is_surface_file(const std::filesystem::path& path);

/// Reads .stl (ASCII, binary), .obj, .ply (ASCII, binary), .off or .vtp, by ending and content, and then calls
/// check_and_repair_surface(). Nothing in the file makes this throw. A file that cannot be read has a defect of kind
/// "file" in the report, with line or byte. Points keep their order, and points that no face uses are kept. So
/// Surface::move() can take the positions of another file of the same faces. formats/stl.hpp says which points a .stl
/// has. The option `max_memory` counts, the other does not. Cost: n log n; a few times the file's size in memory.
MeshFile check_surface(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same, but throws InvalidMesh, with the file's name, the first defect and its first faces, if the surface is
/// refused: `Surface(read_surface(path).mesh)`.
MeshFile read_surface(const std::filesystem::path& path, const ReadOptions& options = {});

// Meshes around surfaces.

struct SurfaceScene;  // dartcast/scene.hpp

/// Makes tetrahedra inside and around closed surfaces (section 3.2 of the paper) with tetgen or gmsh, which runs as a
/// program of its own in a temporary folder. Folder and program are gone when this process ends, also by a signal.
///
/// The surfaces are checked first, by exact signs: closed, oriented (or made so), no triangle without area, no two that
/// cross or touch. The tetrahedra are checked then. Each triangle of the surfaces is a face of two of them, with its
/// points bit by bit. These faces alone decide which cells a region holds. Its volume is the enclosed one to 1e-9.
///
/// Regions have the surfaces' names; the cells in them are free, and those outside blocked. Patches are the groups of
/// the files (.stl solids, .obj groups), else the parts between sharp edges (wall, or wall_1, wall_2 ...). Caps are
/// inlet, outlet or outlet_1 ... by decreasing area. The box is `box`. With several surfaces the region's name stands
/// before each.
///
/// Nothing in the files makes this throw: what is wrong is a defect in the report, with faces and a place. A program
/// that is missing, fails, or takes too long is a defect of kind "mesher". Throws InvalidArgument if a member is out
/// of range. Only the option `max_memory` has an effect; it also bounds the program. Cost: seconds for 10^4
/// triangles.
MeshFile mesh_surfaces(const SurfaceScene& scene, const ReadOptions& options = {});

// Writing meshes.

/// Writes a mesh in the format of the path's ending: .vtu, .vtk (legacy), .msh or .msh2 (Gmsh 2.2 ASCII), .msh4 (Gmsh
/// 4.1 ASCII), .mesh (Medit). Surfaces and meshes of the plane can also be .stl, .obj, .ply, .off and .vtp. The
/// function read_mesh() gives back the same cells, regions and patches, and the points bit by bit. Data without a place
/// in the format are left out: arrays and `free` outside VTK's formats; names of regions and patches in .mesh. The
/// bytes go to a file beside the path, with ".part" in its name. When it is whole it takes the path's place; on failure
/// the file at the path is unchanged. Precondition: check_and_repair() found the mesh valid. Throws InvalidArgument if
/// the ending is none of writable_mesh_endings(). It also throws if .msh or .mesh should hold polyhedra, polygons,
/// faces of more than four corners, or baffles. Throws Error if the file cannot be written.
void write_mesh(const MeshData& mesh, const std::filesystem::path& path);

// Meshes in pieces, for ranks.

/// Writes a mesh in pieces: a .pvtu file that names a .vtu file beside it for each part. ParaView and read_mesh() open
/// them as the whole mesh, read_mesh_part() as parts. Each piece has its ghosts, and the numbers that its points and
/// cells have in the whole. Precondition: check_and_repair() found the mesh valid. Throws as partition();
/// InvalidArgument if the path does not end in .pvtu; Error if a file cannot be written.
void write_mesh_parts(const MeshData& mesh, std::uint32_t parts, const std::filesystem::path& path);

/// Reads the pieces of part `part` of `parts` and puts them together; the pieces are shared out in their order. Throws
/// InvalidMesh, with file and reason, if there are fewer pieces than parts, and if one is damaged, of another mesh,
/// or none of write_mesh_parts(). Only the option `max_memory` has an effect.
MeshPart read_mesh_part(const std::filesystem::path& path, std::uint32_t parts, std::uint32_t part,
                        const ReadOptions& options = {});

/// Writes bytes to a file. Throws Error if that fails.
void write_bytes(const std::filesystem::path& path, std::string_view bytes);

// The full check of a mesh file: `dartcast check`.

/// Reads and checks a file, one of a surface as mesh_surfaces() does: it must be closed, and no triangles may cross or
/// touch. A mesh without a defect is also divided into simplices. A cell that has no division into positive ones, not
/// even around a Steiner point, is a defect of kind "not_star_shaped". With `without_bad_cells` these cells, and flat or
/// inverted ones, are left out, and are a warning (see complex/skip_bad_cells.hpp). Nothing in the file makes this throw.
MeshFile check_mesh(const std::filesystem::path& path, Threads threads = {}, const ReadOptions& options = {},
                    bool without_bad_cells = false);

}  // namespace dartcast
