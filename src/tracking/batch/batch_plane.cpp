// The batch of the plane: block by block, one triangle of every walk at a time.
#include "tracking/batch/batch_plane.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "complex/simplex.hpp"
#include "tracking/carry.hpp"

namespace dartcast::detail {

namespace {

// A vector of the plane.
struct Vec2x4 {
  double x, y;

  Vec2x4 operator-(const Vec2x4& b) const { return {x - b.x, y - b.y}; }
  [[nodiscard]] double square() const { return x * x + y * y; }
};
Vec2x4 from_to(const Vec3& a, const Vec3& b) { return {b.x - a.x, b.y - a.y}; }

// The data of its first triangle that a step among moving vertices reads.
struct PlaneMove {
  const PlaneCorners& before;
  const PlaneCorners& after;
  const Determinants<3>& was;   // of p, before
  const Determinants<3>& will;  // of q, after
  const Vec3& p;
  const Vec3& q;
};

// Whether the step surely needs no splitting (tracking/step.hpp): |A| |r| <= 2 tolerance edge.
//
// |A| V, V and the edge are the doubles of the rule, up to a root and a quotient. Let d_i be the corners' displacements
// less q - p. Then -r is their mean, weighted by the particle's coordinates: |r| <= max |d_i|. The rule's r is off from
// that by at most m: its coordinates are right to 2^-26, and points are rounded. In squares, (a + b)^2 <= 17/16 a^2 +
// 17 b^2 bounds that. The last line excludes overflow and underflow.
bool surely_one_part(const PlaneMove& move, double tolerance) {
  const auto& [v, w, was, will, p, q] = move;
  const Vec2x4 own = from_to(p, q);
  const Vec2x4 d0 = from_to(v[0], w[0]);
  const Vec2x4 d1 = from_to(v[1], w[1]);
  const Vec2x4 d2 = from_to(v[2], w[2]);
  const double m = 0x1p-22 * (was.extent.x + was.extent.y + will.extent.x + will.extent.y) +
                   0x1p-48 * (std::abs(q.x) + std::abs(q.y) + std::abs(own.x) + std::abs(own.y));
  const double farthest = std::max(std::max((d0 - own).square(), (d1 - own).square()), (d2 - own).square());
  const double r2 = 0x1.1p+0 * farthest + 17.0 * m * m;
  const Vec2x4 e0 = from_to(v[0], v[1]);
  const Vec2x4 e1 = from_to(v[0], v[2]);
  const Vec2x4 u0 = d1 - d0;
  const Vec2x4 u1 = d2 - d0;
  const Vec2x4 ax = {e1.y * u0.x - e0.y * u1.x, e0.x * u1.x - e1.x * u0.x};
  const Vec2x4 ay = {e1.y * u0.y - e0.y * u1.y, e0.x * u1.y - e1.x * u0.y};
  const double volume = e0.x * e1.y - e0.y * e1.x;
  const double limit = 1.98 * tolerance * volume;
  const double edge2 = std::min(std::min(e0.square(), e1.square()), from_to(v[1], v[2]).square());
  const double right = limit * limit * edge2;
  return (ax.square() + ay.square()) * r2 <= right && volume > 0x1p-200 && r2 < 0x1p+200 && right > 0x1p-700 &&
         right < 0x1p+1000;
}

// A walk, and the triangle that it has come to. Without initializers: a batch has room for many, and uses few.
struct PlaneWalkCursor {
  std::uint32_t particle;
  std::uint32_t cell;   // its value
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint8_t tested;  // facets, but that entered by
  bool through_face;
  std::uint32_t tests;  // so far
  std::uint32_t exact;  // of these, those that the filter left open
};

// Triangles are taken block by block, in passes, as in tracking/batch/batch_steps.inl.
class PlaneBatch {
 public:
  PlaneBatch(const BatchScene& scene, const BatchSteps& steps, Counters& counters)
      : scene_(scene),
        space_(current_space<3>(*scene.complex)),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        steps_(steps),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        counters_(counters) {}

  void run() {
    std::fill_n(steps_.status.begin(), size_, step_complete);
    std::size_t count = before_ == nullptr ? start<false>() : start<true>();
    for (std::uint64_t round = 0; count > 0; ++round) {
      if (round > space_.simplex_count) return defer_all(count);
      count = walk_on(count);
    }
  }

 private:
  static constexpr std::uint32_t block = 32;
  static constexpr std::uint8_t all_facets = 7;

