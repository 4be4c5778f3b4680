// The options and the report of a step: contacts, held and stopped particles, counts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// Signs that walks ask for. `tests` counts each sign once, side tests included, whichever stage decides it. `exact`
/// counts those that the filter left open. Location, placement in a simplex and audits are not counted.
struct TestCounts {
  std::uint64_t tests = 0;
  std::uint64_t exact = 0;
};

/// Sums over particle-steps. Addition is in integers, so that the order of adding does not matter.
///
/// Tests are counted if one process has all cells. If ranks share the cells, `orientation`, `histogram`,
/// `forecast_kept` and `updated_by_deformation` are 0.
struct Counters {
  static constexpr std::size_t histogram_size = 64;

  std::uint64_t particle_steps = 0;
  TestCounts orientation;
  /// Particle-steps by their number of orientation tests. The last entry also holds all larger numbers.
  std::array<std::uint64_t, histogram_size> histogram{};
  std::uint64_t forecast_kept = 0;           ///< ended in the simplex where they began, without a contact
  std::uint64_t updated_by_deformation = 0;  ///< changed simplex, as the vertices' motion alone would have done
  std::uint64_t steps_split = 0;  ///< taken in several slices, because the vertices turned or stretched too much
  std::array<std::uint64_t, 3> contacts{};  ///< by kind: vertex, edge, face
  std::uint64_t unfinished =
      0;  ///< stopped at the last contact or crossing allowed in a step, or if the way leads out of the exact range

  Counters& operator+=(const Counters& other) {
    particle_steps += other.particle_steps;
    orientation.tests += other.orientation.tests;
    orientation.exact += other.orientation.exact;
    for (std::size_t i = 0; i < histogram_size; ++i) histogram[i] += other.histogram[i];
    forecast_kept += other.forecast_kept;
    updated_by_deformation += other.updated_by_deformation;
    steps_split += other.steps_split;
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i] += other.contacts[i];
    unfinished += other.unfinished;
    return *this;
  }
};

/// Limits of one step of a particle.
struct StepOptions {
  /// Largest number of contacts of a particle in one step, at least 1. At the last one it is asked to slide.
  unsigned max_contacts = 16;
  /// Largest error of the chord against the true motion relative to the vertices, as a share (> 0) of the local edge. A
  /// step is split into ceil(sqrt(|A| |r| / (2 tolerance edge))) slices. A is the gradient of the vertices'
  /// displacement, r is the particle's own motion.
  double tolerance = 0.05;
  /// Largest number of slices, at least 1. A step that needs more is taken in this many.
  unsigned max_slices = 256;
  /// Largest number of periodic crossings of a particle in one step, at least 1. A particle that would make more stops at
  /// the border; Counters::unfinished counts it.
  unsigned max_crossings = 1024;
};

/// Throws InvalidArgument, which names the caller and the option, if an option is out of range.
void check(const StepOptions& options, const char* caller);

/// A particle that a cell kept from its step, and why.
struct HeldParticle {
  std::uint32_t particle = 0;
  Cell cell;  ///< the invalid cell, its own or one on its path; or its own blocked cell
};

/// How the step of one particle ended.
struct StepResult {
  bool held = false;
  Cell invalid_cell;
  bool stopped = false;  ///< at a contact without a response, or before a target out of the exact range
  Vec3 unused;           ///< displacement left when it stopped, relative to the wall
};

/// A particle stopped at a contact before its target.
struct StoppedParticle {
  std::uint32_t particle = 0;
  Vec3 unused;  ///< displacement left, relative to the wall
};

/// The effects of a step of all particles.
struct StepReport {
  ContactList contacts;                  ///< by particle, then by time
  std::vector<HeldParticle> held;        ///< by particle
  std::vector<StoppedParticle> stopped;  ///< by particle
  Counters counters;
};

// Where a particle passes from cell to cell in one step.
//
// After T. Jund, D. Cazier, J.-F. Dufourd, SPM 2009, section 4.1, figures 5 and 6. A displacement is decomposed along
// the cells that it crosses, with the particle's state (its kind of cell and a dart of that cell) at each crossing.

/// A passage from one cell to another. Exact signs decide which face, edge or vertex it goes through. Time and point
/// are rounded.
///
/// If a walk turns around an edge or a vertex, passages at the same place are joined: from the first cell to the last.
/// If these are the same, there is no passage. At a face the cells are neighbours. At an edge or a vertex they share at
/// least that.
struct Crossing {
  double time = 0.0;  ///< fraction of the step, in [0, 1]; never less than that of the crossing before
  Vec3 point;         ///< on the face, edge or vertex as it is at `time`; at a vertex its position
  Cell from;
  Cell to;
  /// Kind of the place: face, edge or vertex. `volume` (in the plane `face`) means that nothing is passed. Rounding put
  /// the particle into the next cell when it met a wall or when the mesh carried it. Then `point` is its position.
  Kind kind = Kind::face;
  Dart dart;                   ///< of that face, edge or vertex, in `from`; invalid if there was no passage
  std::uint32_t contacts = 0;  ///< number of the step's contacts before it
};

/// The path of a particle to one target. Its cell goes from `before` through each crossing to `after`.
struct Trace {
  ParticleState before;
  Forecast start;  ///< of `before`: the paper's kind and dart; not used if the particle is held
  std::vector<Crossing> crossings;
  ContactList contacts;  ///< by time
  ParticleState after;   ///< the bits that Environment::advance() gives
  Forecast end;          ///< of `after`, as `start`
  StepResult result;     ///< whether it was held, or stopped at its last contact
};

}  // namespace dartcast
