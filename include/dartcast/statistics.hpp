// Statistics of a run: hits of wall faces, crossings of planes, residence times, pathlines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

// Hits of wall faces: how often particles met each of them.

/// A contact as an impact on the wall.
struct Impact {
  std::uint64_t number = 1;  ///< of particles that meet the wall together (SimulationOptions::user_data)
  double mass = 0.0;         ///< kg, of all of them; 0 if they have none
  double energy = 0.0;       ///< J, of their motion relative to the wall
  double sine = 0.0;         ///< of the angle between the wall and the way to it, in [0, 1]
};

/// The contacts at one wall face.
struct FaceHits {
  CellFace face;  ///< of the free cell
  Patch patch;
  std::uint64_t hits = 0;
  double mass = 0.0;                      ///< kg, of Impact; so are the next two
  double energy = 0.0;                    ///< J
  std::array<std::uint64_t, 9> angles{};  ///< hits by angle to the wall: from 0 to 10 degrees, ..., from 80 to 90

  bool operator==(const FaceHits&) const = default;
};

/// Counts contacts by wall face. A contact counts once, at the wall that the particle met first. So the hits of a
/// patch are its contacts. Faces are named, not placed: hits go along when the vertices move.
///
/// A face continues over an edit if a free cell has a wall with the same corners afterwards. Vertices that the edit
/// put on its edges, or took from them, make no difference. Every other face in the edit ends: one that was split,
/// merged, or is no wall any more. Its hits are kept by patch (ended_by_patch()); its other sums end. New faces start at 0. So no hit is
/// lost: the hits of the faces and those of ended faces are all contacts.
class WallHits {
 public:
  /// Counts the contacts of a step. Call it before the environment is edited. `impacts`: one of each contact; empty: each
  /// counts once, and adds nothing else. Cost: constant for each contact.
  void add(const Environment& environment, const ContactList& contacts, std::span<const Impact> impacts = {});
  /// Follows the environment's last edit. Call it after each edit. Cost: the cells touched.
  void update_after_edit(const Environment& environment);

  [[nodiscard]] std::uint64_t of(CellFace face) const { return at(face).hits; }
  /// All that is kept of a face.
  [[nodiscard]] FaceHits at(CellFace face) const;
  /// Those that were hit, in the order of cells and their faces.
  [[nodiscard]] std::vector<FaceHits> faces() const;
  /// Hits of faces that an edit has ended, by the number of the patch. Patches without such hits may be left out at the
  /// end.
  [[nodiscard]] const std::vector<std::uint64_t>& ended_by_patch() const { return ended_; }
  /// All hits, those of ended faces included, by the number of the patch; one for each patch.
  [[nodiscard]] std::vector<std::uint64_t> by_patch(const Environment& environment) const;

  /// Goes on from faces() and ended_by_patch() of an environment that was in the same state. Throws InvalidArgument,
  /// nothing changed, if one of the faces is no wall of a free cell.
  void restore(const Environment& environment, const std::vector<FaceHits>& faces, std::vector<std::uint64_t> ended);

 private:
  struct Record {
    FaceHits sums;
    std::vector<Vertex> corners;  // when it was hit first, or made by an edit
  };

  Record& record(const Environment& environment, CellFace face);
  void end(const Record& record);
  std::vector<Record> take_removed(const Environment& environment);
  void end_former_walls(const Environment& environment, Cell cell);

  std::unordered_map<std::uint32_t, std::vector<Record>> cells_;  // by cell
  std::vector<std::uint64_t> ended_;
};

// Crossings of planes: which particles pass a section in a step, and in which direction.

/// A plane, or a disc of it.
struct SectionPlane {
  std::string name;  ///< 1 to 64 letters, digits, - and _
  Vec3 point;
  Vec3 normal;          ///< of any length: forward is where it points to
  double radius = 0.0;  ///< of the disc around `point`; 0: the whole plane
};

/// Throws InvalidArgument, which names the plane, if its name is not as above, or another plane has it. It also
/// throws for a point that is not finite or outside the exact range. So do a normal that is not finite or zero, and a
/// radius that is not finite or negative.
void check(std::span<const SectionPlane> planes);

/// A particle that passed a plane.
struct PlaneCrossing {
  std::uint32_t plane = 0;
  std::uint32_t particle = 0;
  bool forward = false;
  double share = 0.0;  ///< of the step, in [0, 1]
  Vec3 point;          ///< on the plane, rounded
};

/// The crossings of a step, by particle, then by plane. A particle crosses a plane forward if its position before
/// the step is behind the plane and its position after the step is not. It crosses backward in the opposite case. A
/// position exactly on the plane is not behind it. So a particle that stops on the plane and goes on is counted once.
/// The signs are exact. (Components of a normal below 2^-300 of the largest count as 0.)
///
/// Only the two ends of the step count. If a particle rebounds from a wall within the step, its way between them is
/// not looked at. `share` and `point` are those of the straight line between the ends. With a radius, this point must
/// lie within the disc; its distance is rounded.
///
/// Throws InvalidArgument as check(), and if the numbers of positions do not match. Cost: linear, parallel. The same
/// for any number of threads.
std::vector<PlaneCrossing> find_crossings(std::span<const SectionPlane> planes, std::span<const Vec3> before,
                                          std::span<const Vec3> after, Threads threads = {});

/// Times of many particles: their number, their mean, their distribution.
struct ResidenceTimes {
  static constexpr std::size_t bin_count = 64;

