// A scene: all that a simulation is made of, as plain data. It can be built in C++, or read from TOML
// (dartcast/scene_file.hpp; keys: docs/scene.md).
//
// Some members may name a file instead of holding its data: load_scene_files() replaces the name with the data.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/events.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/response.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast {

/// Limits of a scene's numbers: what TOML can hold, and what a double counts without a gap.
inline constexpr std::uint64_t max_seed = 0x7fffffffffffffffU;
inline constexpr std::uint64_t max_steps = std::uint64_t{1} << 53U;

/// A closed surface, and the name of the region inside it.
struct NamedSurface {
  std::string region = "inside";
  std::filesystem::path file;  ///< one of surface_endings()
};

/// The program that makes tetrahedra.
enum class Mesher : std::uint8_t {
  any,  ///< tetgen; gmsh if tetgen is not there or fails
  tetgen,
  gmsh
};

/// Tetrahedra inside and around closed surfaces, up to a box: mesh_surfaces() makes them with an external program.
struct SurfaceScene {
  /// They may lie in one another, and must not touch. A region is what its surface encloses, without the surfaces in
  /// it. Parts of a file that lie in one another enclose the space between them.
  std::vector<NamedSurface> surfaces;
  std::string outside = "outside";  ///< the region up to the box
  double box = 1.2;                 ///< > 1: edges of the box, as a multiple of those of the box around all surfaces
  double size = 0.0;                ///< of the tetrahedra's edges, about, as far as the surface allows; 0: any
  bool cap = false;                 ///< close holes whose edges lie near a plane, as cut ends of vessels do
  double cap_tolerance = 0.05;      ///< the share of its diameter by which the edge of such a hole may be off the plane
  bool repair = false;              ///< replace a few triangles that cross or touch, and those around them
  double angle = 60.0;              ///< degrees: sharper edges divide a surface without groups into patches
  Mesher mesher = Mesher::any;
  double seconds = 600.0;  ///< that the program may take
};

/// A mesh file, a generator's options, surfaces to mesh around, a mesh, or a rank's part of one (Partition::cells).
using MeshSource = std::variant<std::filesystem::path, BoxOptions, OctahedraOptions, VesselOptions, RectangleOptions,
                                MazeOptions, SurfaceScene, MeshData, MeshPart>;

/// The regions whose cells are free, by name.
struct FreeRegions {
  std::vector<std::string> regions;
};
/// Cells are free if a cell array of the mesh file has one of these values.
struct FreeValues {
  std::string array;
  std::vector<double> values;
};

/// Patches from a cell array of the mesh file.
struct PatchArray {
  std::string name;
};
/// Patches by where the walls are sharp.
struct PatchAngle {
  double degrees = 30.0;
};

/// The mesh of a scene, its free cells and its patches.
struct EnvironmentScene {
  MeshSource mesh;
  double scale = 1.0;           ///< > 0: the mesh's points are multiplied by it, and those of frames
  bool linearise = false;       ///< cells of second order are taken by their corners (ReadOptions)
  bool skip_bad_cells = false;  ///< flat, inverted and indivisible cells are left out: their faces are walls
  std::variant<std::monostate, FreeRegions, FreeValues> free;  ///< none: as the mesh says, else all
  std::vector<std::string> walls;  ///< groups whose faces are walls also between two free cells (select_walls())
  /// The wall groups to distinguish; none: all groups of the mesh. Names: only these groups of the mesh.
  std::variant<std::monostate, std::vector<std::string>, PatchArray, PatchAngle> patches;
  std::vector<PeriodicPair> periodic;  ///< pairs of these patches, beside those of the mesh; lengths after `scale`
};

/// One step of a deformation. Arrays of the mesh are named here.
struct DeformationScene {
  DeformationStep step;
  std::string field;  ///< pulse: a point array of three components; empty: none
  std::string path;   ///< pulse: a point array of one component; empty: none
  /// frames: mesh files with the same points, one for each of the step's times. A single name may have a star in place
  /// of a whole number. A single .pvd file or case of OpenFOAM gives the times, too. Empty: the frames of `step`.
  std::vector<std::filesystem::path> frames;
  double spacing = 0.0;  ///< frames: s from one to the next, the first at 0; 0: by the step's times
  /// frames: a point array of three components, which is added to the points of the scene's mesh. Empty: the points of
  /// the files count.
  std::string displacement{};
};

