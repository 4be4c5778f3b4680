// Solids: edges and triangles among walls. No edge and no triangle ever crosses one.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 8 and figure 21, leaves this open: particles at the vertices of a body do
// not keep its edges out of walls.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// Only the surface of a solid counts: what is inside needs no points. The sides of triangles need not be listed as
/// edges. A point that no edge and no triangle uses is a part of the solid by itself.
struct SolidMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The solid of a surface, closed or open. Each face is a fan from its lowest-numbered corner. One that is not convex is
/// divided by cutting ears off, exactly. Points that no face uses are
/// left out; the others keep their order. Throws InvalidMesh if check_and_repair_surface() refuses the surface.
SolidMesh solid_of_surface(const MeshData& surface);

/// The solid of the boundary of a mesh of cells, whatever their free marks. Points inside are left out; the others keep
/// their order. Throws InvalidMesh if check_and_repair() refuses the mesh, or the mesh is of the plane.
SolidMesh solid_of_cells(const MeshData& mesh);

/// Points joined one after another by edges.
SolidMesh solid_of_polyline(std::span<const Vec3> points);

/// Throws InvalidMesh, which names the first defect. Defects are no points, and a point outside the exact range. So are
/// the number of a point that does not exist, and a number twice in an element.
void check(const SolidMesh& mesh);

/// Why a place is refused.
enum class SolidRefusal : std::uint8_t {
  none,
  vertex_not_free,    ///< a vertex is in a blocked cell or outside
  meets_wall,         ///< an edge or a triangle touches or crosses a wall
  encloses_wall,      ///< a wall is inside the closed solid
  cell_not_positive,  ///< a cell that an edge or a triangle reaches is flat or inverted
  meets_solid,        ///< it touches or crosses another solid, or one is inside the other
};

/// The answer to a request to add one solid; also the state of a solid after an edit.
struct SolidPlacement {
  SolidRefusal refusal = SolidRefusal::none;
  std::uint32_t solid = 0xffffffffU;  ///< its index in the set; none (0xffffffff) if it is not added
  /// If it is refused: the vertices (numbers in the solid) of the place, the first `count` of these.
  std::array<std::uint32_t, 3> vertices{};
  std::uint8_t count = 0;
  std::uint32_t other = 0xffffffffU;  ///< the solid that it meets; none (0xffffffff) without one
};

/// The parts of a solid and a wall that meet first.
enum class SolidContactKind : std::uint8_t {
  vertex_face,  ///< a vertex of the solid and a wall
  edge_edge,    ///< an edge of the solid and an edge of a wall
  face_vertex   ///< a triangle of the solid and a vertex of a wall
};

/// A place where a solid meets a wall in a step.
struct SolidContact {
  std::uint32_t solid = 0;
  SolidContactKind kind = SolidContactKind::vertex_face;
  std::uint8_t count = 0;                   ///< of the vertices: 1, 2 or 3, by the kind
  std::array<std::uint32_t, 3> vertices{};  ///< numbers in the solid
  std::array<double, 3> weights{};          ///< of the vertices at the place; they sum to 1
  CellFace face;                            ///< the wall, of the free cell
  std::uint16_t triangle = 0;               ///< in the face's fan
  Kind wall_kind = Kind::face;              ///< of the place on the wall: face, edge or vertex
  Dart dart;                                ///< of that face, edge or vertex, in the free cell
  Patch patch;
  double time_of_impact = 0.0;  ///< on the way towards the target, in [0, 1]
  Vec3 point;                   ///< of the solid, where the place is at the end of the step
  Vec3 wall_point;              ///< of the wall, at the end of the step
  Vec3 normal;                  ///< unit: from the wall towards the side of the solid
  double gap = 0.0;             ///< (point - wall_point) . normal
  Vec3 displacement;            ///< of the place on the solid, from the start of the step to the caller's targets
  Vec3 wall_displacement;       ///< of the place on the wall, to the caller's positions
};

