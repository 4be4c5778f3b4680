// Surgery at given times: what a scene does to the topology while it runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "dartcast/cutting.hpp"
#include "dartcast/simulation.hpp"
#include "editing/ligature.hpp"
#include "editing/reconnect.hpp"

namespace dartcast {

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

/// Blocks a cross-section, and draws its walls together (editing/ligature.hpp).
struct Ligature {
  Plane plane;
  Vec3 place;
  TyingOptions tying = {0.0, 1.0};  ///< share 0: walls stay where they are
  double duration = 0.0;            ///< s: the walls take so long; > 0 where they are drawn
};

/// Joins two ends: the open faces within a distance of two planes (editing/reconnect.hpp).
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
