// Splits cells by a plane, as a single section.
#include <cmath>
#include <numeric>

#include "base/elementary.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "editing/cutter.hpp"

namespace dartcast {

Plane plane_through(const Vec3& point, const Vec3& normal) {
  const double length = hypotenuse(normal.x, normal.y, normal.z);
  if (!is_finite(point) || !std::isfinite(length) || !(length > 0.0))
    throw InvalidArgument("a plane needs a finite point and a finite normal that is not zero");
  const Vec3 unit = {normal.x / length, normal.y / length, normal.z / length};
  return {unit, dot(unit, point)};
}

Section split_by_plane(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane,
                       const SectionOptions& options) {
  detail::check_snap(options.snap);
  return detail::cut_with_division(edit, cells, options.snap, {}, [&](const std::vector<Cell>& given, double snap) {
    detail::Cutter cutter(edit, given);
    std::vector<std::uint32_t> numbers(given.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    cutter.take({&plane, 1}, cutter.snap_distance(numbers, {snap, options.finest}));
    const auto parts = cutter.split(numbers, 0);
    std::vector<Cell> whole = cutter.cells(parts.whole);
    detail::Succession succession = cutter.put();
    return detail::CutAttempt<Section>{
        {cutter.cells(parts.below), cutter.cells(parts.above), cutter.cells(parts.whole)},
        std::move(succession),
        std::move(whole)};
  });
}

}  // namespace dartcast