/// A place where two solids meet in a step.
struct SolidMeeting {
  std::uint32_t solid = 0;  ///< the one that was added later
  std::uint32_t other = 0;
  SolidContactKind kind =
      SolidContactKind::vertex_face;              ///< the part of `solid` first; the other's stands for the wall's
  std::uint8_t count = 0;                         ///< of `vertices`: 1, 2 or 3, by the kind; the other has 4 - count
  std::array<std::uint32_t, 3> vertices{};        ///< numbers in the solid
  std::array<std::uint32_t, 3> other_vertices{};  ///< numbers in the other
  std::array<double, 3> weights{};                ///< of the vertices at the place; they sum to 1
  std::array<double, 3> other_weights{};
  double time_of_impact = 0.0;  ///< on the way towards the targets, in [0, 1]
  Vec3 point;                   ///< of the solid, where the place is at the end of the step
  Vec3 other_point;
  Vec3 normal;       ///< unit: from the other towards the solid
  double gap = 0.0;  ///< (point - other_point) . normal
};

/// How a step treats contacts.
struct SolidStepOptions {
  /// Rounds of corrections at most. 0: a solid whose way is not free stops before its first contact, in the shape that it
  /// has there.
  unsigned rounds = 12;
  unsigned iterations = 20;  ///< sweeps over the contacts, in each round; > 0
  /// Kept between a solid and a wall after a contact. 0: 2^-10 of the shortest of two lengths, the longest side of the
  /// solid and the longest side of the wall.
  double separation = 0.0;
};

/// The effects of a step.
struct SolidStep {
  std::vector<SolidContact> contacts;  ///< those that changed the motion; by solid, then by time
  std::vector<SolidMeeting>
      meetings;                 ///< of solids that stopped at each other: each pair once; by solid, then by other
  std::vector<double> made;     ///< for each solid: the share of the way to its (corrected) targets that it went
  double walls_made = 1.0;      ///< of move_with(): the share of the motion that the walls made
  std::uint32_t corrected = 0;  ///< solids whose targets contacts changed
  std::uint32_t cut = 0;        ///< solids that went less than their way
  /// Solids that stayed because a cell that they reach is flat or inverted, or because they are stuck().
  std::vector<std::uint32_t> held;
  std::uint32_t rounds = 0;  ///< of corrections made, at most, by any solid
  std::uint64_t pairs = 0;   ///< of parts of solids and walls, looked at
};

/// The state of a set of solids after a step. The solids themselves, their inverse masses and the environment are not in
/// it.
struct SolidCheckpoint {
  std::vector<ParticleState> states;
  std::vector<Weights> held_weights;
};

/// The outcome of an audit of solids.
struct SolidAudit {
  std::uint64_t checked = 0;  ///< edges, triangles and single points, but for those of stuck solids
  std::uint64_t failed = 0;   ///< those of them that meet a wall, or a solid that theirs meets
  std::string first;          ///< the first that failed; empty: none failed
};

/// Solids in an environment of space.
///
/// Guarantees. After every step no edge and no triangle of a solid meets a wall. The straight motion between the
/// positions before and after the step, as stored, is free of contact with the walls, by exact decisions. So what is
/// outside a closed solid stays outside. A step ends after at most `rounds` corrections and 45 cuts. Results are the same
/// bits for any number of threads. Solids that meet each other never cross, by the same decisions. One that goes towards
/// another stops before it, as it stops before a wall. Not guaranteed: a solid may pass through itself, and through those
/// that it does not meet. While a solid is stuck(), cells may carry it through others.
class SolidSet {
 public:
  /// `environment` outlives the set. Its owner may move it only by move_with() if the set is not empty. Throws
  /// InvalidArgument if the environment is of the plane.
  explicit SolidSet(Environment& environment);
  ~SolidSet();
  SolidSet(const SolidSet&) = delete;
  SolidSet& operator=(const SolidSet&) = delete;

  /// Adds a solid that meets these others of the set. They must not touch it, and none of two may be inside the other. If
  /// it also touches no wall and encloses none, it is added; else the answer says why, and nothing is added. Throws as
  /// check(), and InvalidArgument if there is no such other, or the set missed a move or an edit. Cost: as a step, and a
  /// search for its points (Environment::locate()). A step looks at all pairs of solids that meet and whose boxes
  /// overlap on their ways: n log n in their elements.
  SolidPlacement add(const SolidMesh& mesh, std::span<const std::uint32_t> meets = {});

