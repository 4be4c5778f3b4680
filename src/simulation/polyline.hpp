// Steps along polylines: the paper's interpolated trajectories, several straight segments in one step.
#pragma once

#include <cstddef>

#include "dartcast/step.hpp"

namespace dartcast {

/// Joins the report of segment `index` of `segments` equal ones to those before it: contacts by particle, then by time.
/// Times of impact become fractions of the whole step.
void append_segment(StepReport& report, StepReport segment, std::size_t index, std::size_t segments);

}  // namespace dartcast
