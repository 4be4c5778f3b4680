// A catheter: a chain of particles, held and moved at its proximal end, in an environment that may deform. And a
// camera's path along it: an endoscopy.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 1, names catheters as a use of the method. The chain is solved as an
// implicit step of an inextensible rod with a rest curvature at its tip and without twisting energy (M. Bergou et al.,
// "Discrete elastic rods", 2008). The points then walk exactly towards the solver's positions, as far as walls let
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/solids.hpp"

namespace dartcast {

/// SI units: metres, radians.
struct CatheterOptions {
  double length = 0.1;  ///< of the whole catheter, in whole spacings
  /// Between its points. Without edges choose it smaller than the smallest feature of the vessel.
  double spacing = 1e-3;
  /// Bending stiffness (N m^2), over the resistance to sideways motion of a metre of catheter in one step (N / m^2):
  /// m^4. Larger is stiffer. Typical: 1e-9 (soft) to 1e-7 (stiff).
  double stiffness = 1e-8;
  double tip_length = 0.0;     ///< of the pre-bent tip
  double tip_curvature = 0.0;  ///< of the tip at rest, 1 / m; the bend is along a frame's normal
  Vec3 entry = {};             ///< where the catheter comes in: strictly inside a free cell
  Vec3 direction = {};         ///< in which it comes in; of any length but 0
  double friction = 0.05;      ///< Coulomb's coefficient at walls, >= 0
  unsigned rounds = 24;        ///< of solving and walking, in one substep at most; > 0
  /// Largest relative error of a segment's length that a push may leave; below 0.01.
  double tolerance = 0.008;
  /// Whether the segments between the points meet walls, too. They keep 2^-10 of the spacing from walls, or of the wall's
  /// longest side if that is shorter.
  bool edges = true;
};

/// The motion of the proximal end in one step.
struct CatheterInput {
  double push = 0.0;  ///< m; negative: pulled
  double turn = 0.0;  ///< rad, about the direction of the entry, by the right hand; at most 2 pi in magnitude
  Vec3 load = {};     ///< displacement from weight or flow, in one step, of a point that nothing holds, m
};

/// Report of one step.
struct CatheterStep {
  double pushed = 0.0;         ///< m: the real push; less than the input if there was no way on
  double turned = 0.0;         ///< rad
  double worst_segment = 0.0;  ///< largest relative error of the length of a segment in the lumen
  std::uint32_t substeps = 0;
  std::uint32_t rounds = 0;
  std::uint64_t contacts = 0;  ///< of points with walls, in all rounds
  std::uint32_t at_walls = 0;  ///< points held by a wall at the end
  std::uint32_t held = 0;      ///< points in cells that are not valid now
  bool stuck = false;          ///< nothing moved: a wall that an edit made is in a segment, or leaves a point no place
};

/// Axes at a point: right-handed. Along the chain they do not twist, except by the turn of the proximal end.
struct CatheterFrame {
  Vec3 tangent;   ///< unit, towards the tip
  Vec3 normal;    ///< unit: the side that the tip is pre-bent to
  Vec3 binormal;  ///< tangent x normal
};

/// A plane that a place on the chain must stay above: normal . (x - point) >= 0.
struct ChainWall {
  std::uint32_t index = 0;  ///< of the point before the place
  double weight = 0.0;      ///< of the next point, in [0, 1]; 0: the place is the point itself
  Vec3 normal;              ///< unit
  Vec3 point;
  double pressure = 0.0;   ///< of the place on it, from the last solve; 0: not in contact
  std::uint32_t idle = 0;  ///< walks since it was met. With edges: substeps in which it neither was met nor pressed
};

/// The state of a catheter after a step; environment and options are not in it.
struct CatheterCheckpoint {
  std::vector<ParticleState> states;
  std::vector<Weights> held_weights;
  std::vector<ChainWall> walls;  ///< that points have met
  double inserted = 0.0;
  double turned = 0.0;
  Vec3 direction;
  Vec3 reference;
};

/// Points from the tip (0) to the proximal end, then one at the entry. Each is a particle of the environment, so it is
/// in the lumen, exactly, at any time. Points that are not inserted yet wait at the entry, which the vessel carries.
///
/// A step makes the push and the turn in substeps of at most a quarter of the spacing and a fifth of a radian. In a substep
/// points follow the chain's own path. Then rounds of solving alternate with looks at the straight way of all points and
/// segments. A solve takes bending, lengths, friction and the walls met so far. The points go when that way is proved
/// free: so with edges no segment meets a wall at any time. (Without edges, points walk in each round, and slide at walls.) A
/// substep that leaves a segment off by more than the tolerance, or has no free way, is undone. It is tried again with half
/// the length, four times; then the rest of the push is refused. The first spacing beyond the entry is straight; a push is
/// refused, too, if it has no room. If the vessel's motion leaves
/// no such solution, lengths come before bends. Twist reaches the tip at once: the chain is infinitely stiff against
/// it. Results are the same bits for any number of threads.
class Catheter {
 public:
  /// Nothing is inserted yet. `environment` outlives the catheter; its owner edits it, and moves it by move_with().
  /// Throws InvalidArgument, which names the option, if one is out of range. It also throws if the environment is
  /// planar, the entry is in no free cell, or the way from it by the spacing is blocked.
  Catheter(Environment& environment, const CatheterOptions& options);
  ~Catheter();
  Catheter(const Catheter&) = delete;
  Catheter& operator=(const Catheter&) = delete;