  /// Removes a solid. Those after it move up. Throws InvalidArgument if there is no such solid.
  void remove(std::uint32_t solid);

  /// To be called after each edit of the environment, as Environment::update_after_edit(). A solid is stuck if a wall
  /// that the edit made is in it, or leaves a vertex no free place. It stays until a
  /// later edit frees it, and the cells around its vertices carry it along when they move. Vertices that are outside after
  /// the edit move to the nearest free place. Throws InvalidArgument, nothing changed, if there is none, or the set
  /// missed a move or an edit. Cost: that of Environment::update_after_edit(), and some 2 us for each edge and triangle.
  UpdateReport update_after_edit();
  /// All stuck solids, in order, and where each is stuck.
  [[nodiscard]] std::span<const SolidPlacement> stuck() const;

  [[nodiscard]] std::size_t size() const;
  /// The vertices of all solids, one solid after another.
  [[nodiscard]] std::span<const Vec3> positions() const;
  /// The number of the first vertex of each solid; then the number of all vertices.
  [[nodiscard]] std::span<const std::uint32_t> first_vertices() const;
  /// The vertices as particles: each is in the simplex that its state names.
  [[nodiscard]] const Particles& particles() const;

  /// Inverse masses of all vertices, which share out the corrections; 1 at first. Vertices of 0 are not corrected. Throws
  /// InvalidArgument if the number does not match, or one is negative or not finite.
  void set_inverse_masses(std::span<const double> inverse_masses);

  /// Moves the vertices of all solids straight (a turn by its chord) towards these targets, with walls at rest. In order:
  ///  1. Detect: all contacts on the way to the targets. Without one the targets are reached.
  ///  2. Correct the targets, so that the contacts found so far keep their separation, and detect again; in rounds.
  ///  3. Cut: what still meets a wall goes 15/16 of the way to its first contact, as a whole. The rounded positions
  ///     are checked again, and the way halved, until it is free. Throws InvalidArgument, nothing changed, if the
  ///     number does not match, or a target is not finite or outside the exact range. It also throws if an option is
  ///     out of range, or the set missed a move or an edit. The report is valid until the next step. Cost: some 2 us
  ///     for an edge as long as a cell, whatever the size of the scene.
  const SolidStep& advance(std::span<const Vec3> targets, const SolidStepOptions& options = {});

  /// As advance(), while the vertices of the environment move straight to `positions`, those of all the mesh's
  /// points. It makes that move. If walls would run into a solid even though it stayed, the environment and all
  /// solids stop at the same share of their ways, SolidStep::walls_made. If that is 0, the move goes nowhere. Other
  /// sets of particles must then be advanced, as after Environment::move(). Throws as advance() and
  /// Environment::move().
  const SolidStep& move_with(std::span<const Vec3> targets, std::span<const Vec3> positions,
                             const SolidStepOptions& options = {});

  [[nodiscard]] SolidCheckpoint checkpoint() const;
  /// Goes on from a checkpoint of a set with the same solids, in an equal environment after the same move. Every later
  /// step is the same to the last bit. Throws InvalidArgument, nothing changed, if the checkpoint does not fit.
  void restore(const SolidCheckpoint& saved);

  /// Whether any edge or triangle meets a wall, in integers of any length, by code that shares nothing with the steps.
  /// Cost: a tree over all walls; some 10 us for each pair whose boxes meet.
  [[nodiscard]] SolidAudit audit() const;

 private:
  friend struct JointMoves;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The state of a solid of a scene, and sums over its steps.
struct SolidSummary {
  std::string name;
  std::size_t vertices = 0;
  Vec3 pivot;                  ///< now
  std::uint64_t contacts = 0;  ///< with walls that changed its motion, and with other solids
  std::uint64_t stopped = 0;   ///< steps that it did not make in full
  bool stuck = false;          ///< an edit left it no free place (SolidSet::stuck())
};

}  // namespace dartcast