/// Particles at random places of the free cells.
struct RandomParticles {
  std::size_t count = 0;
};
/// Where particles start, and how.
struct ParticleSeeds {
  std::string name = "positions";  ///< of messages: the file's
  std::vector<Vec3> points;
  std::vector<Vec3> velocities;     ///< one per point; empty: ParticlesScene::velocity
  std::vector<double> radii;        ///< one per point; empty: ParticlesScene::radius
  std::vector<double> diameters{};  ///< one per point; empty: as ParticlesScene::material; so are the next two
  std::vector<double> densities{};
  std::vector<double> charges_per_mass{};
};
/// Particles at given places.
struct PlacedParticles {
  std::variant<std::filesystem::path, ParticleSeeds> positions;  ///< the file: .vtp or .csv
};
/// Factors of a rate at times, linear between them. Before the first time it is as at the first, after the last as at the
/// last.
struct Waveform {
  std::vector<double> times;    ///< s, increasing; empty: the factor is 1
  std::vector<double> factors;  ///< one for each time, not negative
  double period = 0.0;          ///< above 0, s: it repeats, as FieldSamples::period
};

/// Where particles enter at a patch.
enum class InletProfile : std::uint8_t {
  uniform,  ///< evenly by area
  /// By the volume of fluid that the field brings in through each place, with the field's velocity there. None enter
  /// where it flows out, nor in a step in which it brings in nothing.
  flux
};

/// A point that sends particles out between two cones, evenly by solid angle; in the plane by angle.
struct InletCone {
  Vec3 at;                      ///< in a free cell; while it is in none, no particle enters
  Vec3 axis = {0.0, 0.0, 1.0};  ///< of any length but 0
  double inner = 0.0;           ///< degrees between the axis and the inner cone
  double outer = 0.0;           ///< and the outer one: not less than `inner`, at most 180
  double speed = 0.0;           ///< m / s
};

/// Particles that enter through a patch or from a point: at a rate, in bursts, or both.
struct InletParticles {
  std::string patch;                             ///< empty: the cone's point
  double rate = 0.0;                             ///< particles per second
  InletProfile profile = InletProfile::uniform;  ///< of a patch
  std::optional<InletCone> cone = {};            ///< instead of a patch
  Waveform waveform = {};                        ///< of the rate
  std::vector<double> burst_times = {};          ///< s
  std::uint64_t burst_count = 0;                 ///< particles that enter at each of these times, together
  /// kg / s, above 0: instead of `rate`, which is then this over the mean mass of a particle.
  double mass_rate = 0.0;
};

/// A law of sizes.
enum class SizeLaw : std::uint8_t {
  normal,         ///< size: the mean, spread: the standard deviation, m
  lognormal,      ///< size: the median, spread: the geometric standard deviation, > 1
  rosin_rammler,  ///< the share 1 - exp(-(d / size)^spread) is smaller than d
  table           ///< the diameters and shares that are given
};
/// A distribution of diameters. Shares are of the number of particles.
struct SizeDistribution {
  SizeLaw law = SizeLaw::normal;
  double size = 0.0;  ///< m
  double spread = 0.0;
  double min = 0.0;                    ///< m: none is smaller; those beyond the cuts are drawn again
  double max = 0x1p+100;               ///< m: and none greater
  std::vector<double> diameters = {};  ///< m, of a table
  std::vector<double> shares = {};     ///< one for each, of any sum
};

/// Particles of one kind: where they start, and how.
struct ParticlesScene {
  std::variant<RandomParticles, PlacedParticles, InletParticles> source;
  Vec3 velocity;
  double radius = 0.0;
  std::vector<double> user_data;  ///< of each particle, a number for each name in Scene::user_data; empty: zeros
  bool with_field = false;        ///< they start with the field's velocity at their places, instead of `velocity`
  Material material{};
  bool interception = false;  ///< each radius is half the diameter
  /// Random particles and inlets: the diameter of each, by its id and the seed, in place of the material's.
  std::optional<SizeDistribution> sizes = {};
  /// How many particles each one stands for, if not 1: a number of user data with the name `number`, which a scene adds.
  std::uint64_t number = 1;
  /// Its place among the groups of a scene, if statistics have classes by group: a number of user data with this name, which
  /// the scene adds.
  std::uint64_t group = 0;
};

/// Where a body has its particles: in a solid filled with spheres, on its surface, or in its volume.
enum class BodySamples : std::uint8_t { solid, surface, volume };

