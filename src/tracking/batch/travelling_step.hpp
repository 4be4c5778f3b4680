// One particle's step in a part of an environment: it leaves if it needs cells that another rank owns. Not installed.
#pragma once

#include "tracking/batch/traveller.hpp"
#include "tracking/step.hpp"

namespace dartcast {

/// Takes steps in space as Stepper does, to the same bits, as far as a rank's own cells decide them. A walk may pass
/// ghosts. If it ends in one at a wall or on its border, it leaves for the rank that knows all cells around. The rules:
///  - walks, carries and contacts start in own cells;
///  - a walk that ends strictly inside a ghost is complete, because no other cell has a say;
///  - a particle that is in a ghost at the end of its step belongs to the ghost's rank.
///
/// The stage of the traveller's step says how far it has come. It waits at a contact, the last of the list; it is done;
/// or it leaves, and `to` is set.
class TravellingStepper {
 public:
  TravellingStepper(const CellComplex& complex, const PartCells& cells, bool moved, const StepOptions& options);

  /// A step that begins, or that has come here: `particle.state` is state_here() of its state then. Its earlier walls are
  /// added to the list in front of a new contact's. A batch's walk must end in an own cell.
  void run(Traveller& traveller, const SteppedParticle& particle) const;

  /// A step that has waited, after the answer to `contact`, which is in the list `met`.
  void answer(const ContactList& met, const Contact& contact, const AfterContact& next, Traveller& traveller,
              const SteppedParticle& particle) const;

 private:
  StepSetting setting_;
  const PartCells& cells_;
};

}  // namespace dartcast
