// Catheters with edges as partners of a joint move.
#pragma once

#include "dartcast/catheter.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

struct CatheterMoves {
  /// The catheter is a partner of the next joint move. Precondition: it has edges. Throws as Catheter::move_with() if it
  /// missed a move or an edit.
  static MovePartner& prepare(Catheter& catheter);
  /// Throws as Catheter::step() if it would refuse this input.
  static void check(const Catheter& catheter, const CatheterInput& input);
};

}  // namespace dartcast