  /// Any number of times. Throws InvalidArgument, nothing changed, if an input is not finite or too large, or the
  /// catheter missed a move or an edit. If the vessel itself leaves no room, a segment may be off without any push: see
  /// `worst_segment`. Cost: some 2 us per point and round.
  CatheterStep step(const CatheterInput& input);

  /// Moves the environment straight to these positions of all the mesh's points. The vessel carries all points along, and
  /// segments bend away from walls. If these would run into a segment even so, the environment and the catheter stop at the
  /// same share of their ways, which is returned. Other particles must then be advanced, as after Environment::move().
  /// Without edges it is Environment::move(), and the owner may call that in its place. Throws as Environment::move(), and
  /// InvalidArgument if the catheter missed a move or an edit; nothing is changed then. Cost: some 6 us per segment.
  double move_with(std::span<const Vec3> positions);

  /// To be called after each edit of the environment, as Environment::update_after_edit(). Points without a place move
  /// to the nearest free one. If there is none they are held in their blocked cells until these are free again. With
  /// edges the catheter is stuck if a wall that the edit made is in a segment. It stays until a later edit frees it, and
  /// the cells around its points carry it along.
  /// Throws InvalidArgument, nothing changed, if a point's cell was removed and no free cell exists; the catheter
  /// cannot be used after that.
  UpdateReport update_after_edit();

  /// The points in the lumen, from the tip on; then the entry, unless nothing is inserted.
  [[nodiscard]] std::vector<Vec3> points() const;
  /// Their frames.
  [[nodiscard]] std::vector<CatheterFrame> frames() const;
  /// The walls that points and segments press on since the last step: at a point vertex_face, else edge_edge. Each is the
  /// wall nearest to the place on the chain. `solid` is 0, vertices are numbers of points(), the time of impact is 1,
  /// displacements are 0. A place that a wall held in the last solve, but that is farther off now than 2^-4 of the spacing,
  /// is none. Empty after an edit. Cost: some us each.
  [[nodiscard]] std::vector<SolidContact> contacts() const;
  /// Nominal length of the part in the lumen; measured along the points it is right to 1%.
  [[nodiscard]] double inserted() const;
  /// Length of the part in the lumen, measured along its points.
  [[nodiscard]] double measured_length() const;
  [[nodiscard]] double total_length() const;
  [[nodiscard]] double turned() const;
  [[nodiscard]] Vec3 entry() const;
  [[nodiscard]] Vec3 direction() const;

  /// Whether any segment meets a wall, in integers, with code that shares nothing with the steps. Without edges, or if
  /// the catheter is stuck, nothing is checked. Cost: as SolidSet::audit().
  [[nodiscard]] SolidAudit audit() const;
  /// All points with the waiting ones, then the entry: for audits.
  [[nodiscard]] const Particles& particles() const;
  [[nodiscard]] const CatheterOptions& options() const;
  [[nodiscard]] StateHash state_hash() const;

  [[nodiscard]] CatheterCheckpoint checkpoint() const;
  /// Goes on from a checkpoint of a catheter with the same options, in an equal environment after the same move. Every
  /// later step is the same to the last bit. Throws InvalidArgument, nothing changed, if the checkpoint does not
  /// fit.
  void restore(const CatheterCheckpoint& saved);

 private:
  friend struct CatheterMoves;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A camera's path along a catheter, or any chain of points in the lumen.

/// How camera_path() places the cameras.
struct CameraOptions {
  double spacing = 1e-3;           ///< of the cameras along the spline, > 0
  Vec3 up = {0.0, 1.0, 0.0};       ///< at the first camera, made perpendicular to its direction
  std::size_t max_count = 100000;  ///< cameras at most
};

/// A place and a view on the path.
struct Camera {
  Vec3 position;     ///< in the lumen, exactly
  Vec3 direction;    ///< unit: along the spline
  Vec3 up;           ///< unit, perpendicular to it; carried along without twist
  double arc = 0.0;  ///< from the first camera, along the line through all, m
};

/// The cameras in order, from the first point to the last.
struct CameraPath {
  std::vector<Camera> cameras;
  std::size_t at_walls = 0;  ///< cameras that a wall kept from the spline
};

/// Cameras along the centripetal spline through `points` (E. Catmull, R. Rom, "A class of local interpolating splines",
/// 1974; C. Yuksel, S. Schaefer, J. Keyser, "Parameterization and applications of Catmull-Rom curves", 2011). They are
/// evenly spaced along it, except where a wall keeps one off; the last is at its end. A camera is a particle that walks
/// from the point before it to the spline, so that no wall is between. Points that repeat count once. Throws
/// InvalidArgument if there are not two points, one (named) is in no free cell, or the environment is not of space. It
/// also throws if the path would take more than `max_count` cameras. Cost: 4 us per camera, and once after a move a
/// grid over the cells (Environment::locate()).
CameraPath camera_path(Environment& environment, std::span<const Vec3> points, const CameraOptions& options = {});

/// Over all steps so far.
struct CatheterTotals {
  double worst_segment = 0.0;  ///< largest relative error of a segment's length
  double refused = 0.0;        ///< m of pushes and pulls that there was no way for
};

/// The state of a catheter, and sums over its steps.
struct CatheterSummary {
  std::string name;
  double inserted = 0.0;         ///< m
  double measured_length = 0.0;  ///< of the part in the lumen, m
  CatheterTotals totals;
  Vec3 tip;
};

}  // namespace dartcast