  std::uint64_t count = 0;
  double sum = 0.0;    ///< s
  double least = 0.0;  ///< s; 0 if there is none
  double most = 0.0;   ///< s
  /// s: bin i counts times from i * bin to (i + 1) * bin. It is doubled if a time is beyond the last bin.
  double bin = 0.0;
  std::array<std::uint64_t, bin_count> bins{};

  /// `first_bin`: the width of a bin at the start, > 0. `number`: of particles. Precondition: seconds >= 0.
  void add(double seconds, double first_bin, std::uint64_t number = 1);
  [[nodiscard]] double mean() const { return count == 0 ? 0.0 : sum / static_cast<double>(count); }
  /// The washout curve: the share of times that bin i and later ones count; 0 if there is none. Precondition: i < bin_count.
  [[nodiscard]] double washout(std::size_t i) const;

  bool operator==(const ResidenceTimes&) const = default;
};

// The statistics that a simulation keeps.

/// The names of quantities that are kept by cell (dartcast/cell_tally.hpp): "track_length" (m), "residence" (s), "visits",
/// "deposition" (particles that were absorbed or have stuck at a wall of the cell), "concentration" (the mean number of
/// particles in the cell over its volume as it is now, 1/m^3; in the plane 1/m^2) and "mean_age" (s, of the particles there,
/// at the middle of each segment of a step). Vectors are "momentum" (N s, that drag has taken from particles) and
/// "momentum_source" (the same over volume and time, N/m^3). So are "energy" (J, the work of particles against drag)
/// and "energy_source" (W/m^3). A particle's mass is that of its diameter and density, or with collisions of its sphere; else
/// 0. Drag is that of the constant drag, of forces and of a law. Random kicks are not in it.
std::vector<std::string> cell_quantities();
/// Throws InvalidArgument if a name is none of these, nor "user:" and a name, or is there twice.
void check_cell_quantities(std::span<const std::string> names);

/// In StatisticsOptions::classes_of: the user data with this name, which a scene gives the place of the particle's group
/// (ParticlesScene). There is a class for each group if there are no bounds.
inline constexpr const char* group_number = "group";

/// The statistics that a simulation keeps. A particle that stands for several (SimulationOptions::user_data) counts as so
/// many.
struct StatisticsOptions {
  bool hits = false;                          ///< of wall faces, by particles and spheres
  bool impacts = false;                       ///< with hits: the sums of Impact, too
  bool residence = false;                     ///< the times after which particles leave
  std::vector<SectionPlane> planes;           ///< crossings by particles and centres of spheres
  std::uint64_t pathlines_every = 0;          ///< pathlines of the particles whose id is a multiple of it; 0: of none
  std::vector<std::uint64_t> pathlines_of{};  ///< and of these ids
  /// Quantities by cell: some of cell_quantities(), and "user:NAME": the integral over time of this number of user data.
  std::vector<std::string> cells{};
  std::uint64_t cells_every = 0;  ///< sums by cell begin anew after so many steps; 0: never
  /// Sums by cell and residence times are also kept by class. A particle's class is the number of bounds that are at most its diameter, or its
  /// user data of this name. Empty: there are no classes.
  std::string classes_of{};
  std::vector<double> class_bounds{};  ///< they increase; at most 255

  [[nodiscard]] bool pathlines() const { return pathlines_every > 0 || !pathlines_of.empty(); }
  [[nodiscard]] bool any() const { return hits || residence || !planes.empty() || pathlines() || !cells.empty(); }
};

/// A crossing with its time. Residence times count from the start of the first step that a particle takes part in.
/// For those of inlets it is the step that injects them. Particles that are there when statistics are set start with
/// the next step.
struct PlanePassage {
  PlaneCrossing crossing;
  std::uint64_t id = 0;
  double time = 0.0;         ///< s
  double age = 0.0;          ///< s: the residence time
  std::uint64_t number = 1;  ///< of particles that it stands for
};

/// Residence times at the crossings of a plane. Their counts are the numbers of particles that cross.
struct PlaneTotals {
  ResidenceTimes forward;
  ResidenceTimes backward;

  bool operator==(const PlaneTotals&) const = default;
};

/// Residence times of particles that left at the walls of a patch, up to their last contact.
struct LeaveTotals {
  ResidenceTimes escaped;
  ResidenceTimes absorbed;

  bool operator==(const LeaveTotals&) const = default;
};

/// A point of a pathline.
struct PathPoint {
  std::uint64_t id = 0;
  double time = 0.0;  ///< s
  Vec3 position;
  /// At the ends of steps the particle's own. At a contact the mean velocity from the point before to this one; 0 if
  /// no time has passed.
  Vec3 velocity;
  bool contact = false;

  bool operator==(const PathPoint&) const = default;
};

/// The statistics of a simulation so far. Edits move no particle over a plane: they change positions between steps.
struct Statistics {
  WallHits hits;
  std::vector<PlaneTotals> planes;         ///< by plane
  std::vector<LeaveTotals> left;           ///< by the number of the patch; empty without StatisticsOptions::residence
  std::vector<LeaveTotals> left_by_class;  ///< with classes: `left` of class 0, then of class 1, ...
  ResidenceTimes absorbed_by_edits;        ///< up to the edit

  // These are of the last step alone. A checkpoint does not hold them.
  std::vector<PlanePassage> passages;  ///< as find_crossings() orders them
  /// By particle, then by time: the start of those in their first step; each contact; the end of the step, unless the
  /// particle left.
  std::vector<PathPoint> path_points;

  double seconds = 0.0;  ///< of computing, spent on all of these
};

}  // namespace dartcast
