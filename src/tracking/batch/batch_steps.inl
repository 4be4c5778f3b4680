// One batch of steps: its phases, and what they share. Part of the batch's kernel (tracking/batch/batch_kernel.inl).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/double4.inl"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/batch_caches.inl"
#include "tracking/batch/batch_cell_lanes.inl"
#include "tracking/batch/batch_cell_records.inl"
#include "tracking/batch/batch_impacts.inl"
#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/batch_records.inl"
#include "tracking/batch/batch_simplex.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Simplices are processed block by block, in passes with as few branches as possible. The first pass finds all
// simplices of the block and prefetches their corners. The second pass tests them, four in a vector. The third pass
// continues the walks that have not ended. There is one class for each kind of cache, so that functions which are
// called once are inlined.
template <CacheKind kind>
class Batch {
 public:
  Batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters)
      : map_(scene.complex->map()),
        now_(scene.complex->positions().data()),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        caches_match_(scene.caches_match),
        walls_match_(scene.walls_match),
        stops_(scene.stops),
        cells_positive_(!moved && are_known_positive(*scene.complex)),
        options_(scene.options),
        simplex_count_(scene.complex->simplex_count()),
        most_line_tests_(std::min<std::uint64_t>(4 * simplex_count_ + 16, 1U << 31U)),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        caches_(steps.caches.fours.data()),
        flags_(steps.caches.flags.data()),
        targets_(steps.targets.data()),
        status_(steps.status.data()),
        partial_(steps.partial),
        counters_(counters) {}

  void run() {
    if (kind != CacheKind::none && !caches_match_) make_caches();
    if (kind == CacheKind::barycentric && !walls_match_) std::fill_n(flags_, size_, CacheFlags{0});
    std::fill_n(status_, size_, step_complete);
    const std::size_t exits = kind == CacheKind::barycentric ? start_by_coordinates() : start();
    if ((far_count_ | farther_count_ | slice_walk_count_) != 0) walk_lines();
    std::size_t count = take_exits(exits);
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round > simplex_count_) {
        for (std::size_t k = 0; k < count; ++k) defer(walks_[k].particle);
        break;
      }
      count = walk_on(count);
    }
    compute_impacts();
    if (facet_arrivals_ != 0) cache_exact_coordinates();
  }

 private:
  static constexpr std::uint32_t block = 32;
  static constexpr std::uint32_t lines = 32;
  static constexpr std::uint32_t cell_lanes = 16;
  static constexpr std::uint32_t turns_at_once = 1024;  // of walks along lines, before their tests are counted
  static constexpr bool moved = kind == CacheKind::previous_geometry;
  static constexpr std::uint16_t short_tests = 16;  // four simplices

  // Four particles in a row from i on.
  Vec3x4 targets_from(std::uint32_t i) const {
    return i + 4 <= size_ ? load_vec3x4(targets_ + i) : targets_of(index4_from(i, size_));
  }
  Vec3x4 targets_of(const Index4& i) const {
    return load_vec3x4(targets_[i.at[0]], targets_[i.at[1]], targets_[i.at[2]], targets_[i.at[3]]);
  }
  Vec3x4 places_of(const Index4& i) const {
    return load_vec3x4(states_[i.at[0]].position, states_[i.at[1]].position, states_[i.at[2]].position,
                       states_[i.at[3]].position);
  }
  [[gnu::always_inline]] Corners4 simplices_of(const Vec3* positions, const Index4& i) const {
    return Corners4(positions, vertices_[i.at[0]], vertices_[i.at[1]], vertices_[i.at[2]], vertices_[i.at[3]]);
  }
  void store_signs(const Mask4& signs, std::size_t k) { *reinterpret_cast<UnalignedMask4*>(&signs_[k]) = signs; }
  // Called before four particles from i on are tested: prefetches what the four of the next block need.
  [[gnu::always_inline]] void prefetch_ahead(std::uint32_t i) const {
    const std::uint32_t end = std::min(i + block + 4, size_);
    for (i += block; i < end; ++i) prefetch(now_, vertices_[i]);
  }
  // Defers the step to Stepper, from its start. Returns false: the walk does not go on.
  bool defer(std::uint32_t i) {
    status_[i] = step_untouched;
    return false;
  }
  [[nodiscard]] Across across_of(const WalkCursor& cursor, unsigned facet) const {
    return map_.view(Cell(cursor.cell), cursor.record).shape().simplices()[cursor.index].across[facet];
  }

  // The first simplex: batch_first_simplex.inl.
  std::size_t start();
  std::size_t start_by_coordinates();
  void sort_undecided(std::size_t k, std::size_t count);
  void test_block(std::uint32_t first, std::uint32_t n);
  void test_coordinates(std::uint32_t first, std::uint32_t n);
  [[gnu::noinline]] void test_zeros(std::uint32_t first, std::uint32_t k, const Vec3x4& q, const Mask4& in_range,
                                    const Mask4& proved, const Mask4& negative);
  std::uint32_t end_inside(std::uint32_t first, std::uint32_t n);
  [[gnu::noinline]] void end_on_facets(std::uint32_t first);
  bool defer_unusual(std::uint32_t i, std::uint32_t k);
  [[nodiscard]] Vec3 carried_position(std::uint32_t i, const Weights& w) const;
  [[nodiscard]] std::optional<Vec3> carried_position_inside(std::uint32_t i) const;
  [[nodiscard]] bool rests(std::uint32_t i) const;
  std::uint32_t carry_remaining(std::uint32_t first, std::uint32_t remaining);
  std::uint32_t carry_four(const Index4& i, std::uint32_t count, std::uint32_t going_on, std::uint32_t first);
  std::size_t take_exits(std::size_t exits);
  void add_to_rounds(const WalkCursor& cursor) { walks_[in_rounds_++] = cursor; }

  // The other simplices along lines: batch_far_walks.inl.
  [[gnu::noinline]] void walk_lines();
  [[gnu::noinline]] void walk_farther();
  bool leave_to_cells(std::uint32_t l);
  void begin_lines(const WalkStart* walks, std::size_t count);
  template <LineKind line, class StartNext>
  void pass_simplices(const StartNext& start_next);
  template <LineKind line, class StartNext>
  bool find_corners(std::uint32_t l, const StartNext& start_next);
  void stage_lines();
  bool start_next_line(std::uint32_t l);
  bool start_line(std::uint32_t l, std::uint32_t i, const std::uint32_t* record, unsigned from);
  bool resume_next_line(std::uint32_t l);
  void stage_resumed_lines();
  void set_to_cells(std::uint32_t l, bool to_cells);
  void add_far_walk(const WalkStart& walk, bool farther);
  [[nodiscard]] unsigned row_behind(const CellWalk& walk) const;
  template <LineKind line>
  std::uint32_t pass_four(std::uint32_t l, std::uint32_t live);
  template <LineKind line>
  bool goes_on(std::uint32_t l);
  template <class StartNext>
  [[gnu::cold, gnu::noinline]] std::uint32_t stop_lines(std::uint32_t live, const StartNext& start_next);
  [[nodiscard]] WalkCursor passed_cursor(const LinePlace& at) const;
  bool leave_to_rounds(const LinePlace& at);
  [[gnu::cold, gnu::noinline]] void leave_unlisted(const LinePlace& at);
  [[nodiscard]] VertexNumbers corners_of_walk(const WalkCursor& cursor) const;
  bool arrive_by_line(const WalkCursor& cursor);
  void cache_line_arrivals();
  [[nodiscard]] Vec3x4 starts_of(const Index4& i, const Corners4& now) const;

  // Steps of several slices: batch_split_steps.inl.
  std::uint32_t split_steps(std::uint32_t first, std::uint32_t which);
  [[gnu::noinline]] unsigned split_four(const Index4& i, std::uint32_t count);

  // Walks apart, in the first slices of steps: batch_slice_walks.inl.
  [[gnu::noinline]] bool add_slice_walk(std::uint32_t i, unsigned slices);
  [[gnu::noinline]] void walk_first_slices();
  bool start_next_slice(std::uint32_t l);
  void stage_slices();
  [[nodiscard]] Vec3 target_of(std::uint32_t i, unsigned slices) const;
  [[nodiscard]] const Vec3* before_move(const Vec3* now) const;
  [[nodiscard]] Vec3x4 corners_in_slices(const LinePlace* at, std::uint32_t l) const;
  bool end_slice(std::uint32_t l, bool at_wall);

  // Whole cells of these: batch_cell_walks.inl.
  [[gnu::noinline]] void walk_cells();
  bool start_next_cell(std::uint32_t l);
  void stage_cell_walks();
  void find_rows(std::uint32_t l, std::uint32_t live);
  std::uint32_t pass_eight(std::uint32_t l, std::uint32_t live);
  void leave_cells(std::uint32_t l);
  [[gnu::cold, gnu::noinline]] std::uint32_t stop_cells(std::uint32_t live);

  // And in rounds: batch_walk.inl.
  std::size_t walk_on(std::size_t count);
  void enter(WalkCursor& cursor, std::size_t k);
  [[gnu::always_inline]] void test_four(const WalkCursor* walks, std::size_t k, std::size_t last);
  bool leave_simplex(WalkCursor& cursor, const VertexNumbers& corners, std::size_t k);
  unsigned first_exit(WalkCursor& cursor, const VertexNumbers& corners, unsigned behind) const;
  [[gnu::noinline]] bool passes_before(std::uint32_t i, const Vec3& a, const Vec3& b, const Vec3& p,
                                       const Vec3& q) const;
  bool pass_on(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet, const SimplexExit* exits);
  bool pass_general(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet);
  bool pass_face(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet, Across across);
  void arrive(const WalkCursor& cursor, const VertexNumbers& corners, std::size_t k);
  void end(const WalkCursor& cursor);
  [[nodiscard]] Vec3 start_of(std::uint32_t i) const;

  // Walls: batch_walls.inl.
  [[gnu::cold, gnu::noinline]] bool end_at_wall(const WalkCursor& cursor, const VertexNumbers& corners, unsigned facet);
  [[gnu::cold, gnu::noinline]] bool end_on_wall(const WalkCursor& cursor, unsigned on, const SimplexFacet& wall);
  bool defer_at_wall(const WalkCursor& cursor, const Walk& walk);
  [[nodiscard]] Vec3x4 targets_at(const AtWalls& at) const;
  [[nodiscard]] Vec3x4 facet_corners_at(const AtWalls& at, unsigned i) const;
  [[nodiscard]] Corners4 simplices_at(const AtWalls& at) const;
  [[nodiscard]] Mask4 carry_on(const AtWalls& at, WallImpact4& impacts) const;
  [[nodiscard]] Mask4 are_left_behind(const AtWalls& at) const;
  void compute_impacts();
  void compute_impact4(std::uint32_t k);

  // Caches: batch_remember.inl.
  void make_caches();
  bool needs_coordinates(const WalkCursor& cursor);
  [[gnu::noinline]] void arrive_on_facets(const WalkCursor& cursor, const VertexNumbers& corners, std::size_t k,
                                          unsigned on);
  void cache_arrivals();
  [[gnu::noinline]] void cache_exact_coordinates();

  const CombinatorialMap& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  bool caches_match_;
  bool walls_match_;
  bool stops_;           // at walls
  bool cells_positive_;  // all are known to be
  StepOptions options_;
  std::uint64_t simplex_count_;
  // A walk along a line asks no more tests. It passes each simplex once at most: by three tests, or five or more in a
  // whole cell by 17. A few others are asked at its ends.
  std::uint64_t most_line_tests_;
  std::uint32_t turns_ = 0;  // of walks along lines
  std::uint32_t size_;
  ParticleState* states_;
  VertexNumbers* vertices_;
  SimplexCache4* caches_;
  CacheFlags* flags_;
  const Vec3* targets_;
  StepStatus* status_;
  std::vector<StepState>& partial_;
  Counters& counters_;

  // Scratch of the block. In bit sets there is one bit per particle.
  std::array<VertexNumbers, block> corners_;
  std::array<const SimplexExit*, block> exits_here_;  // null without a table
  std::array<BatchDeterminants, block / 4> determinants_;
  std::array<Vec3x4, block / 4> ends_;  // targets
  std::array<long long, block> signs_;
  std::uint32_t inside_;                        // targets strictly inside
  std::uint32_t on_facets_ = 0;                 // targets on facets, and maybe on walls
  std::uint32_t still_free_;                    // targets on facets, but on no wall
  std::uint32_t one_part_;                      // steps that need no splitting
  std::uint32_t far_away_;                      // targets some simplices away
  std::uint32_t farther_away_;                  // targets some cells away
  std::uint32_t carried_inside_;                // starts that the mesh carries to strictly inside
  std::array<std::uint32_t, block> remaining_;  // steps that have not ended
  std::array<Arrival, block> arrival_;
  std::uint32_t arrivals_;

  // Scratch of the batch.
  std::array<AtWall, max_batch> at_walls_;
  std::uint32_t at_wall_count_ = 0;
  std::array<WalkCursor, max_batch> walks_;  // those that go on
  std::size_t in_rounds_ = 0;                // walks that begin there
  std::array<ExitCandidate, max_batch> exits_;
  std::array<WalkStart, max_batch> undecided_;  // by coordinates
  std::array<WalkStart, max_batch> far_walks_;
  std::size_t far_count_ = 0;
  std::array<WalkStart, max_batch> farther_walks_;  // those that may pass whole cells
  std::size_t farther_count_ = 0;
  std::array<CellExit, max_batch> cell_exits_;
  std::array<SimplexCache4::Table<double>, max_batch / 4> previous_determinants_;  // before the move
  std::array<bool, max_batch> left_behind_;
  std::array<LineWalks4, lines / 4> line_walks_;
  std::array<LinePlace, lines> line_places_;
  std::array<std::uint32_t, lines / 4> at_wall_lanes_;  // a bit for each
  std::array<RecordPool, CombinatorialMap::general_pool> record_pools_;
  LineStarts4 line_starts_;       // of four walks
  const WalkStart* walk_starts_;  // walks to begin
  std::size_t walk_start_count_;
  std::size_t next_line_;  // the next of these
  std::size_t staged_;     // walks before this one are in line_starts_
  std::array<std::uint32_t, max_batch> line_arrival_;
  std::uint32_t line_arrivals_;
  std::array<FacetArrival, max_batch> facet_arrival_;
  std::uint32_t facet_arrivals_ = 0;
  std::uint32_t to_cells_;  // a bit for each lane: from the next face on the walk may pass whole hexahedra
  std::array<SliceWalk, max_batch> slice_walks_;
  std::size_t slice_walk_count_ = 0;
  std::array<std::uint32_t, lines> slice_of_line_;  // the number of its SliceWalk
  std::array<Double4, lines / 4> slice_times_;      // of the step: the vertices are where they are then
  LineResumptions4 resumed_lines_;
  CellWalkQueue by_cells_;
  std::array<CellWalks8, cell_lanes / 8> cell_walks_;
  std::array<CellPlace, cell_lanes> cell_places_;
  std::array<FarCorners8, cell_lanes / 8> far_corners_;
  CellStarts4 cell_starts_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
