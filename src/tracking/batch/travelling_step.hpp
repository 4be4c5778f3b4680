// The step of one particle in a part of an environment: it leaves where it needs cells that another rank owns. Not installed.
#pragma once

#include <cstdint>

#include "tracking/batch/traveller.hpp"
#include "tracking/step.hpp"

namespace dartcast {

/// How far a step has come.
struct TravelResult {
  bool waits = false;  ///< at a contact, the last of the list
  bool leaves = false;
  StepResult result;  ///< where it is complete
};

/// Takes steps as Stepper does, to the same bits, as far as a rank's own cells decide them. A walk may pass ghosts; it
/// leaves where it ends in one at a wall or on its border, for the rank that knows all cells around. The rules:
///  - walks, carries and contacts start in own cells;
///  - a walk that ends strictly inside a ghost is complete, because no other cell has a say;
///  - a particle that is in a ghost at the end of its step belongs to the ghost's rank.
class TravellingStepper {
 public:
  TravellingStepper(const CellComplex& complex, const PartCells& cells, bool moved, const StepOptions& options)
      : complex_(complex), cells_(cells), moved_(moved), options_(options) {}

  /// A step from its start, up to its first contact. `partial`: of a walk that ends in an own cell, or null. Fills
  /// `pause` where it waits or leaves.
  TravelResult start(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                     ContactList& contacts, Counters& counters, const PartialStep* partial,
                     TravellingPause& pause) const;

  /// A step that has come here: `pause.traveller`. `state`: state_here() of its state. Its earlier walls are added to
  /// the list in front of a new contact's.
  TravelResult go_on(ParticleState& state, Weights& weights, ContactList& contacts, Counters& counters,
                     TravellingPause& pause) const;

  /// A step that has waited, after the answer to `contact`, which is in the list `met`.
  TravelResult answer(const ContactList& met, const Contact& contact, const AfterContact& next, ParticleState& state,
                      Weights& weights, ContactList& contacts, Counters& counters, TravellingPause& pause) const;

 private:
  template <std::size_t N>
  TravelResult start_in(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                        ContactList& contacts, Counters& counters, const PartialStep* partial,
                        TravellingPause& pause) const;
  template <std::size_t N>
  TravelResult go_on_in(ParticleState& state, Weights& weights, ContactList& contacts, Counters& counters,
                        TravellingPause& pause) const;
  template <std::size_t N>
  TravelResult answer_in(const ContactList& met, const Contact& contact, const AfterContact& next, ParticleState& state,
                         Weights& weights, ContactList& contacts, Counters& counters, TravellingPause& pause) const;

  const CellComplex& complex_;
  const PartCells& cells_;
  bool moved_;
  const StepOptions& options_;
};

}  // namespace dartcast