/// A body: a surface, where it is put, how it is sampled, what it is made of.
struct BodyScene {
  std::string name;                                                      ///< of its files; letters, digits, '-' and '_'
  std::variant<std::filesystem::path, BarrelOptions, MeshData> surface;  ///< the file: .stl, .obj, .ply, .off
  double scale = 1.0;                                                    ///< first
  Vec3 rotate;                                                           ///< then: axis times angle, rad
  Vec3 at;                                                               ///< then: where the surface's origin goes
  BodySamples samples = BodySamples::solid;
  SamplingOptions sampling;
  double cluster = 0.0;  ///< edge of the regions that are matched each by itself; 0: the body as a whole
  bool edges = true;     ///< whether edges and triangles of the surface meet walls
  BodyOptions body;      ///< its `surface` is set from the one above
};

/// A catheter: where it enters, and how its proximal end moves.
struct CatheterScene {
  /// The motion of its proximal end, from the end of the previous move.
  struct Move {
    double until = 0.0;  ///< s
    double push = 0.0;   ///< m / s; negative: pulled
    double turn = 0.0;   ///< rad / s
  };

  std::string name;
  CatheterOptions options;
  std::vector<Move> moves;  ///< by time; afterwards it is held
  double camera = 0.0;      ///< spacing of the camera's places along it; 0: none
};

/// A rigid tool: a surface or a line, where it is put, and how it moves. No edge and no triangle of it crosses a wall or
/// another tool that it meets: it stops there, and walls that move stop at it. Each point of one that turns is on its arc,
/// which is free: it keeps 2^-10 of its longest side off walls and other tools, or the distance that it has if that is
/// smaller.
struct SolidScene {
  /// The motion from the end of the previous move.
  struct Move {
    double until = 0.0;  ///< s
    Vec3 velocity;       ///< m / s
    /// rad / s: axis times angular velocity, about the pivot; any angle in a step. Cost: a step for each slice. In a step
    /// there are sqrt(arm / (2^-8 longest side)) slices a rad, `arm` being the largest distance of its points from the axis.
    Vec3 turn;
  };

  std::string name;  ///< of its files
  std::variant<std::filesystem::path, MeshData, std::vector<Vec3>>
      shape;                ///< the file: .stl, .obj, .ply, .off; or a line
  double scale = 1.0;       ///< first
  Vec3 rotate;              ///< then: axis times angle, rad
  Vec3 at;                  ///< then: where the origin goes
  Vec3 pivot;               ///< of turns, in the scene; moves with it
  std::vector<Move> moves;  ///< by time; afterwards it is held
  /// Whether it makes up for motion that a wall has stopped, up to a turn of 3.125 rad. Else that motion is lost.
  bool catch_up = false;
  /// The names of the tools that it meets; none: all. Two tools meet if neither leaves the other out.
  std::optional<std::vector<std::string>> meets = {};
};

/// A field: arrays of three components in the scene's mesh or in files, or samples in memory.
struct FieldScene {
  /// Empty: there is no field. In the mesh, "U_*" stands for all arrays with a whole number in place of the star, by
  /// number: one for each time.
  std::string array;
  std::optional<FieldPlace> at;  ///< none: the points if they have the array, else the cells
  FieldFrame frame = FieldFrame::space;
  /// Mesh files with the same points and cells, one for each time. A single name may have a star in place of a whole
  /// number. A single .pvd file or case of OpenFOAM gives the times, too. Empty: the arrays of the scene's mesh.
  std::vector<std::filesystem::path> files;
  std::vector<double> times;  ///< s, increasing, one for each array or file; empty: by `spacing`
  double spacing = 0.0;       ///< s from one time to the next, the first at 0; 0: by `times`
  /// Whether the last of the files counts alone, at all times; none: as a case of OpenFOAM says, else not.
  std::optional<bool> steady = {};
  double period = 0.0;                                  ///< FieldSamples::period
  Interpolation interpolation = Interpolation::linear;  ///< FieldSamples::interpolation
  /// If it can read, used instead of all above but `frame`. load_scene_files() makes it for files. They are read
  /// while the simulation runs.
  FieldSamples samples;

  [[nodiscard]] bool given() const { return !array.empty() || samples.read; }
};

