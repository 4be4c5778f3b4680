// The constraint of a contact on the targets of a solid: a distance from the wall along a normal.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "solids/element_touches.hpp"

namespace dartcast {

/// normal . (sum of weights times targets - wall_point) >= separation.
struct SolidConstraint {
  ElementTouch touch;
  std::array<double, 3> weights{};       ///< of the solid's vertices at the place, at the time of the touch
  std::array<double, 3> wall_weights{};  ///< of the wall's corners that take part
  Vec3 normal;                           ///< unit, to the side of the solid at the start; 0: the place has none
  Vec3 wall_point;                       ///< at the end of the step
  double separation = 0.0;
  double pressed = 0.0;  ///< sum of the corrections
  unsigned slice = 0;    ///< of the step, in which the touch is
  /// The way leaves the wall here: it has entered it at an earlier touch, and a correction would keep it in.
  bool is_exit = false;
  bool is_apart = false;  ///< they came near each other, but do not touch
};

/// `longest`: the longest side of the solid; 0 if it has none.
SolidConstraint constraint_of(const ElementTouch& touch, const SolidMotion& motion, double separation, double longest);

/// How much the targets lack.
double gap_of(const SolidConstraint& c, std::span<const Vec3> targets);

/// Corrects the targets, so that the constraint holds by itself. Vertices move by their inverse masses.
void satisfy(SolidConstraint& c, std::span<Vec3> targets, std::span<const double> inverse_masses);

/// The contact, with vertices as they are numbered in the motion, which ends at the targets of the caller. The step ends at
/// `reached`, and when the walls have made this share of their way.
SolidContact contact_of(const SolidConstraint& c, const CombinatorialMap& map, const SolidMotion& motion,
                        std::span<const Vec3> reached, double walls_made);

}  // namespace dartcast
