// A velocity field given at the mesh's points, linear in each implicit simplex.
#pragma once

#include <span>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

enum class FieldFrame {
  space,  ///< the values are velocities in space, wherever their points have moved
  mesh    ///< the values belong to the mesh at rest: they turn and stretch with it, and it carries the flow along
};

class VelocityField {
 public:
  /// `values`: one velocity per point of the mesh; Steiner points take theirs by their weights. The complex's
  /// positions are those at rest. Throws InvalidArgument where the number does not match, a value is not
  /// finite, or in the plane its z is not 0.
  VelocityField(const CellComplex& complex, std::span<const Vec3> values, FieldFrame frame = FieldFrame::space);

  [[nodiscard]] FieldFrame frame() const { return frame_; }
  /// Velocities of all vertices, Steiner points last.
  [[nodiscard]] std::span<const Vec3> values() const { return values_; }
  /// Positions of all vertices at rest; empty in the frame of space.
  [[nodiscard]] std::span<const Vec3> rest() const { return rest_; }

  /// After an edit: new vertices take the values of those that they were made between. `complex`: as it is now.
  void update_after_edit(const ComplexEditReport& edit, const CellComplex& complex);

  /// The velocity at the point of barycentric coordinates w in a simplex with these corners now. In the mesh's frame:
  /// relative to the mesh, taken from rest by the simplex's own linear map, so that a flow along a wall stays along it.
  [[nodiscard]] Vec3 at(const CellComplex& complex, SimplexId simplex, const std::array<double, 4>& w,
                        const Corners& now) const;

 private:
  std::vector<Vec3> values_;  // of all vertices, interior ones last
  std::vector<Vec3> rest_;    // their positions at rest; in the mesh's frame only
  FieldFrame frame_;
};

}  // namespace dartcast
