// What a run came to: summary.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "mesh/mesh_report.hpp"
#include "simulation/event_scheduler.hpp"
#include "simulation/solids.hpp"

namespace dartcast {

struct Summary {
  std::string scene;
  unsigned threads = 1;
  std::uint64_t steps = 0;
  bool deforms = false;

  std::size_t cells = 0;
  std::size_t free_cells = 0;
  std::size_t vertices = 0;
  std::size_t wall_faces = 0;
  std::size_t bytes = 0;
  Finding skipped;  ///< bad cells that were left out

  SimulationTotals totals;
  std::uint64_t alive = 0;
  std::uint64_t held = 0;  ///< at the end
  std::uint64_t lost = 0;
  std::vector<std::string> patch_names;
  double seconds_load = 0.0;
  double seconds_locate = 0.0;
  double seconds_solids = 0.0;  ///< steps of bodies and catheters
  double seconds_write = 0.0;
  std::optional<EventLog> surgery;  ///< where the scene has events or is remeshed
  std::vector<BodySummary> bodies;
  std::vector<CatheterSummary> catheters;
  std::optional<Audit> audit;
  std::string state_hash;
};

/// One JSON object, as the interface says; what has no meaning in this run is left out.
std::string summary_json(const Summary& summary);

/// The same for people, in a few lines.
std::string summary_text(const Summary& summary);

/// The histogram of orientation tests, a line per number of tests.
std::string histogram_text(const Summary& summary);

/// The library's version, "0.1.0".
std::string version();

}  // namespace dartcast