  // Ends the steps whose targets lie strictly inside the first triangle: nothing in a triangle is in the way. Returns
  // the number of walks that go on.
  template <bool moved>
  std::size_t start() {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) prefetch<moved>(i);
    for (std::uint32_t i = 0; i < size_; ++i) {
      if (i + block < size_) prefetch<moved>(i + block);
      if (!goes_on<moved>(i)) continue;
      const ParticleState& s = steps_.states[i];
      walks_[count++] = {i, s.cell.value, s.simplex, all_facets, false, 0, 0};
      __builtin_prefetch(space_.map->record(s.cell));
    }
    return count;
  }

  // Whether the step goes on from its first triangle; otherwise it has ended, or is deferred.
  template <bool moved>
  bool goes_on(std::uint32_t i) {
    ParticleState& s = steps_.states[i];
    const Vec3& q = steps_.targets[i];
    const PlaneCorners now = corners(space_.positions.at, i);
    const Determinants d(now, q);
    bool inside = d.all_proved_positive() && s.touching_count == 0;
    if constexpr (moved) {
      const PlaneCorners old = corners(before_, i);
      const Determinants was(old, s.position);
      if (s.held || !was.proves_coordinates() || !surely_one_part({old, now, was, d, s.position, q}, scene_.tolerance))
        return defer(i);
      if (!inside) return carry(i, old, now);
    } else if (s.held || s.position == q) {
      return defer(i);
    }
    if (!inside) return true;
    s.position = q;
    count_step({3, 0}, true);
    return false;
  }

  // Carries the start of a walk along with the mesh; false where the step is deferred.
  bool carry(std::uint32_t i, const PlaneCorners& old, const PlaneCorners& now) {
    const Vec3& p = steps_.states[i].position;
    const Determinants d(now, p);
    left_behind_[i] = std::any_of(d.value.begin(), d.value.end(), [&](double v) { return v < -d.bound; });
    const Vec3 carried = flushed(combine(now, barycentric(old, p)));
    if (carried == steps_.targets[i] || !Determinants(now, carried).all_proved_positive()) return defer(i);
    carried_[i] = {carried.x, carried.y, carried.z};
    return true;
  }

  // One triangle of every walk. Returns the number of walks that go on.
  std::size_t walk_on(std::size_t count) {
    std::size_t next = 0;
    for (std::size_t first = 0; first < count; first += block) {
      const std::size_t n = std::min<std::size_t>(block, count - first);
      for (std::size_t k = 0; k < n; ++k) enter(walks_[first + k]);
      for (std::size_t k = 0; k < n; ++k) {
        PlaneWalkCursor& cursor = walks_[next] = walks_[first + k];
        next += leave_triangle(cursor) ? 1 : 0;
      }
    }
    return next;
  }

  // Finds the triangle behind the face that the walk passes, and prefetches its corners.
  void enter(PlaneWalkCursor& cursor) const {
    const CellView cell = space_.map->view(Cell(cursor.cell));
    if (cursor.through_face) {
      const Across at = cell.shape().entry(cursor.index, 0);
      cursor.index = at.index;
      cursor.tested = static_cast<std::uint8_t>(all_facets & ~(1U << at.place));
    }
    const auto& local = cell.shape().simplices()[cursor.index].vertex;
    for (unsigned i = 0; i < 3; ++i) __builtin_prefetch(space_.positions.at + cell.vertex(local[i]).value);
  }

  // As walk_to_wall() does in one triangle. False where the walk has ended, or is deferred.
  bool leave_triangle(PlaneWalkCursor& cursor) {
    const Vec3& q = steps_.targets[cursor.particle];
    const CellView cell = space_.map->view(Cell(cursor.cell));
    const ImplicitSimplex& s = cell.shape().simplices()[cursor.index];
    const PlaneCorners v = space_.corners(cell, s);
    const Determinants d(v, q);
    if (!d.proves_positive() && volume_sign(v) != Sign::positive) return defer(cursor.particle);
    TestCounts counts{cursor.tested == all_facets ? 3U : 2U, 0};
    const DeterminantSigns signs = signs_of(d, v, q, cursor.tested, counts.exact);
    unsigned facet = 0;
    if (signs.negative != 0) facet = exit_by(cursor, v, signs.negative, counts);
    cursor.tests += static_cast<std::uint32_t>(counts.tests);
    cursor.exact += static_cast<std::uint32_t>(counts.exact);
    return signs.negative == 0 ? arrive(cursor, signs.zero) : pass_on(cursor, cell, s.across[facet], facet);
  }

