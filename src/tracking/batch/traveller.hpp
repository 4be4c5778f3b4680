// A particle in the middle of a step that goes on in another part of the environment. Not installed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "parts/part_cells.hpp"
#include "tracking/step_state.hpp"

namespace dartcast {

/// A state whose cells have their handles in the whole environment, and the same with those of a part. There, cells
/// that the part does not have are invalid.
ParticleState whole_state(const PartCells& cells, ParticleState state);
ParticleState state_here(const PartCells& cells, ParticleState state);

/// The triangle of a wall that was met earlier in the step, where its vertices were before they moved and after.
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

/// All that a step needs to go on, beside the data that users of the particle keep. While it travels, cells are named by
/// their handles in the whole environment, and walls are counted from the first one of the particle.
struct Traveller {
  StepState step;           ///< its particle is in the set that it leaves, or has come to
  std::uint32_t to = 0;     ///< rank
  std::uint32_t home = 0;   ///< the rank of the state's cell
  std::uint32_t met = 0;    ///< contacts that the particle has had in this step in this set
  std::size_t contact = 0;  ///< where it waits: the contact's place in the list
  ParticleState state;      ///< of the last contact, of the last slice, or of the start
  Weights weights{};
  bool restarted = false;  ///< on_way: the walk has begun anew, on the other side of a wall that its start lies on
  TieCorners ties;         ///< on_way
  std::vector<CarriedWall> walls;  ///< met earlier in this step, oldest first
};

class ByteReader;
class ByteWriter;

/// A traveller as bytes of this machine's kind. The numbers of its particle, `to`, `met` and `contact` do not travel;
/// `weights` do if the particle is held: else a step makes them anew.
void pack(const Traveller& traveller, ByteWriter& out);
/// `traveller`: a new one.
void unpack(ByteReader& in, Traveller& traveller);

}  // namespace dartcast
