// The step of one particle, cut where it passes from cell to cell: Environment::trace().
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

// Where a particle passes from cell to cell in one step.
//
// After T. Jund, D. Cazier, J.-F. Dufourd, SPM 2009, section 4.1, figures 5 and 6: a displacement is decomposed along
// the cells that it crosses, with the particle's state (its kind of cell and a dart of that cell) at each crossing.

/// A passage from one cell to another. Exact signs decide which face, edge or vertex it goes through. Time and point
/// are rounded.
///
/// Where a walk turns around an edge or a vertex, passages at the same place are joined to one, from the first cell to
/// the last. If these are the same, there is no passage. At a face the cells are neighbours. At an edge or a vertex
/// they share at least that.
struct Crossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]; never less than that of the crossing before
  Vec3 point;         ///< on the face, edge or vertex as it is at `time`; at a vertex its position
  Cell from;
  Cell to;
  /// Kind of the place: face, edge or vertex. `volume` (in the plane `face`) means that nothing is passed. Rounding put
  /// the particle into the next cell when it met a wall or when the mesh carried it. Then `point` is its position.
  Kind kind = Kind::face;
  Dart dart;                   ///< of that face, edge or vertex, in `from`; invalid where there was no passage
  std::uint32_t contacts = 0;  ///< number of the step's contacts before it
};

/// The path of a particle to one target. Its cell goes from `before` through each crossing to `after`.
struct Trace {
  ParticleState before;
  Forecast start;  ///< of `before`: the paper's kind and dart; not used where the particle is held
  std::vector<Crossing> crossings;
  ContactList contacts;  ///< by time
  ParticleState after;   ///< the bits that Environment::advance() gives
  Forecast end;          ///< of `after`, as `start`
  StepResult result;     ///< whether it was held, or stopped at its last contact
};

}  // namespace dartcast