  unsigned exit_by(const PlaneWalkCursor& cursor, const PlaneCorners& v, unsigned behind, TestCounts& counts) const {
    if ((behind & (behind - 1)) == 0) return static_cast<unsigned>(std::countr_zero(behind));
    const Vec3 p = start_of(cursor.particle);
    const Vec3& q = steps_.targets[cursor.particle];
    Ties<Stored, 3> ties(space_, steps_.states[cursor.particle].at(), p, q);
    return exit_facet(v, behind, p, q, ties, counts);
  }

  bool pass_on(PlaneWalkCursor& cursor, const CellView& cell, Across across, unsigned facet) {
    cursor.through_face = across.outer();
    if (!across.outer()) {
      cursor.index = across.index;
      cursor.tested = static_cast<std::uint8_t>(all_facets & ~(1U << across.place));
      return true;
    }
    const std::uint16_t face = across.face();
    if (cell.is_wall(face)) {
      Walk walk;
      walk.end = WalkEnd::wall;
      walk.simplex = walk.wall_simplex = {Cell(cursor.cell), cursor.index};
      walk.wall_facet = static_cast<std::uint8_t>(facet);
      return defer_at_wall(cursor, walk);
    }
    cursor.cell = cell.neighbour(face).value;
    cursor.index = cell.neighbour_face(face);
    __builtin_prefetch(space_.map->record(Cell(cursor.cell)));
    return true;
  }

  bool arrive(const PlaneWalkCursor& cursor, unsigned zeros) {
    Walk walk;
    walk.simplex = {Cell(cursor.cell), cursor.index};
    walk.zeros = static_cast<std::uint8_t>(zeros);
    if (zeros != 0) find_wall_at_end<3>(*space_.map, walk);
    if (walk.end == WalkEnd::wall) return defer_at_wall(cursor, walk);
    const std::uint32_t i = cursor.particle;
    ParticleState& s = steps_.states[i];
    const bool kept = s.at() == walk.simplex;
    if (before_ != nullptr && !kept) counters_.updated_by_deformation += left_behind_[i] ? 1 : 0;
    s.put(walk.simplex, steps_.targets[i]);
    s.touching_count = 0;
    if (!kept) steps_.vertices[i] = vertex_numbers(*scene_.complex, walk.simplex);
    count_step({cursor.tests, cursor.exact}, kept);
    return false;
  }

  // Defers the step to Stepper, from the wall on. Returns false: the walk does not go on.
  bool defer_at_wall(const PlaneWalkCursor& cursor, const Walk& walk) {
    steps_.status[cursor.particle] = static_cast<StepStatus>(steps_.partial.size());
    steps_.partial.emplace_back(start_of(cursor.particle), walk, TestCounts{cursor.tests, cursor.exact});
    return false;
  }
  // Defers the step to Stepper, from its start. Returns false, too.
  bool defer(std::uint32_t i) {
    steps_.status[i] = step_untouched;
    return false;
  }
  void defer_all(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) defer(walks_[k].particle);
  }

  void count_step(const TestCounts& counts, bool kept) {
    ++counters_.particle_steps;
    counters_.orientation.tests += counts.tests;
    counters_.orientation.exact += counts.exact;
    ++counters_.histogram[std::min<std::size_t>(counts.tests, Counters::histogram_size - 1)];
    counters_.forecast_kept += kept ? 1 : 0;
  }

  [[nodiscard]] Vec3 start_of(std::uint32_t i) const {
    return before_ == nullptr ? steps_.states[i].position : Vec3{carried_[i][0], carried_[i][1], carried_[i][2]};
  }
  [[nodiscard]] PlaneCorners corners(const Vec3* positions, std::uint32_t i) const {
    const VertexNumbers& v = steps_.vertices[i];
    const auto flat = [&](unsigned k) { return Vec3{positions[v[k]].x, positions[v[k]].y, 0.0}; };
    return {flat(0), flat(1), flat(2)};
  }
  template <bool moved>
  void prefetch(std::uint32_t i) const {
    for (unsigned k = 0; k < 3; ++k) {
      __builtin_prefetch(space_.positions.at + steps_.vertices[i][k]);
      if constexpr (moved) __builtin_prefetch(before_ + steps_.vertices[i][k]);
    }
  }

  const BatchScene& scene_;
  const Space<Stored, 3> space_;
  const Vec3* before_;  // null where the scene stands still
  const BatchSteps& steps_;
  std::uint32_t size_;
  Counters& counters_;

  std::array<PlaneWalkCursor, max_batch> walks_;          // walks that go on
  std::array<std::array<double, 3>, max_batch> carried_;  // where the mesh has carried particles to
  std::array<bool, max_batch> left_behind_;
};

}  // namespace

void step_plane(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  PlaneBatch(scene, steps, counters).run();
}

}  // namespace dartcast::detail
