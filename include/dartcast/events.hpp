// Surgery at given times: what a scene does to the topology while it runs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/simulation.hpp"
#include "dynamics/cell_lists.hpp"

namespace dartcast {

// Cells that hold many particles are subdivided, and made again when these have left.
//
// "Subdivisions": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 7.3.

struct AdaptiveSubdivisionOptions {
  std::uint32_t max_particles = 32;  ///< particles in a cell, above which it is subdivided
  std::uint32_t min_particles = 8;   ///< particles in all parts of a cell, below which it is made again; < most
  double smallest = 0.0;     ///< m: a cell is not subdivided if it is less than twice this across, along an axis
  std::uint32_t edits = 64;  ///< of either kind in one call at most, the fullest cells first
};

/// A cell that was left as it is, and why.
struct SubdivisionRefusal {
  Cell cell;  ///< to be subdivided; of one to be made again a part
  std::uint32_t particles = 0;
  std::string reason;
};

/// An edit that was made, to make it again.
struct SubdivisionChange {
  bool merged = false;
  std::uint32_t what = 0;  ///< the number of the cell that was subdivided, or the subdivision's place in the list
};

struct AdaptiveSubdivisionReport {
  std::uint64_t subdivided = 0;
  std::uint64_t merged = 0;
  std::uint64_t waiting =
      0;  ///< cells above the threshold still that were not refused: the number of edits was reached
  std::vector<SubdivisionRefusal> refused;
  std::vector<SubdivisionChange> changes;  ///< in order
};

/// Keeps the subdivisions that it has made.
class AdaptiveSubdivision {
 public:
  /// Throws InvalidArgument where least >= most, or smallest is negative or not finite.
  explicit AdaptiveSubdivision(const AdaptiveSubdivisionOptions& options);

  /// Makes an edit of the environment and takes its particles along: Simulation::edit(), or Environment::edit() and
  /// update_after_edit(). Returns what Environment::edit() returned.
  using Edit = std::function<ComplexEditReport(const std::function<void(ComplexEdit&)>& make)>;

  /// Subdivides where a cell holds too many, then makes cells again whose parts hold few enough: each by an edit of its
  /// own. What cannot be done is left as it is, and told. `particles`: those that `edit` takes along. Throws what
  /// `edit` throws but EditRefused. Cost: for each edit linear in the particles and subdivisions, and that of the edit.
  AdaptiveSubdivisionReport adapt(const CellComplex& complex, const Particles& particles, const Edit& edit);

  /// Makes an edit again, where all before it have been made again. Throws EditRefused, or InvalidArgument where there
  /// is no such cell or subdivision.
  void repeat(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit);

  /// To be called after other edits of the environment. Cost: that of dartcast::update_after_edit() for each
  /// subdivision there is.
  void update_after_edit(const CombinatorialMap& map, std::span<const Cell> added);

  /// What is subdivided now, parents before what is in their parts.
  [[nodiscard]] std::span<const Subdivision> subdivisions() const { return subdivisions_; }

 private:
  struct Fullest {
    Cell cell;
    std::uint32_t particles = 0;
    std::uint64_t others = 0;  // above the threshold, too
  };

  [[nodiscard]] Fullest fullest(const Particles& particles) const;
  void subdivide_fullest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                         AdaptiveSubdivisionReport& report);
  void merge_emptiest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                      AdaptiveSubdivisionReport& report);
  [[nodiscard]] bool is_whole(const CombinatorialMap& map, std::size_t subdivision) const;
  void make(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit);
  bool try_edit(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit,
                SubdivisionRefusal refusal, AdaptiveSubdivisionReport& report);

  AdaptiveSubdivisionOptions options_;
  CellLists lists_;
  std::vector<Subdivision> subdivisions_;
  std::vector<Cell> passed_over_;  // in this call
};

/// Opens tissue along a surface (dartcast/cutting.hpp).
struct Cut {
  std::variant<Plane, Disc, BladePath> surface;
  double width = 0.0;  ///< m
};

/// Frees or takes away what lies in a tool.
struct Carve {
  ConvexTool tool;
  Carving what = Carving::open;
  bool whole_cells = false;
};

/// Blocks a cross-section, and draws its walls together (dartcast/cutting.hpp).
struct Ligature {
  Plane plane;
  Vec3 place;
  TyingOptions tying = {0.0, 1.0};  ///< share 0: walls stay where they are
  double duration = 0.0;            ///< s: the walls take so long; > 0 where they are drawn
};

/// Joins two ends: the open faces within a distance of two planes (dartcast/cutting.hpp).
struct Reconnect {
  Plane a, b;
  double within = 0.0;  ///< m
  ReconnectOptions options;
};

struct Event {
  double at = 0.0;  ///< s: before the first step that begins at this time or later
  std::variant<Cut, Carve, Ligature, Reconnect> what;
  OrphanPolicy orphaned = OrphanPolicy::relocate;
};
inline constexpr std::string_view event_kind_names[] = {"cut", "carve", "ligature", "reconnect"};

/// What an event did.
struct EventReport {
  std::uint32_t kind = 0;  ///< of event_kind_names
  std::uint64_t step = 0;  ///< steps done before it
  double time = 0.0;       ///< s
  std::uint64_t cells_removed = 0;
  std::uint64_t cells_added = 0;
  std::uint64_t cells_opened = 0;  ///< freed
  std::uint64_t cells_blocked = 0;
  std::uint64_t cells_whole = 0;          ///< that a cut could not split: see Carved
  std::uint64_t particles_in_opened = 0;  ///< before it: see EventLog::in_opened
  std::uint64_t particles_touched = 0;
  std::uint64_t particles_located = 0;
  std::uint64_t particles_moved = 0;  ///< of the stranded ones: moved, held or absorbed
  std::uint64_t particles_held = 0;
  std::uint64_t particles_absorbed = 0;
  double boundary_shift = 0.0;  ///< m
  double seconds = 0.0;
};

/// Does it now, wherever the vertices are. Throws as the functions of surgery/ and Simulation::edit(); nothing is
/// changed then. Walls that are drawn together go so far that every simplex stays positive, if they cannot go all the
/// way.
EventReport apply(Simulation& flow, const Event& event);

}  // namespace dartcast
