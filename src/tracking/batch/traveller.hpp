// A particle in the middle of a step that goes on in another part of the environment. Not installed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "parts/part_cells.hpp"
#include "tracking/step.hpp"

namespace dartcast {

/// A state whose cells have their handles in the whole environment, and the same with those of a part; cells that the
/// part does not have are invalid then.
ParticleState whole_state(const PartCells& cells, ParticleState state);
ParticleState state_here(const PartCells& cells, ParticleState state);

/// Where a step goes on.
enum class TravelStage : std::uint8_t {
  walk,    ///< it walks from the particle's place to the target
  on_way,  ///< the walk has come to a simplex that this rank does not own: it passes a facet, or has ended there
  carry,   ///< the next part of a step of several begins: the vertices carry the particle along
  done     ///< the step is complete; the particle has come to a cell of another rank
};

/// The triangle of a wall that was met earlier in the step, where its vertices were before they moved and after; in the
/// plane an edge.
struct CarriedWall {
  WallHit hit;
  std::array<Vec3, 3> before;
  std::array<Vec3, 3> now;
};

/// The corners opposite to the facets that a walk's start lies on: they break ties (tracking/walk.hpp).
struct TieCorners {
  std::array<Vec3, 3> corner;
  std::uint8_t count = 0;
};

/// All that a step needs to go on, beside the data that users of the particle keep. Cells are named by their handles in
/// the whole environment.
struct Traveller {
  TravelStage stage = TravelStage::done;
  std::uint32_t particle = 0;  ///< in the set that it leaves, or has come to
  std::uint32_t to = 0;        ///< rank
  std::uint32_t home = 0;      ///< the rank of the state's cell
  std::uint32_t met = 0;       ///< contacts that the particle has had in this step as `particle`
  ParticleState state;         ///< of the last contact, of the last part, or of the start
  Weights weights{};
  StepResult result;
  std::uint32_t contact_count = 0;
  std::uint32_t together = 0;  ///< walls met at the place of the last contact
  double last_time = -1.0;     ///< of that
  TimeInterval interval{0.0, 1.0, {}};
  std::uint32_t part = 1;
  std::uint32_t parts = 1;
  Vec3 target;       ///< of the walk
  Vec3 step_target;  ///< of the whole step
  Walk walk;         ///< on_way: as far as it has come
  bool restarted = false;
  TieCorners ties;
  std::vector<CarriedWall> walls;  ///< met earlier in this step, oldest first
};

class ByteReader;
class ByteWriter;

/// A traveller as bytes of this machine's kind. `particle`, `to` and `met` do not travel; `weights`
/// do where the particle is held: else a step makes them anew.
void pack(const Traveller& traveller, ByteWriter& out);
/// `traveller`: a new one.
void unpack(ByteReader& in, Traveller& traveller);

/// A step that waits for an answer to a contact, with what it has brought along.
struct TravellingPause {
  PausedStep step;
  std::size_t contact = 0;  ///< its place in the list
  Traveller traveller;
};

}  // namespace dartcast