/// The name of a component: that of the array if there is one alone. Otherwise it ends in _x, _y, _z (3); _xx, _xy,
/// _xz, _yy, _yz, _zz (6); _xx, _xy, _xz, _yx ... (9); or _0, _1 ...
std::string component_name(const std::string& array, std::size_t components, std::size_t k);

/// Time steps, and the forces on particles.
struct MotionScene {
  double dt = 1e-3;
  std::uint64_t steps = 1000;
  Vec3 gravity;
  FieldScene field;  ///< velocities, m / s
  FieldScene force;  ///< accelerations, m / s^2, on top of gravity
  /// Arrays whose values particles take at their places, as numbers of user data: one for each component, named as
  /// component_name(). They are where the field's arrays are, in its files or in the mesh, at the same times.
  std::vector<std::string> sample = {};
  /// Numbers of user data that grow by a sampled value times the time, along the way of each particle. The key is the name
  /// of the new number, the value that of the component. Values are taken to be linear over each step.
  std::map<std::string, std::string> integrate = {};
  /// load_scene_files() makes these of `sample`, if the field has files; then `sample` is empty.
  std::vector<ArraySamples> sampled = {};
  double drag = 0.0;
  ForceOptions forces{};
  double diffusion = 0.0;          ///< m^2 / s
  std::string diffusivity{};       ///< instead: one of the names of `sample`
  bool brownian_bridge = false;    ///< as SimulationOptions::brownian_bridge
  TurbulenceOptions turbulence{};  ///< its names are among those of `sample`
  unsigned substeps = 1;
  Integrator integrator = Integrator::euler;
  WallMotion wall_motion = WallMotion::carried;
};

/// The responses of walls.
struct ContactScene {
  WallResponse general = Reflect{};
  std::map<std::string, WallResponse> by_patch;
};

/// An event, with the names that it uses.
struct EventScene {
  Event event;
  /// reconnect: of the new faces on the side; empty: none. Open and close: in place of that of the event; empty: that.
  std::string patch{};
  std::string region{};  ///< open, close: its cells, in place of those of the event; empty: those
};

/// Repairs of cells that a deformation inverts.
struct RemeshScene {
  std::uint64_t every = 0;  ///< steps between two checks of all cells; 0: none
  RepairOptions options;
};

/// Subdivision of full cells during the run.
struct AdaptiveSubdivisionScene {
  std::uint64_t every = 0;  ///< steps between two looks; 0: none
  AdaptiveSubdivisionOptions options;
};

/// The statistics to keep.
struct StatisticsScene {
  StatisticsOptions options;
  bool crossings = false;  ///< a table of all crossings is written
};

/// How arrays stand in .vtp and .vtu files. `fast`: LZ4. `small`: zlib, smaller, but many times slower.
enum class Compression : std::uint8_t { none, fast, small };

/// The files that a run writes.
struct OutputScene {
  /// Steps between two frames; 0: no frames. None: default_every() of the run's steps.
  std::optional<std::uint64_t> every = {};
  bool contacts = false;
  bool report = true;  ///< report.html, if `every` > 0 (dartcast/report.hpp)
  /// None: frames of the environment are `small`, all others are not compressed.
  std::optional<Compression> compression = {};
};

/// Steps between two frames of a run that says nothing else: some 100 frames, and none before 10 steps.
constexpr std::uint64_t default_every(std::uint64_t steps) { return std::max<std::uint64_t>(10, (steps + 99) / 100); }

/// A scene: all that a run needs. docs/scene.md has the keys of its file.
struct Scene {
  std::string name;            ///< the file's, without its ending
  std::filesystem::path file;  ///< empty if the scene comes from none
  std::string text;            ///< of the file
  std::uint64_t seed = 1;
  EnvironmentScene environment;
  std::vector<DeformationScene> deformation;
  std::vector<ParticlesScene> particles;
  std::vector<std::string> user_data;          ///< SimulationOptions::user_data
  std::optional<CollisionOptions> collisions;  ///< of spheres with each other and bodies; none: they do not meet
  BodyCollisionOptions body_collisions;        ///< of bodies with each other
  std::vector<BodyScene> bodies;
  std::vector<CatheterScene> catheters;
  std::vector<SolidScene> solids;
  MotionScene motion;
  ContactScene contact;
  std::vector<EventScene> events;  ///< by time
  RemeshScene remesh;
  AdaptiveSubdivisionScene adaptive_subdivision;
  StatisticsScene statistics;
  OutputScene output;
};

}  // namespace dartcast
