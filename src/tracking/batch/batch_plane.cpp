// The batch of the plane: block by block, one triangle of every walk at a time.
#include "tracking/batch/batch_plane.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "complex/simplex.hpp"
#include "tracking/batch/plane_block.hpp"
#include "tracking/carry.hpp"

namespace dartcast::detail {

namespace {

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
  PlaneBatch(const BatchScene& scene, const BatchSteps& steps, Counters& counters, InstructionSet set)
      : scene_(scene),
        set_(set),
        space_{&scene.complex->map(), {scene.now()}, scene.complex->simplex_count()},
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
  static constexpr std::uint8_t all_facets = 7;

  // The first triangle of each step, where most steps end. Returns the number of walks that go on.
  template <bool moved>
  std::size_t start() {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, plane_block); ++i) prefetch<moved>(i);
    for (std::uint32_t first = 0; first < size_; first += plane_block) {
      const std::uint32_t n = std::min(plane_block, size_ - first);
      for (std::uint32_t i = first + n; i < std::min(first + n + plane_block, size_); ++i) prefetch<moved>(i);
      const PlaneBlock block = look_at(first, n);
      for (std::uint32_t bits = block.deferred; bits != 0; bits &= bits - 1) defer(first + lowest(bits));
      end_inside(first, block.inside);
      const std::uint32_t leaving = all_of(n) & ~(block.deferred | block.inside);
      for (std::uint32_t bits = leaving; bits != 0; bits &= bits - 1)
        __builtin_prefetch(space_.map->record(steps_.states[first + lowest(bits)].cell));
      for (std::uint32_t bits = leaving; bits != 0; bits &= bits - 1) {
        const std::uint32_t k = lowest(bits);
        if (moved && !carry(first + k, block, k)) continue;
        const unsigned behind = ((block.decided >> k) & 1U) != 0 ? block.behind[k] : 0U;
        if (leave_first(first + k, behind, walks_[count])) ++count;
      }
    }
    return count;
  }

  [[nodiscard]] PlaneBlock look_at(std::uint32_t first, std::uint32_t count) const {
    const PlaneVertices vertices = {space_.positions.at, before_};
#if defined(__x86_64__)
    if (set_ == InstructionSet::avx2)
      return avx2::look_at_triangles(vertices, steps_, first, count, scene_.options.tolerance);
#endif
    return portable::look_at_triangles(vertices, steps_, first, count, scene_.options.tolerance);
  }

  static std::uint32_t lowest(std::uint32_t bits) { return static_cast<std::uint32_t>(std::countr_zero(bits)); }

  // Nothing in a triangle is in the way of steps that end strictly inside.
  void end_inside(std::uint32_t first, std::uint32_t inside) {
    for (std::uint32_t bits = inside; bits != 0; bits &= bits - 1) {
      const std::uint32_t i = first + lowest(bits);
      steps_.states[i].position = steps_.targets[i];
    }
    const auto ended = static_cast<std::uint64_t>(std::popcount(inside));
    counters_.particle_steps += ended;
    counters_.orientation.tests += 3 * ended;
    counters_.histogram[3] += ended;
    counters_.forecast_kept += ended;
  }

  // `behind`: the facets that the target is behind, where they are known. Fills the walk. False where it has ended.
  bool leave_first(std::uint32_t i, unsigned behind, PlaneWalkCursor& cursor) {
    const ParticleState& s = steps_.states[i];
    cursor = {i, s.cell.value, s.simplex, all_facets, false, 0, 0};
    if (behind == 0) return true;
    TestCounts counts{3, 0};
    const bool single = std::has_single_bit(behind);
    const unsigned facet = single ? static_cast<unsigned>(std::countr_zero(behind))
                                  : exit_by(cursor, corners(space_.positions.at, i), behind, counts);
    cursor.tests = static_cast<std::uint32_t>(counts.tests);
    cursor.exact = static_cast<std::uint32_t>(counts.exact);
    const CellView cell = space_.map->view(s.cell);
    return pass_on(cursor, cell, cell.shape().simplices()[s.simplex].across[facet], facet);
  }

  // Carries the start of a walk along with the mesh; false where the step is deferred.
  bool carry(std::uint32_t i, const PlaneBlock& block, std::uint32_t k) {
    if (((block.carried_inside >> k) & 1U) == 0) return defer(i);
    left_behind_[i] = ((block.left_behind >> k) & 1U) != 0;
    carried_[i] = block.carried[k];
    return true;
  }

  // One triangle of every walk. Returns the number of walks that go on.
  std::size_t walk_on(std::size_t count) {
    std::size_t next = 0;
    for (std::size_t first = 0; first < count; first += plane_block) {
      const std::size_t n = std::min<std::size_t>(plane_block, count - first);
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
    return before_ == nullptr ? steps_.states[i].position : Vec3{carried_[i][0], carried_[i][1], 0.0};
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
  [[maybe_unused]] InstructionSet set_;  // of x86-64 alone
  const Space<Stored, 3> space_;
  const Vec3* before_;  // null where the scene stands still
  const BatchSteps& steps_;
  std::uint32_t size_;
  Counters& counters_;

  std::array<PlaneWalkCursor, max_batch> walks_;          // walks that go on
  std::array<std::array<double, 2>, max_batch> carried_;  // where the mesh has carried particles to
  std::array<bool, max_batch> left_behind_;
};

}  // namespace

void step_plane(const BatchScene& scene, const BatchSteps& steps, Counters& counters, InstructionSet set) {
  PlaneBatch(scene, steps, counters, set).run();
}

}  // namespace dartcast::detail
