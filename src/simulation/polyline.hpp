// Particles along polylines: the paper's interpolated trajectories, several straight segments in one step.
#pragma once

#include <span>

#include "dartcast/environment.hpp"

namespace dartcast {

/// Advances each particle through `segments` points in one step; particle i's are targets[i * segments .. (i + 1) *
/// segments). After a move() all the vertices' motion belongs to the first segment; the others run in the geometry
/// after it.
///
/// Targets after a particle's first contact no longer say where it wants to go: `respond` decides the rest of that
/// segment, the further points are left out, and the particle is reported as stopped (unused: from the last point
/// reached to the last target). Times of impact are fractions of the whole step. A particle counts as one particle-step
/// per segment. Throws as Environment::advance(), before anything is changed.
StepReport advance_polyline(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                            std::size_t segments, const ContactCallback& respond = {}, const StepOptions& options = {});

/// Joins the report of segment `index` of `segments` equal ones to those before it: contacts by particle, then by time.
void append_segment(StepReport& report, StepReport segment, std::size_t index, std::size_t segments);

}  // namespace dartcast
