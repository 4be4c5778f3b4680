// A field of vectors (velocities, accelerations) given at the points or cells of a mesh, at one time or several.
//
// In space it is linear in each implicit simplex, or constant in each cell. In time it is interpolated between samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/threads.hpp"

namespace dartcast {

/// Whether values stay in space or follow the mesh.
enum class FieldFrame : std::uint8_t {
  space,  ///< the values are vectors in space, wherever their points have moved
  mesh    ///< the values belong to the mesh at rest: they turn and stretch with it, and it carries the flow along
};

/// Where the values are given.
enum class FieldPlace : std::uint8_t {
  points,  ///< linear between points; Steiner points take their values by their weights
  cells    ///< constant in each cell, with a jump from cell to cell; never averaged
};

/// How values between samples at increasing times follow from these: those of a field, or frames of a deformation.
enum class Interpolation : std::uint8_t {
  linear,  ///< from the two samples around the time: rates jump at each sample
  cubic    ///< from four: a cubic in time between two samples, with rates that do not jump (Catmull-Rom's tangents, for
           ///< unequal distances). Exact for values that are quadratic in time.
};

/// The values of a field at increasing times.
struct FieldSamples {
  std::string name = "the field";  ///< in messages
  FieldPlace place = FieldPlace::points;
  std::vector<double> times = {0.0};  ///< s, increasing; a single one: the field is steady
  /// The values at times[k]: one per point of the mesh, or one per cell in the order of the mesh (increasing
  /// CombinatorialMap::source()). It may read a file; it is called when a step needs the sample, from one thread at a
  /// time.
  std::function<std::vector<Vec3>(std::size_t k)> read;
  /// 0: before the first time the field is as at the first, after the last time as at the last. Above 0, s: the field
  /// repeats, and is at times[0] + period as at times[0]. Not less than the time from the first to the last. With just
  /// that, the last sample should be the first one again.
  double period = 0.0;
  Interpolation interpolation = Interpolation::linear;
  bool vectors = true;  ///< false: any three numbers, which in the plane may have a z
};

/// An array of any number of components at points or cells. Each of the samples has three of them, in their order.
/// Zeros follow the last component.
struct ArraySamples {
  std::string name;
  std::size_t components = 1;
  std::vector<FieldSamples> parts;
};

/// Samples in memory, one list of values for each time.
FieldSamples field_samples(std::vector<double> times, std::vector<std::vector<Vec3>> values,
                           FieldPlace place = FieldPlace::points, double period = 0.0);

class SampleTimes;

/// A vector field on a complex: at points or in cells, steady or at several times.
class VectorField {
 public:
  /// A steady field at the points. The complex's positions are those at rest. Throws InvalidArgument if the number
  /// does not match, a value is not finite, or in the plane its z is not 0.
  VectorField(const CellComplex& complex, std::span<const Vec3> values, FieldFrame frame = FieldFrame::space);
  /// The complex has not been edited. Reads the first sample and stands at its time. Throws as above and as the samples'
  /// read(), and if a time, the period or read is not as FieldSamples says.
  VectorField(const CellComplex& complex, FieldSamples samples, FieldFrame frame = FieldFrame::space);

  [[nodiscard]] FieldFrame frame() const { return frame_; }
  [[nodiscard]] FieldPlace place() const { return samples_.place; }
  [[nodiscard]] bool steady() const { return samples_.times.size() == 1; }
  /// The vectors at the `moment`-th of the times set: of all vertices, Steiner points last, or one for each source of a
  /// cell.
  [[nodiscard]] std::span<const Vec3> values(std::size_t moment = 0) const { return values_[steady() ? 0 : moment]; }
  /// Positions of all vertices at rest; empty in the frame of space.
  [[nodiscard]] std::span<const Vec3> rest() const { return rest_; }

  /// Reads the samples that times from `begin` to `end` (s) need, and forgets all others: two or three if steps are
  /// shorter than the samples' distances. Throws as the constructor, nothing changed.
  void hold(double begin, double end);
  /// Sets the values at these times, for at(). They are computed once for all particles. The cost is linear in the
  /// points or cells, and nothing if the field is steady or stands at these times already. Samples that are not held
  /// are read. `complex`: as it is now. The same bits for any number of threads.
  void set_times(std::span<const double> times, const CellComplex& complex, Threads threads = {});

  /// Follows an edit. New vertices take the values of those between which they were made, new cells those of the cells
  /// from which they were made. `complex`: as it is now. If the field is not steady, call set_times() before at().
  void update_after_edit(const ComplexEditReport& edit, const CellComplex& complex);

  /// The vector at the point of barycentric coordinates w in a simplex with these corners now, at the `moment`-th of
  /// the times set. In the mesh's frame it is relative to the mesh. The simplex's own linear map takes it there from
  /// rest, so that a flow along a wall stays along it.
  [[nodiscard]] Vec3 at(const CellComplex& complex, SimplexId simplex, const std::array<double, 4>& w,
                        const Corners& now, std::size_t moment = 0) const;

 private:
  [[nodiscard]] std::vector<std::size_t> needed(double begin, double end) const;
  [[nodiscard]] std::vector<Vec3> read(std::size_t k) const;
  void check(std::size_t k, std::span<const Vec3> values) const;
  const std::vector<Vec3>& sample(std::size_t k);
  void find_rows(const CellComplex& complex);
  void spread(const CellComplex& complex, std::vector<Vec3>& values) const;

  FieldSamples samples_;
  std::shared_ptr<const SampleTimes> times_of_samples_;
  FieldFrame frame_;
  std::size_t count_ = 0;  // of a sample's values
  bool plane_ = false;
  std::map<std::size_t, std::vector<Vec3>> held_;  // by number of sample; if the field is steady: none
  std::vector<double> times_;                      // those set; none after an edit
  std::vector<std::vector<Vec3>> values_;  // at these times; of all vertices, Steiner points included, or by row
  std::vector<std::uint32_t> row_;         // cells: the value of a source
  ComplexEditReport later_;                // points: all vertices that edits have placed
  std::vector<Vec3> rest_;                 // of all vertices; in the mesh's frame only
};

/// In m / s.
using VelocityField = VectorField;

}  // namespace dartcast
