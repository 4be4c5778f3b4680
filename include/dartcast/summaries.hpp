// Summaries of the bodies, catheters and solids of a simulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "dartcast/bodies.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// The state of a body, and sums over its steps.
struct BodySummary {
  std::string name;
  std::size_t particles = 0;
  bool gone = false;  ///< it left at a wall; the fields below then say nothing
  Vec3 centre;
  BodyEnergy energy;
};

/// Over all steps so far.
struct CatheterTotals {
  double worst_segment = 0.0;  ///< largest relative error of a segment's length
  double refused = 0.0;        ///< m of pushes and pulls that there was no way for
};

/// The state of a catheter, and sums over its steps.
struct CatheterSummary {
  std::string name;
  double inserted = 0.0;         ///< m
  double measured_length = 0.0;  ///< of the part in the lumen, m
  CatheterTotals totals;
  Vec3 tip;
};

/// The state of a solid of a scene, and sums over its steps.
struct SolidSummary {
  std::string name;
  std::size_t vertices = 0;
  Vec3 pivot;                  ///< now
  std::uint64_t contacts = 0;  ///< that changed its motion
  std::uint64_t stopped = 0;   ///< steps that it did not make in full
  bool stuck = false;          ///< an edit left it no free place (SolidSet::stuck())
};

}  // namespace dartcast
