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
// the cells traversed, with the particle's state (its kind of cell and a dart of that) at each crossing.

/// A passage from one cell to another. What is passed through is told by exact signs; time and point are rounded.
///
/// Passages at one and the same place are joined: where a walk turns around an edge or a vertex, from the first cell to
/// the last one; where these are the same, it has passed none. At a face the cells are neighbours, at an edge or vertex
/// they share at least that.
struct Crossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]; never less than that of the crossing before
  Vec3 point;         ///< of the face, edge or vertex, where that is at `time`; a vertex' own position
  Cell from;
  Cell to;
  /// Of the place: face, edge or vertex. `volume` (in the plane `face`): no passage. Rounding put the particle into the
  /// next cell, when it met a wall or rode along with the vertices; `point` is its position then.
  Kind kind = Kind::face;
  Dart dart;                   ///< of that face, edge or vertex, in `from`; invalid where there was no passage
  std::uint32_t contacts = 0;  ///< number of the step's contacts before it
};

/// What a particle does on its way to one target. Its cell goes from `before` through each crossing to `after`.
struct Trace {
  ParticleState before;
  Forecast start;  ///< of `before`: the paper's kind and dart; of no meaning where it is held
  std::vector<Crossing> crossings;
  ContactList contacts;  ///< by time
  ParticleState after;   ///< the bits that Environment::advance() gives
  Forecast end;          ///< of `after`, as `start`
  StepResult result;     ///< whether it was held, or stopped at its last contact
};

}  // namespace dartcast
