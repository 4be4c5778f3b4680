// A catheter: a chain of particles, held and moved at its proximal end, in an environment that may deform.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 1, names it as what the method is for. The chain is solved as an implicit
// step of an inextensible rod with a rest curvature at its tip and without twisting energy of its own (M. Bergou et
// al., "Discrete elastic rods", 2008); what the solver wants, exact walks of the points grant as far as walls let them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "catheter/chain_solver.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"

namespace dartcast {

/// SI units: metres, radians.
struct CatheterOptions {
  double length = 0.1;    ///< of the whole catheter, in whole spacings
  double spacing = 1e-3;  ///< of its points; less than the smallest feature of the vessel: edges do not meet walls
  /// Bending stiffness (N m^2), over what resists sideways motion of a metre of it in one step (N / m^2): m^4. Bends
  /// that are longer than its fourth root outlast a step.
  double stiffness = 1e-8;
  double tip_length = 0.0;     ///< of the pre-bent tip
  double tip_curvature = 0.0;  ///< of it at rest, 1 / m; the bend is along a frame's normal
  Vec3 entry = {};             ///< where it comes in: strictly inside of a free cell
  Vec3 direction = {};         ///< in which it does; of any length but 0
  double friction = 0.05;      ///< Coulomb's coefficient at walls, >= 0
  unsigned rounds = 24;        ///< of solving and walking, in one substep at most; > 0
  /// Largest relative error of a segment's length that a push may leave; below 0.01.
  double tolerance = 0.008;
};

/// What is done to the proximal end in one step.
struct CatheterInput {
  double push = 0.0;  ///< m; negative: pulled
  double turn = 0.0;  ///< rad, about the direction of the entry, by the right hand; at most 2 pi in magnitude
  Vec3 load = {};     ///< displacement in one step that weight or flow would give to a point that is held by nothing, m
};

/// What came of it.
struct CatheterStep {
  double pushed = 0.0;         ///< m: how far it really went; less than asked where there was no way on
  double turned = 0.0;         ///< rad
  double worst_segment = 0.0;  ///< largest relative error of the length of a segment in the lumen
  std::uint32_t substeps = 0;
  std::uint32_t rounds = 0;
  std::uint64_t contacts = 0;  ///< of points with walls, in all rounds
  std::uint32_t at_walls = 0;  ///< points held by a wall at the end
  std::uint32_t held = 0;      ///< points in cells that are not valid now
};

/// Axes at a point: right-handed, without twist along the chain but what the proximal end was turned by.
struct CatheterFrame {
  Vec3 tangent;   ///< unit, towards the tip
  Vec3 normal;    ///< unit: the side that the tip is pre-bent to
  Vec3 binormal;  ///< tangent x normal
};

/// All that a catheter goes on from; environment and options are not in it.
struct CatheterCheckpoint {
  std::vector<ParticleState> states;
  std::vector<Weights> held_weights;
  std::vector<ChainWall> walls;  ///< that points have met
  double inserted = 0.0;
  double turned = 0.0;
  Vec3 direction;
  Vec3 reference;
};

/// Points from the tip (0) to the proximal end, then one at the entry. Every one is a particle of the environment: in
/// the lumen, exactly, at any time. Those not inserted yet wait at the entry, which rides along with the vessel.
///
/// A step, after the environment's move if there is one: all points ride along with the vessel; then the push and the
/// turn are made in substeps of at most a quarter of the spacing and a fifth of a radian. In each, points follow the
/// chain's own path, and rounds of solving for bending, lengths, walls met so far and friction
/// (catheter/chain_solver.hpp) alternate with walks, in which points slide at walls. A substep that leaves a segment
/// off by more than the tolerance is taken back and tried again as half of it, four times; then the rest of the push is
/// refused. The first spacing beyond the entry is straight; a push is refused, too, where that has no room. Where the
/// vessel's motion leaves no such solution, bends are given up before lengths. Twist passes at once to the tip: the
/// chain is as stiff against it as it can be. Results are the same bits for any number of threads.
class Catheter {
 public:
  /// Nothing is inserted yet. `environment` outlives the catheter, and is moved and edited by others. Throws
  /// InvalidArgument, naming it, where an option is out of range, the entry is in no free cell, or the way from there
  /// by the spacing is not free, or the environment is not of space.
  Catheter(Environment& environment, const CatheterOptions& options);
  Catheter(const Catheter&) = delete;
  Catheter& operator=(const Catheter&) = delete;

