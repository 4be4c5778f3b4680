// Events: edits of the topology at given times, and subdivision of crowded cells, while a simulation runs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast {

// Cells that hold many particles are subdivided. The parts are merged again when the particles have left.
//
// "Subdivisions": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision
// detection in deformable environments", SPM 2009, section 7.3.

/// When cells are subdivided for the sake of speed, and merged again.
struct AdaptiveSubdivisionOptions {
  std::uint32_t max_particles = 32;  ///< particles in a cell, above which it is subdivided
  std::uint32_t min_particles = 8;   ///< particles in all parts of a cell, below which they are merged; < max_particles
  double smallest = 0.0;     ///< m: a cell is not subdivided if it is less than twice this across, along an axis
  std::uint32_t edits = 64;  ///< of either kind in one call at most, the fullest cells first
};

/// A cell that was left as it is, and why.
struct SubdivisionRefusal {
  Cell cell;  ///< to be subdivided; or a part of one that was to be merged
  std::uint32_t particles = 0;
  std::string reason;
};

/// An edit that was made, to make it again.
struct SubdivisionChange {
  bool merged = false;
  std::uint32_t what = 0;  ///< the number of the cell that was subdivided, or the subdivision's place in the list
};

/// The effects of one call.
struct AdaptiveSubdivisionReport {
  std::uint64_t subdivided = 0;
  std::uint64_t merged = 0;
  /// Cells that are still above the threshold because the number of edits was reached.
  std::uint64_t waiting = 0;
  std::vector<SubdivisionRefusal> refused;
  std::vector<SubdivisionChange> changes;  ///< in order
};

/// The kind of change that an event makes.
enum class EventKind : std::uint32_t { cut, carve, ligature, reconnect, open, close };
/// The name of a kind in scenes, such as "cut".
[[nodiscard]] std::string_view name_of(EventKind kind);

/// Opens tissue along a surface (dartcast/cutting.hpp).
struct Cut {
  static constexpr EventKind kind = EventKind::cut;
  std::variant<Plane, Disc, BladePath> surface;
  double width = 0.0;  ///< m
};

/// Frees or takes away what lies in a tool.
struct Carve {
  static constexpr EventKind kind = EventKind::carve;
  ConvexTool tool;
  Carving what = Carving::open;
  bool whole_cells = false;
};

/// Blocks a cross-section, and draws its walls together (dartcast/cutting.hpp).
struct Ligature {
  static constexpr EventKind kind = EventKind::ligature;
  Plane plane;
  Vec3 place;
  TyingOptions tying = {0.0, 1.0};  ///< share 0: walls stay where they are
  double duration = 0.0;            ///< s: the walls take so long; > 0 if they are drawn
};

/// Joins two ends: the open faces within a distance of two planes (dartcast/cutting.hpp).
struct Reconnect {
  static constexpr EventKind kind = EventKind::reconnect;
  Plane a, b;
  double within = 0.0;  ///< m
  ReconnectOptions options;
};

/// Frees cells that are blocked, such as those of a valve that opens. `cells`: their numbers in the mesh
/// (cells_of_region()); if an edit has replaced one, its parts. Cells that are free already stay so, and a number
/// that no cell has changes nothing. Cost: linear in the cells of the scene.
struct OpenCells {
  static constexpr EventKind kind = EventKind::open;
  std::vector<std::uint32_t> cells;
};

/// Blocks cells that are free, such as those of a valve that closes. `cells`: as for OpenCells.
struct CloseCells {
  static constexpr EventKind kind = EventKind::close;
  std::vector<std::uint32_t> cells;
};

/// Opens the walls of a patch that have a cell on both sides (inner_walls()). Refused if it has none. Cost: n log n in the
/// open faces.
struct OpenWalls {
  static constexpr EventKind kind = EventKind::open;
  Patch patch;
};

/// Makes walls of a patch's faces between two cells, as a valve of no thickness does. Refused if it has none. Cost: linear
/// in the cells of the scene.
struct CloseWalls {
  static constexpr EventKind kind = EventKind::close;
  Patch patch;
};

/// A change of the topology at a time.
struct Event {
  double at = 0.0;  ///< s: before the first step that begins at this time or later
  std::variant<Cut, Carve, Ligature, Reconnect, OpenCells, CloseCells, OpenWalls, CloseWalls> what;
  OrphanPolicy orphaned = OrphanPolicy::relocate;
  bool required = false;  ///< whether a simulation ends if it is refused (EditRefused); else it goes on as it was
};
/// The kind of an event.
[[nodiscard]] EventKind kind_of(const Event& event);

/// The effects of one event.
struct EventReport {
  EventKind kind = EventKind::cut;
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
  std::uint64_t particles_moved = 0;  ///< of the orphaned ones: moved, held or absorbed
  std::uint64_t particles_held = 0;
  std::uint64_t particles_absorbed = 0;
  double boundary_shift = 0.0;  ///< m
  double seconds = 0.0;
  std::string refused;  ///< why it was refused, and nothing was changed; empty: it was carried out
};

/// The changes of the topology by events, remeshing and subdivision, in order. The log is enough to repeat them.
struct EventLog {
  /// One change, with all that is needed to repeat it.
  struct Change {
    static constexpr std::uint32_t remeshing = 0xffffffffU;
    static constexpr std::uint32_t subdividing = 0xfffffffeU;
    static constexpr std::uint32_t merging = 0xfffffffdU;

    std::uint64_t step = 0;           ///< steps done before it
    std::uint32_t event = remeshing;  ///< its place in the list of events, or one of the constants above
    std::uint32_t what = 0;           ///< SubdivisionChange::what

    bool operator==(const Change&) const = default;
  };

  std::vector<Change> changes;
  std::vector<EventReport> events;
  std::uint64_t mended = 0;      ///< regions remeshed
  std::uint64_t left = 0;        ///< cells not valid after the last check
  std::uint64_t subdivided = 0;  ///< crowded cells
  std::uint64_t merged = 0;      ///< of these, merged again
  std::uint64_t refused = 0;     ///< cells that could not be subdivided or merged at the last try
  std::uint64_t in_opened = 0;   ///< particles in cells that were blocked when the simulation was made
};

/// Carries an event out now, wherever the vertices are. Throws as the functions of dartcast/cutting.hpp and
/// Simulation::edit(); nothing is changed then. Throws EditRefused, too, if a ligature's plane crosses no free cell, or
/// an end to reconnect has no open face. An earlier event may be the reason. Walls that are drawn together go so far
/// that every simplex stays positive, if they cannot go all the way.
EventReport apply(Simulation& simulation, const Event& event);

}  // namespace dartcast
