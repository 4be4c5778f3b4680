// Bodies with edges as partners of a joint move.
#pragma once

#include "dartcast/bodies.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

struct BodiesMoves {
  /// The surfaces of the bodies are a partner of the next joint move; null if there are none. Throws as
  /// Bodies::move_with() if they missed a move or an edit.
  static MovePartner* prepare(Bodies& bodies);
};

}  // namespace dartcast
