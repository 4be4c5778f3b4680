// Whether a process shares its work. Not installed.
#pragma once

#include "dartcast/ranks.hpp"

namespace dartcast {

/// Whether there is somebody to share with. None, and one rank, are a process alone.
inline bool are_several(const Ranks* ranks) { return ranks != nullptr && ranks->size() > 1; }

}  // namespace dartcast
