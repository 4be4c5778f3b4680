// The loop of walk/filtered.cpp, compiled there once per instruction set: no include guard, and not to be included
// elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function, and lanes_set(Mask).
// In this order:
// clang-format off
#include "dartcast/walk/filtered_simplex.hpp"
#include "dartcast/walk/filtered_memo.hpp"
// clang-format on

// A simplex that a walk has come to.
struct Visit {
  std::uint32_t particle;
  std::uint32_t cell;   // its value
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint16_t place;  // facet that was entered by (no_facet: none), or triangle of that face
  std::uint16_t tests;  // so far
  std::uint16_t exact;  // of these, those that the filter left open
  bool through_face;
};

// Simplices are taken block by block, in passes without branches as far as possible: all are found, so that their
// corners are on the way from memory before the first is used; all are tested; then those that are left go on.
// A class for each kind of memo: what is called once is inlined.
template <MemoKind kind>
class Batch {
 public:
  DARTCAST_TARGET Batch(const FilteredScene& scene, const FilteredSteps& steps, Counters& counters)
      : map_(scene.complex->map()),
        now_(scene.complex->positions().data()),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        memos_match_(scene.memos_match),
        tolerance_(scene.tolerance),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        memos_(steps.memos.data()),
        targets_(steps.targets.data()),
        taken_(steps.taken.data()),
        begun_(steps.begun),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint64_t most_rounds) {
    if (kind != MemoKind::none && !memos_match_) make_memos();
    std::fill_n(taken_, size_, taken_all);
    std::size_t count = kind == MemoKind::coordinates ? begin_by_coordinates() : begin();
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round == most_rounds) return leave_all(count);
      count = walk_on(count);
    }
  }

 private:
  static constexpr std::uint32_t block = 32;
  static constexpr std::uint8_t no_facet = 4;
  static constexpr bool moved = kind == MemoKind::trail;

  // The first simplex of each step: most end there. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t begin() {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) ask_for(now_, vertices_[i]);
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      for (std::uint32_t k = 0; k < n; ++k) {
        if (first + k + block < size_) ask_for(now_, vertices_[first + k + block]);
        test(first + k, k);
      }
      const std::uint32_t leaving = ride_all(first, end_inside(first, n));
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        visits_[count] = {i, states_[i].cell.value, states_[i].simplex, no_facet, 4, 0, false};
        if (leave_simplex(visits_[count], vertices_[i], leaving_[l])) ++count;
      }
      if constexpr (moved) leave_trails(first, n);
    }
    return count;
  }

  // The first simplex of each step where vertices stand still: the scene is read by those alone that leave it.
  DARTCAST_TARGET std::size_t begin_by_coordinates() {
    std::size_t count = 0;
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t leaving = end_inside_by_coordinates(first, std::min(block, size_ - first));
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        const State& s = states_[i];
        __builtin_prefetch(map_.record(s.cell));
        exits_[count] = exit_by(coordinates_[l]);
        if (exits_[count] == no_facet) ask_for(now_, vertices_[i]);
        visits_[count++] = {i, s.cell.value, s.simplex, no_facet, 4, 0, false};
      }
    }
    return go_on_from_first(count);
  }

  // As end_inside(), and leaves the coordinates of the others in coordinates_.
  DARTCAST_TARGET std::uint32_t end_inside_by_coordinates(std::uint32_t first, std::uint32_t n) {
    std::uint32_t leaving = 0;
    std::uint32_t left = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t i = first + k;
      State& s = states_[i];
      if (s.held || (s.touching_count != 0 && rests(i))) [[unlikely]] {
        leave(i);
        ++left;
        continue;
      }
      const Quad c = coordinates_of(memos_[i], targets_[i]);
      const bool inside = lanes_set(c > coordinate_margin) == 15U;
      coordinates_[leaving] = c;
      leaving_[leaving] = k;
      leaving += inside ? 0 : 1;
      store_where(inside, load_row(targets_[i]), s.position);
      if (s.touching_count != 0 && inside) [[unlikely]]
        s.touching_count = 0;
    }
    count_ended(n - leaving - left);
    return leaving;
  }

  DARTCAST_TARGET void count_ended(std::uint32_t ended) {
    counters_.particle_steps += ended;
    counters_.orientation.tests += std::uint64_t{4} * ended;
    counters_.histogram[4] += ended;
    counters_.forecast_kept += ended;
  }

  // The facet that a target lies behind, and no other, where its coordinates prove it.
  DARTCAST_TARGET static std::uint8_t exit_by(const Quad& coordinates) {
    const Quad m = magnitude(coordinates);
    const Mask signs_known = (m > coordinate_margin) & (m <= most_for_sign);
    const unsigned beyond = lanes_set(coordinates < 0.0);
    if (lanes_set(signs_known) != 15U || !std::has_single_bit(beyond)) return no_facet;
    return static_cast<std::uint8_t>(std::countr_zero(beyond));
  }

  DARTCAST_TARGET std::size_t go_on_from_first(std::size_t count) {
    std::size_t next = 0;
    for (std::size_t k = 0; k < count; ++k) {
      Visit& v = visits_[next] = visits_[k];
      if (exits_[k] != no_facet ? pass_on(v, exits_[k]) : test_first(v)) ++next;
    }
    return next;
  }

  DARTCAST_TARGET bool test_first(Visit& visit) {
    const VertexNumbers& corners = vertices_[visit.particle];
    determinants_[0] = FilteredDeterminants(Rows(now_, corners), load_row(targets_[visit.particle]), relative_[0]);
    return leave_simplex(visit, corners, 0);
  }

  // For particles that have none of this kind: trails, of where they were before the move, or coordinates.
  DARTCAST_TARGET void make_memos() {
    const Vec3* positions = moved ? before_ : now_;
    for (std::uint32_t i = 0; i < size_; ++i) {
      if (i + block < size_) ask_for(positions, vertices_[i + block]);
      const Quad p = load_row(states_[i].position);
      Lanes relative;
      const FilteredDeterminants d(Rows(positions, vertices_[i]), p, relative);
      if constexpr (moved) leave_trail(relative, d, memos_[i]);
      if constexpr (kind == MemoKind::coordinates) leave_coordinates(relative, d, p, memos_[i]);
    }
  }

  // Of all the block: who goes on, or is left, gets another one later.
  DARTCAST_TARGET void leave_trails(std::uint32_t first, std::uint32_t n) {
    for (std::uint32_t k = 0; k < n; ++k) {
      leave_trail(relative_[k], determinants_[k], memos_[first + k]);
    }
  }

  [[gnu::always_inline]] DARTCAST_TARGET void test(std::uint32_t i, std::uint32_t k) {
    const Rows now(now_, vertices_[i]);
    const Quad target = load_row(targets_[i]);
    determinants_[k] = FilteredDeterminants(now, target, relative_[k]);
    inside_[k] = determinants_[k].all_positive();
    if constexpr (moved)
      one_part_[k] = OnePart(memos_[i], relative_[k], load_row(states_[i].position), target, tolerance_).by_size();
  }

  // Ends the steps whose targets lie strictly inside: wherever they come from in the same simplex, nothing is in the
  // way. Lists the others in leaving_.
  DARTCAST_TARGET std::uint32_t end_inside(std::uint32_t first, std::uint32_t n) {
    std::uint32_t leaving = 0;
    std::uint32_t ended = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t i = first + k;
      State& s = states_[i];
      if (s.held || (moved && !one_part_[k] && !is_one_part_after_all(i, k)) || (s.touching_count != 0 && rests(i))) {
        leave(i);
        continue;
      }
      const bool inside = inside_[k];
      leaving_[leaving] = k;
      leaving += inside ? 0 : 1;
      ended += inside ? 1 : 0;
      store_where(inside, load_row(targets_[i]), s.position);
      s.touching_count = inside ? 0 : s.touching_count;
    }
    count_ended(ended);
    return leaving;
  }

  // Of those in leaving_, who goes on. Meanwhile their cells are on the way from memory.
  DARTCAST_TARGET std::uint32_t ride_all(std::uint32_t first, std::uint32_t leaving) {
    for (std::uint32_t l = 0; l < leaving; ++l) {
      __builtin_prefetch(map_.record(states_[first + leaving_[l]].cell));
    }
    if constexpr (!moved) return leaving;
    std::uint32_t riding = 0;
    for (std::uint32_t l = 0; l < leaving; ++l) {
      const std::uint32_t k = leaving_[riding] = leaving_[l];
      riding += ride(first + k) ? 1 : 0;
    }
    return riding;
  }

  // By the finer bound, and the rule itself.
  DARTCAST_TARGET bool is_one_part_after_all(std::uint32_t i, std::uint32_t k) const {
    if (OnePart(memos_[i], relative_[k], load_row(states_[i].position), load_row(targets_[i]), tolerance_).by_shape())
      return true;
    const Rows now(now_, vertices_[i]);
    Vec3 ridden;
    if (!ride_along(memos_[i], now, ridden)) return false;
    const auto [gradient, edge] = deformation(corners_of(Rows(before_, vertices_[i])), corners_of(now));
    return gradient * norm(targets_[i] - ridden) <= 2.0 * tolerance_ * edge;
  }

  // Whether a particle that touches a wall is to stay at its place: it goes on touching it.
  DARTCAST_TARGET bool rests(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position == targets_[i];
    Vec3 ridden;
    return !ride_along(memos_[i], Rows(now_, vertices_[i]), ridden) || ridden == targets_[i];
  }

  // Moves the start of a walk along with the vertices; false where the step is left.
  [[gnu::always_inline]] DARTCAST_TARGET bool ride(std::uint32_t i) {
    const Rows now(now_, vertices_[i]);
    const Vec3 p = states_[i].position;
    left_behind_[i] = FilteredDeterminants(now, load_row(p)).negative() != 0;
    Vec3 ridden;
    if (!ride_along(memos_[i], now, ridden) || ridden == targets_[i]) return leave(i);
    ridden_[i] = load_row(ridden);
    return true;
  }

  // The next simplex of every walk. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t walk_on(std::size_t count) {
    std::size_t next = 0;
    for (std::size_t first = 0; first < count; first += block) {
      const std::size_t n = std::min<std::size_t>(block, count - first);
      for (std::size_t k = 0; k < n; ++k) enter(visits_[first + k], corners_[k]);
      for (std::size_t k = 0; k < n; ++k) {
        determinants_[k] = FilteredDeterminants(Rows(now_, corners_[k]),
                                                load_row(targets_[visits_[first + k].particle]), relative_[k]);
      }
      for (std::size_t k = 0; k < n; ++k) {
        Visit& v = visits_[next] = visits_[first + k];
        v.tests = static_cast<std::uint16_t>(v.tests + 3);
        if (determinants_[k].all_positive()) {
          arrive(v, corners_[k], k);
        } else if (leave_simplex(v, corners_[k], k)) {
          ++next;
        }
      }
    }
    return next;
  }

  // Finds the simplex behind the face that was entered through, and its corners.
  DARTCAST_TARGET void enter(Visit& v, VertexNumbers& corners) const {
    const CellView cell = map_.view(Cell(v.cell));
    if (v.through_face) {
      const Across at = cell.shape().entry(v.index, v.place);
      v.index = at.index;
      v.place = at.place;
    }
    const auto& local = cell.shape().simplices()[v.index].vertex;
    for (unsigned i = 0; i < 4; ++i) corners[i] = cell.vertex(local[i]).value;
    ask_for(now_, corners);
  }

  DARTCAST_TARGET static void ask_for(const Vec3* positions, const VertexNumbers& v) {
    for (unsigned i = 0; i < 4; ++i) {
      __builtin_prefetch(positions + v[i]);
      __builtin_prefetch(&(positions + v[i])->z);
    }
  }

  // Goes on into the next simplex, if the filter says which; else leaves the step.
  DARTCAST_TARGET bool leave_simplex(Visit& visit, const VertexNumbers& corners, std::size_t k) {
    const FilteredDeterminants& d = determinants_[k];
    if (!d.proves_positive()) return leave(visit.particle);
    const unsigned asked = 15U & ~(1U << visit.place);
    unsigned behind = d.negative() & asked;
    unsigned on = 0;
    if (const unsigned open = asked & ~(d.positive() | behind); open != 0) {
      if (!is_exact(Rows(now_, corners), load_row(targets_[visit.particle]))) return leave(visit.particle);
      behind = lanes_set(d.value < 0.0) & asked;
      on = lanes_set(d.value == 0.0) & asked;
      visit.exact = static_cast<std::uint16_t>(visit.exact + std::popcount(open));
    }
    if (behind == 0) {
      if (on != 0) {
        if (const auto wall = find_touched_wall(visit, on)) return end_on_wall(visit, on, *wall);
      }
      arrive(visit, corners, k);
      return false;
    }
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    if ((behind & (behind - 1)) != 0) facet = first_exit(visit, corners, behind);
    return facet < 4 ? pass_on(visit, facet) : leave(visit.particle);
  }

  // The wall that a target lies on that lies on facets of its simplex.
  DARTCAST_TARGET std::optional<SimplexFacet> find_touched_wall(const Visit& visit, unsigned on) const {
    const SimplexId id{Cell(visit.cell), visit.index};
    const CellView cell = map_.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    return find_wall(map_, id, on, feature_of(cell, s, on));
  }

  // Of several facets that the target lies behind, the one by which the segment leaves; 4 where the filter does not
  // say.
  DARTCAST_TARGET unsigned first_exit(Visit& visit, const VertexNumbers& corners, unsigned behind) const {
    const Rows now(now_, corners);
    const std::uint32_t i = visit.particle;
    const Vec3 p = !moved ? states_[i].position : vec_of(ridden_[i]);
    const Vec3& q = targets_[i];
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    while ((behind &= behind - 1) != 0) {
      const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
      const auto& edge = side_edge[facet][other];
      const int first = filtered_sign(vec_of(now.corner[edge[0]]) - q, p - q, vec_of(now.corner[edge[1]]) - q);
      ++visit.tests;
      if (first == 0) return 4;
      if (first < 0) facet = other;
    }
    return facet;
  }

  DARTCAST_TARGET bool pass_on(Visit& visit, unsigned facet) {
    const CellView cell = map_.view(Cell(visit.cell));
    const Across across = cell.shape().simplices()[visit.index].across[facet];
    visit.through_face = across.outer();
    if (!across.outer()) {
      visit.index = across.index;
      visit.place = across.place;
      return true;
    }
    const std::uint16_t face = across.face();
    if (cell.is_wall(face)) return end_at_wall(visit, facet);
    visit.cell = cell.neighbour(face).value;
    visit.index = cell.neighbour_face(face);
    visit.place = cell.shape().triangle_from_other_side(face, across.place);
    __builtin_prefetch(map_.record(Cell(visit.cell)));
    return true;
  }

  // The step is not taken here. Returns false: it does not go on.
  DARTCAST_TARGET bool leave(std::uint32_t i) {
    taken_[i] = taken_nothing;
    return false;
  }
  // The target is beyond a wall.
  [[gnu::cold, gnu::noinline]] DARTCAST_TARGET bool end_at_wall(const Visit& visit, unsigned facet) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = walk.wall_simplex = {Cell(visit.cell), visit.index};
    walk.wall_facet = static_cast<std::uint8_t>(facet);
    return hand_over(visit, walk);
  }
  // The target is on a wall.
  [[gnu::cold, gnu::noinline]] DARTCAST_TARGET bool end_on_wall(const Visit& visit, unsigned on,
                                                                const SimplexFacet& wall) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = {Cell(visit.cell), visit.index};
    walk.zeros = static_cast<std::uint8_t>(on);
    walk.wall_simplex = wall.simplex;
    walk.wall_facet = static_cast<std::uint8_t>(wall.facet);
    walk.at_end = true;
    return hand_over(visit, walk);
  }
  // What follows is not done here. Returns false, too.
  DARTCAST_TARGET bool hand_over(const Visit& visit, const Walk& walk) {
    const std::uint32_t i = visit.particle;
    taken_[i] = static_cast<Taken>(begun_.size());
    begun_.push_back({!moved ? states_[i].position : vec_of(ridden_[i]), walk, {visit.tests, visit.exact}});
    return false;
  }
  DARTCAST_TARGET void leave_all(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) leave(visits_[k].particle);
  }

  DARTCAST_TARGET void arrive(const Visit& visit, const VertexNumbers& corners, std::size_t k) {
    State& s = states_[visit.particle];
    s.put({Cell(visit.cell), visit.index}, targets_[visit.particle]);
    s.touching_count = 0;
    vertices_[visit.particle] = corners;
    ++counters_.particle_steps;
    counters_.orientation.tests += visit.tests;
    counters_.orientation.exact += visit.exact;
    ++counters_.histogram[std::min<std::size_t>(visit.tests, Counters::histogram_size - 1)];
    const bool kept = visit.place == no_facet;
    if constexpr (moved) leave_trail(relative_[k], determinants_[k], memos_[visit.particle]);
    if constexpr (kind == MemoKind::coordinates) keep_coordinates(visit, k, kept);
    counters_.forecast_kept += kept ? 1 : 0;
    if (moved && !kept) counters_.updated_by_deformation += left_behind_[visit.particle] ? 1 : 0;
  }

  // Of the simplex come to; but who passes many in a step is likely to leave that one in the next, too.
  DARTCAST_TARGET void keep_coordinates(const Visit& visit, std::size_t k, bool kept) {
    constexpr std::uint16_t few_tests = 13;  // three simplices
    Memo& memo = memos_[visit.particle];
    if (kept && !is_unknown(memo)) return;
    if (visit.tests > few_tests) return store_four(four(unknown), memo.w);
    leave_coordinates(relative_[k], determinants_[k], load_row(targets_[visit.particle]), memo);
  }

  const Map& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  bool memos_match_;
  double tolerance_;
  std::uint32_t size_;
  State* states_;
  VertexNumbers* vertices_;
  Memo* memos_;
  const Vec3* targets_;
  Taken* taken_;
  std::vector<Begun>& begun_;
  Counters& counters_;

  // Of the block.
  std::array<VertexNumbers, block> corners_;
  std::array<FilteredDeterminants, block> determinants_;
  std::array<Lanes, block> relative_;
  std::array<Quad, block> coordinates_;
  std::array<bool, block> inside_;
  std::array<bool, block> one_part_;
  std::array<std::uint32_t, block> leaving_;

  // Of the batch.
  std::array<Visit, filtered_batch> visits_;        // walks that go on
  std::array<std::uint8_t, filtered_batch> exits_;  // of these, the facet that they leave the first simplex by
  std::array<Quad, filtered_batch> ridden_;         // where particles have ridden to
  std::array<bool, filtered_batch> left_behind_;
};

// Whether every number is 0 or between the two magnitudes.
DARTCAST_TARGET inline bool all_between(const double* x, std::size_t count, double low, double high) {
  Mask outside{};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    const Quad numbers = *reinterpret_cast<const UnalignedQuad*>(x + i);
    const Quad m = magnitude(numbers);
    outside |= ~(((m >= low) & (m <= high)) | (m == 0.0));
  }
  bool rest = true;
  for (; i < count; ++i) rest = rest && (x[i] == 0.0 || (std::abs(x[i]) >= low && std::abs(x[i]) <= high));
  return rest && lanes_set(outside) == 0;
}