  /// Once after each move of the environment, and as often as wanted between. Throws InvalidArgument, nothing changed,
  /// where an input is not finite or too large, or the catheter missed a move or an edit. Where the vessel itself
  /// leaves no room, a segment may be off without any push: see `worst_segment`. Cost: some 1 us per point and round.
  CatheterStep step(const CatheterInput& input);

  /// To be called after each edit of the environment, as Environment::update_after_edit(): points without a place are
  /// moved to the nearest free one; where there is none they are held in their blocked cells until these are free
  /// again. Throws InvalidArgument, nothing changed, where a point's cell was removed and no free cell is left; the
  /// catheter cannot be used after that.
  UpdateReport update_after_edit();

  /// The points in the lumen, from the tip on; then the entry, unless nothing is inserted.
  [[nodiscard]] std::vector<Vec3> points() const;
  /// Their frames.
  [[nodiscard]] std::vector<CatheterFrame> frames() const;
  /// Of the part in the lumen, as it should be; measured along the points it is right to 1%.
  [[nodiscard]] double inserted() const { return inserted_; }
  /// Of the part in the lumen, measured along its points.
  [[nodiscard]] double measured_length() const;
  [[nodiscard]] double total_length() const;
  [[nodiscard]] double turned() const { return turned_; }
  [[nodiscard]] Vec3 entry() const { return particles_[count_].position; }
  [[nodiscard]] Vec3 direction() const { return direction_; }

  /// All points with the waiting ones, then the entry: for audits.
  [[nodiscard]] const Particles& particles() const { return particles_; }
  [[nodiscard]] const CatheterOptions& options() const { return options_; }
  [[nodiscard]] StateHash state_hash() const;

  [[nodiscard]] CatheterCheckpoint checkpoint() const;
  /// Goes on from a checkpoint of a catheter with the same options in an equal environment at the same move: to the
  /// same bits. Throws InvalidArgument, nothing changed, where it does not fit.
  void restore(const CatheterCheckpoint& saved);

 private:
  // Where a point was in its simplex when that was last looked at.
  struct Hold {
    Corners corners;
    Weights weights;
  };
  // What a substep that fails is taken back to.
  struct Saved {
    Particles particles;
    double inserted = 0.0;
    double turned = 0.0;
    std::vector<ChainWall> walls;
  };
  enum class Bending : std::uint8_t { stiff, limp };
  struct Outcome {
    double worst = 0.0;
    std::uint32_t rounds = 0;
    std::uint32_t held = 0;
    std::uint64_t contacts = 0;
  };

  // catheter.cpp: a step.
  [[nodiscard]] std::size_t inserted_points() const;
  [[nodiscard]] std::size_t free_points() const;
  [[nodiscard]] Vec3 base(std::size_t i) const;
  void check(const CatheterInput& input) const;
  bool attempt(const CatheterInput& piece, double share, Bending bending, double limit, CatheterStep& result);
  bool make(const CatheterInput& piece, double share, CatheterStep& result);
  void make_less(const CatheterInput& piece, double share, CatheterStep& result);
  void relax(const Vec3& load, CatheterStep& result);
  void ride(CatheterStep& result);
  [[nodiscard]] Vec3 carried(std::size_t i) const;
  void turn_with_vessel(const Corners& now);
  void hold();
  void save();
  void take_back();
  // catheter_substep.cpp: a part of it.
  static AfterContact slide_at_walls(const Contact& contact, std::span<const WallHit> walls,
                                     std::span<const WallHit> earlier);
  Outcome substep(const CatheterInput& piece, double share, Bending bending);
  void follow_path(double push, std::size_t free);
  void bend_tip(std::size_t free);
  double walk(std::size_t free, Outcome& outcome);
  void keep_walls(const ContactList& contacts);
  [[nodiscard]] double worst_segment() const;
  [[nodiscard]] std::uint32_t points_at_walls() const;
  // catheter_frames.cpp: what it looks like.
  [[nodiscard]] Vec3 base_normal() const;

  Environment& environment_;
  CatheterOptions options_;
  std::size_t count_ = 0;  // points of the chain, without the entry
  Particles particles_;
  double inserted_ = 0.0;
  double turned_ = 0.0;
  Vec3 direction_;  // unit
  Vec3 reference_;  // unit, perpendicular to it: the normal of a frame that is not turned
  std::vector<Hold> holds_;
  std::uint64_t edits_ = 0;
  std::vector<Vec3> targets_;  // of all particles; between walks the chain as it is solved for
  std::vector<Vec3> wanted_;
  std::vector<Vec3> start_;
  std::vector<Vec3> bends_;
  std::vector<Vec3> before_;
  std::vector<ChainWall> walls_;
  ChainSolver solver_;
  Saved saved_;
};

}  // namespace dartcast
