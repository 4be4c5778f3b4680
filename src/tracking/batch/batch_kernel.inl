// The loop of src/tracking/batch/batch.cpp, compiled there once per instruction set: no include guard, and not to be
// included elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function, and lanes_set(Mask). In this
// order:
// clang-format off
#include "tracking/batch/batch_simplex.inl"
#include "tracking/batch/batch_caches.inl"
#include "tracking/batch/batch_impacts.inl"
#include "tracking/batch/batch_records.inl"
// clang-format on

// Simplices are taken block by block, in passes without branches as far as possible: all are found, so that their
// corners are on the way from memory before the first is used; all are tested, four in a vector; then those that are
// left go on. A class for each kind of memo: what is called once is inlined.
template <CacheKind kind>
class Batch {
 public:
  DARTCAST_TARGET Batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters)
      : map_(scene.complex->map()),
        now_(scene.complex->positions().data()),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        caches_match_(scene.caches_match),
        walls_match_(scene.walls_match),
        tolerance_(scene.tolerance),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        caches_(steps.caches.fours.data()),
        marks_(steps.caches.marks.data()),
        targets_(steps.targets.data()),
        taken_(steps.taken.data()),
        partial_(steps.partial),
        impacts_(steps.impacts),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint64_t max_rounds) {
    if (kind != CacheKind::none && !caches_match_) make_caches();
    if (kind == CacheKind::barycentric && !walls_match_) std::fill_n(marks_, size_, CacheFlags{0});
    std::fill_n(taken_, size_, step_complete);
    std::size_t count = kind == CacheKind::barycentric ? begin_by_coordinates() : begin();
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round > max_rounds) {
        for (std::size_t k = 0; k < count; ++k) leave(visits_[k].particle);
        break;
      }
      count = walk_on(count);
    }
    compute_impacts();
    if (facet_arrivals_ != 0) remember_exact();
  }

 private:
  static constexpr std::uint32_t block = 32;
  static constexpr bool moved = kind == CacheKind::previous_geometry;

  // The first simplex of each step: most end there. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t begin() {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) prefetch(now_, vertices_[i]);
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      test_block(first, n);
      const std::uint32_t leaving = carry_all(first, end_inside(first, n));
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        const std::uint32_t* record = map_.record(states_[i].cell);
        const FacetSigns4 signs(signs_[leaving_[l]]);
        if (signs.negative() != 0 && signs.is_known()) {
          departures_[count++] = exit_candidate(i, signs.negative(), signs.open(), record);
        } else {
          WalkCursor cursor = first_cursor(i, states_[i], record, 4, 0);
          leave_simplex(cursor, vertices_[i], leaving_[l]);
        }
      }
    }
    return take_exit(count);
  }

  // The first simplex of each step where vertices stand still: the scene is read by those alone that leave it.
  DARTCAST_TARGET std::size_t begin_by_coordinates() {
    std::size_t count = 0;
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      test_coordinates(first, n);
      const std::uint32_t leaving = end_inside(first, n);
      if (on_facets_ != 0) end_on_facets(first);
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        const std::uint32_t* record = map_.record(states_[i].cell);
        __builtin_prefetch(record);
        const FacetSigns4 signs(signs_[leaving_[l]]);
        const unsigned behind = signs.negative();
        departures_[count] = exit_candidate(i, behind, signs.zero(), record);
        unproved_[unproved_count_] = {i, record};
        if ((behind & (behind - 1)) != 0) prefetch(now_, vertices_[i]);
        const std::size_t proved = behind != 0 ? 1 : 0;
        count += proved;
        unproved_count_ += 1 - proved;
      }
    }
    return take_exit(count);
  }

  // Of particles in a row.
  DARTCAST_TARGET Vec3x4 targets_from(std::uint32_t i) const {
    return i + 4 <= size_ ? load_vec3x4(targets_ + i) : targets_of(index4_from(i, size_));
  }
  DARTCAST_TARGET Vec3x4 targets_of(const Index4& i) const {
    return load_vec3x4(targets_[i.at[0]], targets_[i.at[1]], targets_[i.at[2]], targets_[i.at[3]]);
  }
  DARTCAST_TARGET Vec3x4 places_of(const Index4& i) const {
    return load_vec3x4(states_[i.at[0]].position, states_[i.at[1]].position, states_[i.at[2]].position,
                       states_[i.at[3]].position);
  }
  [[gnu::always_inline]] DARTCAST_TARGET Corners4 simplices_of(const Vec3* positions, const Index4& i) const {
    return Corners4(positions, vertices_[i.at[0]], vertices_[i.at[1]], vertices_[i.at[2]], vertices_[i.at[3]]);
  }

  DARTCAST_TARGET void test_block(std::uint32_t first, std::uint32_t n) {
    inside_ = 0;
    one_part_ = 0;
    carried_inside_ = 0;
    arrivals_ = 0;
    for (std::uint32_t k = 0; k < n; k += 4) {
      ask_ahead(first + k);
      const Index4 i = index4_from(first + k, size_);
      const Corners4 now = simplices_of(now_, i);
      const Vec3x4 q = targets_from(first + k);
      const BatchDeterminants d(now, q);
      const Mask4 signs = d.signs(now, q);
      store_signs(signs, k);
      inside_ |= lanes_set(signs == splat_bits(FacetSigns4::valid)) << k;
      if constexpr (moved) {
        SimplexCache4& previous_caches = caches_[i.at[0] / 4];
        const OnePart one(previous_caches, d.relative, places_of(i), q, tolerance_);
        Mask4 proved = one.by_size();
        if (lanes_set(proved) != 15U) proved |= one.by_shape();
        one_part_ |= lanes_set(proved) << k;
        carried_inside_ |= lanes_set(surely_carried_inside(previous_caches, d, q)) << k;
        began_with_[i.at[0] / 4] = previous_caches.w;
        store_previous_geometry(d, previous_caches);  // who goes on, or is left, gets another one later
      }
    }
  }

  // For four particles from i on, a block before they are tested.
  [[gnu::always_inline]] DARTCAST_TARGET void ask_ahead(std::uint32_t i) const {
    const std::uint32_t end = std::min(i + block + 4, size_);
    for (i += block; i < end; ++i) prefetch(now_, vertices_[i]);
  }

  DARTCAST_TARGET void store_signs(const Mask4& signs, std::size_t k) {
    *reinterpret_cast<UnalignedMask4*>(&signs_[k]) = signs;
  }

  // Signs of coordinates that are proved: bits for each facet that a target is behind, or on; none where any is left
  // open.
  DARTCAST_TARGET void test_coordinates(std::uint32_t first, std::uint32_t n) {
    inside_ = 0;
    on_facets_ = 0;
    still_free_ = 0;
    for (std::uint32_t k = 0; k < n; k += 4) {
      const Vec3x4 q = targets_from(first + k);
      const SimplexCache4& caches = caches_[(first + k) / 4];
      const Double4 c[4] = {coordinate_of(caches, 0, q), coordinate_of(caches, 1, q), coordinate_of(caches, 2, q),
                            coordinate_of(caches, 3, q)};
      const Double4 m[4] = {magnitude(c[0]), magnitude(c[1]), magnitude(c[2]), magnitude(c[3])};
      const Double4 lowest = smaller(smaller(c[0], c[1]), smaller(c[2], c[3]));
      inside_ |= lanes_set(lowest > coordinate_margin) << k;
      const Mask4 in_range = larger(larger(m[0], m[1]), larger(m[2], m[3])) <= max_for_sign;
      const Mask4 known = (smaller(smaller(m[0], m[1]), smaller(m[2], m[3])) > coordinate_margin) & in_range;
      const Mask4 negative = facet_bits(c[0] < 0.0, c[1] < 0.0, c[2] < 0.0, c[3] < 0.0);
      store_signs(known & negative, k);
      if (any_marked(marks_ + first + k)) {
        const Mask4 proved = facet_bits(m[0] > coordinate_margin, m[1] > coordinate_margin, m[2] > coordinate_margin,
                                        m[3] > coordinate_margin);
        test_zeros(first, k, q, in_range, proved, negative);
      }
    }
  }

  // The same where coordinates are exact. A target that lies on facets that its particle lies on, and on no other, is
  // on no wall either: that would reach to the particle.
  [[gnu::noinline]] DARTCAST_TARGET void test_zeros(std::uint32_t first, std::uint32_t k, const Vec3x4& q,
                                                    const Mask4& in_range, const Mask4& proved, const Mask4& negative) {
    const CacheFlags* of_four = marks_ + first + k;
    const Mask4 marks = {of_four[0], of_four[1], of_four[2], of_four[3]};
    const Mask4 zeros = proved_zeros(caches_[(first + k) / 4], q) & ((marks & splat_bits(exact_flag)) != 0);
    const Mask4 known = in_range & ((proved | zeros) == splat_bits(15));
    store_signs(known & (negative | (zeros << 4)), k);
    const Mask4 on_facets = known & (negative == 0) & (zeros != 0);
    const Mask4 still_free = on_facets & ((zeros & ~marks) == 0);
    on_facets_ |= lanes_set(on_facets & ~still_free) << k;
    still_free_ |= lanes_set(still_free) << k;
    inside_ |= lanes_set(still_free) << k;
    mark_zeros(zeros, inside_ >> k, marks_ + first + k);
  }

  // The first way out of each walk. Which of them lead out of their cell cannot be foretold: those come last, in a row.
  // Walks of whose targets nothing is proved come first: they are to be tested where they are.
  DARTCAST_TARGET std::size_t take_exit(std::size_t count) {
    std::size_t next = 0;
    for (; next < unproved_count_; ++next) {
      const auto [i, record] = unproved_[next];
      visits_[next] = first_cursor(i, states_[i], record, 1, 0);  // three more tests there
    }
    std::size_t outward = 0;
    for (std::size_t k = 0; k < count; ++k) {
      auto [i, behind, exact, record] = departures_[k];
      const ParticleState& s = states_[i];
      std::uint16_t tests = 4;
      auto facet = static_cast<unsigned>(std::countr_zero(behind));
      if (!std::has_single_bit(behind)) {
        WalkCursor cursor = first_cursor(i, s, record, tests, exact);
        facet = first_exit(cursor, vertices_[i], behind);
        tests = cursor.tests;
        exact = cursor.exact;
      }
      // Numbers, not records that were just written: these could not be read as a whole yet.
      const Across across = map_.view(s.cell, record).shape().simplices()[s.simplex].across[facet];
      visits_[next] = {i, s.cell.value, across.index, across.place, tests, exact, false, record};
      outward_[outward] = {i, across, static_cast<std::uint16_t>(facet), tests, exact, record};
      const std::size_t leaves = across.index / Across::outer_bit;
      next += 1 - leaves;
      outward += leaves;
    }
    for (std::size_t k = 0; k < outward; ++k) {
      const auto& [i, across, facet, tests, exact, record] = outward_[k];
      visits_[next] = first_cursor(i, states_[i], record, tests, exact);
      if (pass_face(visits_[next], vertices_[i], facet, across)) ++next;
    }
    return next;
  }

  // For particles that have none of this kind: trails, of where they were before the move, or coordinates.
  DARTCAST_TARGET void make_caches() {
    const Vec3* positions = moved ? before_ : now_;
    for (std::uint32_t first = 0; first < size_; first += 4) {
      for (std::uint32_t i = first + block; i < std::min(first + block + 4, size_); ++i)
        prefetch(positions, vertices_[i]);
      const Index4 i = index4_from(first, size_);
      const Vec3x4 p = places_of(i);
      const BatchDeterminants d(simplices_of(positions, i), p);
      if constexpr (moved) store_previous_geometry(d, caches_[first / 4]);
      if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(d, p, caches_[first / 4]);
    }
    if constexpr (kind == CacheKind::barycentric) std::fill_n(marks_, size_, CacheFlags{0});
  }

  // Ends the steps whose targets lie strictly inside: wherever they come from in the same simplex, nothing is in the
  // way. Lists the others in leaving_.
  DARTCAST_TARGET std::uint32_t end_inside(std::uint32_t first, std::uint32_t n) {
    const std::uint32_t all = n == block ? ~std::uint32_t{0} : (std::uint32_t{1} << n) - 1;
    std::uint32_t left = 0;
    for (std::uint32_t unusual = all & (held_or_touching(states_, size_, first, n) | (moved ? ~one_part_ : 0));
         unusual != 0; unusual &= unusual - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(unusual));
      if (is_left(first + k, k)) left |= std::uint32_t{1} << k;
    }
    inside_ &= all & ~left;
    on_facets_ &= all & ~left;
    if constexpr (kind == CacheKind::barycentric) {
      for (std::uint32_t on = inside_ & still_free_; on != 0; on &= on - 1)
        counters_.orientation.exact += static_cast<unsigned>(
            std::popcount(FacetSigns4(signs_[static_cast<std::size_t>(std::countr_zero(on))]).zero()));
    }
    for (std::uint32_t in = inside_; in != 0; in &= in - 1) {
      const std::uint32_t i = first + static_cast<std::uint32_t>(std::countr_zero(in));
      states_[i].position = targets_[i];
      states_[i].touching_count = 0;
    }
    const auto ended = static_cast<std::uint64_t>(std::popcount(inside_));
    counters_.particle_steps += ended;
    counters_.orientation.tests += 4 * ended;
    counters_.histogram[4] += ended;
    counters_.forecast_kept += ended;
    std::uint32_t leaving = 0;
    for (std::uint32_t on = all & ~left & ~inside_ & ~on_facets_; on != 0; on &= on - 1)
      leaving_[leaving++] = static_cast<std::uint32_t>(std::countr_zero(on));
    return leaving;
  }

  // Ends the steps whose targets lie on facets of the simplex that the particle is in.
  [[gnu::noinline]] DARTCAST_TARGET void end_on_facets(std::uint32_t first) {
    for (std::uint32_t bits = on_facets_; bits != 0; bits &= bits - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(bits));
      const std::uint32_t i = first + k;
      const unsigned on = FacetSigns4(signs_[k]).zero();
      const WalkCursor cursor = first_cursor(i, states_[i], map_.record(states_[i].cell), 4, std::popcount(on));
      if (const auto wall = find_touched_wall(map_, cursor, vertices_[i], on)) {
        end_on_wall(cursor, on, *wall);
      } else {
        end(cursor);
        marks_[i] = static_cast<CacheFlags>(exact_flag | on);
      }
    }
  }

  // Leaves a step that is held, or is to be split, or stays where it touches a wall.
  DARTCAST_TARGET bool is_left(std::uint32_t i, std::uint32_t k) {
    const ParticleState& s = states_[i];
    const bool one_part = !moved || ((one_part_ >> k) & 1U) != 0;
    if (!s.held && (one_part || is_one_part_by_rule(i)) && (s.touching_count == 0 || !rests(i))) return false;
    leave(i);
    return true;
  }

  // Where a particle with these determinants has ridden to, in the simplex that its step begins in.
  [[nodiscard]] DARTCAST_TARGET Vec3 carried(std::uint32_t i, const Weights& w) const {
    return flushed(combine(corners_of(now_, vertices_[i]), shares_of(w)));
  }
  // None where the filter does not prove that this lies inside of the moved simplex, as of nothing that is unknown.
  [[nodiscard]] DARTCAST_TARGET std::optional<Vec3> carried_alone(std::uint32_t i) const {
    const Vec3 x = carried(i, determinants_of(began_with_.data(), i));
    return Determinants(corners_of(now_, vertices_[i]), x).all_proved_positive() ? std::optional(x) : std::nullopt;
  }

  // By the rule itself.
  [[nodiscard]] DARTCAST_TARGET bool is_one_part_by_rule(std::uint32_t i) const {
    const auto carried = carried_alone(i);
    if (!carried) return false;
    const auto [gradient, edge] =
        displacement_gradient(corners_of(before_, vertices_[i]), corners_of(now_, vertices_[i]));
    return gradient * norm(targets_[i] - *carried) <= 2.0 * tolerance_ * edge;
  }

  // Whether a particle that touches a wall is to stay at its place: it goes on touching it.
  [[nodiscard]] DARTCAST_TARGET bool rests(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position == targets_[i];
    const auto carried = carried_alone(i);
    return !carried || *carried == targets_[i];
  }

  // Of those in leaving_, who goes on. Meanwhile their cells are on the way from memory.
  DARTCAST_TARGET std::uint32_t carry_all(std::uint32_t first, std::uint32_t leaving) {
    for (std::uint32_t l = 0; l < leaving; ++l) {
      __builtin_prefetch(map_.record(states_[first + leaving_[l]].cell));
    }
    if constexpr (!moved) return leaving;
    std::uint32_t riding = 0;
    for (std::uint32_t l = 0; l < leaving; l += 4) {
      const std::uint32_t last = leaving - 1;
      const Index4 i = {{first + leaving_[l], first + leaving_[std::min(l + 1, last)],
                         first + leaving_[std::min(l + 2, last)], first + leaving_[std::min(l + 3, last)]}};
      riding = ride(i, std::min(leaving - l, 4U), riding, first);
    }
    return riding;
  }

  // Of four walks, lists those that go on from `riding` on: their starts, moved along with the vertices, are proved to
  // lie inside. The others are left.
  DARTCAST_TARGET std::uint32_t ride(const Index4& i, std::uint32_t count, std::uint32_t riding, std::uint32_t first) {
    const Corners4 now = simplices_of(now_, i);
    const unsigned behind = lanes_set(BatchDeterminants(now, places_of(i)).any_negative());
    unsigned on = 0;
    for (std::uint32_t l = 0; l < 4; ++l) on |= ((carried_inside_ >> (i.at[l] - first)) & 1U) << l;
    if (on != 15U) on |= carried_inside(began_with_.data(), i, now, targets_of(i));
    for (std::uint32_t l = 0; l < count; ++l) {
      const std::uint32_t particle = i.at[l];
      if (((on >> l) & 1U) == 0) {
        leave(particle);
        continue;
      }
      left_behind_[particle] = ((behind >> l) & 1U) != 0;
      leaving_[riding++] = particle - first;
    }
    return riding;
  }

  // The next simplex of every walk. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t walk_on(std::size_t count) {
    std::size_t next = 0;
    for (std::size_t first = 0; first < count; first += block) {
      const std::size_t n = std::min<std::size_t>(block, count - first);
      for (std::size_t k = 0; k < n; ++k) enter(visits_[first + k], corners_[k]);
      for (std::size_t k = 0; k < n; k += 4) test_visits(&visits_[first], k, n - 1);
      arrivals_ = 0;
      for (std::size_t k = 0; k < n; ++k) {
        WalkCursor& v = visits_[next] = visits_[first + k];
        v.tests = static_cast<std::uint16_t>(v.tests + 3);
        if (FacetSigns4(signs_[k]).is_inside()) {
          arrive(v, corners_[k], k);
        } else if (leave_simplex(v, corners_[k], k)) {
          ++next;
        }
      }
      if constexpr (kind != CacheKind::none) remember_arrivals();
    }
    return next;
  }

  [[gnu::always_inline]] DARTCAST_TARGET void test_visits(const WalkCursor* visits, std::size_t k, std::size_t last) {
    const std::size_t k1 = std::min(k + 1, last);
    const std::size_t k2 = std::min(k + 2, last);
    const std::size_t k3 = std::min(k + 3, last);
    const Corners4 v(now_, corners_[k], corners_[k1], corners_[k2], corners_[k3]);
    const Vec3x4 q = targets_of({{visits[k].particle, visits[k1].particle, visits[k2].particle, visits[k3].particle}});
    const BatchDeterminants& d = *new (&determinants_[k / 4]) BatchDeterminants(v, q);
    store_signs(d.signs(v, q), k);
    if constexpr (kind == CacheKind::barycentric) ends_[k / 4] = q;
  }

  // Finds the simplex behind the face that was entered through, and its corners.
  DARTCAST_TARGET void enter(WalkCursor& v, VertexNumbers& corners) const {
    if (kind == CacheKind::barycentric && !v.through_face && v.place == no_facet) {  // where the step began
      corners = vertices_[v.particle];
      prefetch(now_, corners);
      return;
    }
    const CellView cell = map_.view(Cell(v.cell), v.record);
    if (v.through_face) {
      const Across at = cell.shape().entry(v.index, v.place);
      v.index = at.index;
      v.place = at.place;
    }
    const auto& local = cell.shape().simplices()[v.index].vertex;
    for (unsigned i = 0; i < 4; ++i) corners[i] = cell.vertex(local[i]).value;
    prefetch(now_, corners);
  }

  // Goes on into the next simplex, if the filter says which; else leaves the step. k: its place in the block.
  DARTCAST_TARGET bool leave_simplex(WalkCursor& cursor, const VertexNumbers& corners, std::size_t k) {
    const FacetSigns4 signs(signs_[k]);
    const unsigned asked = 15U & ~(1U << cursor.place);
    if (!signs.is_known(asked)) return leave(cursor.particle);
    const unsigned open = signs.open() & asked;
    cursor.exact = static_cast<std::uint16_t>(cursor.exact + std::popcount(open));
    const unsigned behind = signs.negative() & asked;
    if (behind == 0) {
      const unsigned on = signs.zero() & asked;
      if (on != 0) {
        if (const auto wall = find_touched_wall(map_, cursor, corners, on)) return end_on_wall(cursor, on, *wall);
      }
      on == 0 ? arrive(cursor, corners, k) : arrive_on_facets(cursor, corners, k, on);
      return false;
    }
    const bool single = std::has_single_bit(behind);
    return pass_on(cursor, corners,
                   single ? static_cast<unsigned>(std::countr_zero(behind)) : first_exit(cursor, corners, behind));
  }

  // Of several facets that the target lies behind, the one by which the segment leaves.
  DARTCAST_TARGET unsigned first_exit(WalkCursor& cursor, const VertexNumbers& corners, unsigned behind) const {
    const std::uint32_t i = cursor.particle;
    const Vec3 p = start_of(i);
    const Vec3& q = targets_[i];
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    while ((behind &= behind - 1) != 0) {
      const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
      const auto& edge = side_edge[facet][other];
      const Vec3& a = now_[corners[edge[0]]];
      const Vec3& b = now_[corners[edge[1]]];
      const int first = filtered_sign(a - q, p - q, b - q);
      ++cursor.tests;
      cursor.exact = static_cast<std::uint16_t>(cursor.exact + (first == 0 ? 1 : 0));
      if (first < 0 || (first == 0 && !passes_before(i, a, b, p, q))) facet = other;
    }
    return facet;
  }

  // As leaves_before() in tracking/walk.hpp, where the filter does not say.
  [[gnu::noinline]] DARTCAST_TARGET bool passes_before(std::uint32_t i, const Vec3& a, const Vec3& b, const Vec3& p,
                                                       const Vec3& q) const {
    Sign s = p == a || p == b ? Sign::zero : orient3d_exact(a, b, p, q);
    if (s == Sign::zero) {
      const Space<Stored, 4> space{&map_, {now_}, 0};
      std::optional<unsigned> zeros;
      if (kind == CacheKind::barycentric && (marks_[i] & exact_flag) != 0) zeros = marks_[i] & 15U;
      s = Ties<Stored, 4>(space, states_[i].at(), p, q, zeros).line(a, b);
    }
    return s == Sign::positive;
  }

  // Few walks ask where they began: those that come to a wall, or to several facets that the target is behind.
  [[nodiscard]] DARTCAST_TARGET Vec3 start_of(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position;
    return carried(i, determinants_of(began_with_.data(), i));
  }

  DARTCAST_TARGET bool pass_on(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet) {
    const Across across = across_of(cursor, facet);
    if (across.outer()) return pass_face(cursor, corners, facet, across);
    cursor.through_face = false;
    cursor.index = across.index;
    cursor.place = across.place;
    return true;
  }

  [[nodiscard]] DARTCAST_TARGET Across across_of(const WalkCursor& cursor, unsigned facet) const {
    return map_.view(Cell(cursor.cell), cursor.record).shape().simplices()[cursor.index].across[facet];
  }

  // Into the cell beyond.
  DARTCAST_TARGET bool pass_face(WalkCursor& cursor, const VertexNumbers& corners, unsigned facet, Across across) {
    const CellView cell = map_.view(Cell(cursor.cell), cursor.record);
    const std::uint16_t face = across.face();
    if (cell.is_wall(face)) return end_at_wall(cursor, corners, facet);
    cursor.through_face = true;
    cursor.cell = cell.neighbour(face).value;
    cursor.index = cell.neighbour_face(face);
    cursor.place = cell.shape().triangle_from_other_side(face, across.place);
    cursor.record = map_.record(Cell(cursor.cell));
    __builtin_prefetch(cursor.record);
    return true;
  }

  // The step is not taken here. Returns false: it does not go on.
  DARTCAST_TARGET bool leave(std::uint32_t i) {
    taken_[i] = step_untouched;
    return false;
  }
  // The target is beyond a wall.
  [[gnu::cold, gnu::noinline]] DARTCAST_TARGET bool end_at_wall(const WalkCursor& cursor, const VertexNumbers& corners,
                                                                unsigned facet) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = walk.wall_simplex = {Cell(cursor.cell), cursor.index};
    walk.wall_facet = static_cast<std::uint8_t>(facet);
    at_walls_[at_wall_count_++] = {cursor.particle, static_cast<StepStatus>(partial_.size()), walk.wall_facet, corners};
    return hand_over(cursor, walk);
  }
  // The target is on a wall.
  [[gnu::cold, gnu::noinline]] DARTCAST_TARGET bool end_on_wall(const WalkCursor& cursor, unsigned on,
                                                                const SimplexFacet& wall) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = {Cell(cursor.cell), cursor.index};
    walk.zeros = static_cast<std::uint8_t>(on);
    walk.wall_simplex = wall.simplex;
    walk.wall_facet = static_cast<std::uint8_t>(wall.facet);
    walk.at_end = true;
    return hand_over(cursor, walk);
  }
  // What follows is not done here. Returns false, too.
  DARTCAST_TARGET bool hand_over(const WalkCursor& cursor, const Walk& walk) {
    const std::uint32_t i = cursor.particle;
    if constexpr (moved) {  // what follows asks how the wall has moved
      const CellView cell = map_.view(walk.wall_simplex.cell);
      for (const std::uint16_t local : cell.shape().simplices()[walk.wall_simplex.simplex].vertex)
        __builtin_prefetch(before_ + cell.vertex(local).value);
    }
    taken_[i] = static_cast<StepStatus>(partial_.size());
    partial_.emplace_back(start_of(i), walk, TestCounts{cursor.tests, cursor.exact});
    return false;
  }

  // What follows at walls, where doubles prove it.
  DARTCAST_TARGET void compute_impacts() {
    impacts_.reserve(at_wall_count_);
    for (std::uint32_t k = 0; k < at_wall_count_; k += 4) land(k);
  }

  DARTCAST_TARGET void land(std::uint32_t k) {
    const std::uint32_t last = at_wall_count_ - 1;
    const AtWalls at = {&at_walls_[k], &at_walls_[std::min(k + 1, last)], &at_walls_[std::min(k + 2, last)],
                        &at_walls_[std::min(k + 3, last)]};
    WallImpact4 impacts(at, partial_, now_, targets_);
    if (lanes_set(impacts.known) == 0) return;
    impacts.put(Corners4(now_, at[0]->corners, at[1]->corners, at[2]->corners, at[3]->corners));
    if constexpr (moved) impacts.move_walls(at, before_);
    SimplexCache4 caches;
    if constexpr (moved) store_previous_geometry(impacts.there, caches);
    if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(impacts.there, impacts.position, caches);
    for (std::uint32_t l = 0; l < 4 && k + l < at_wall_count_; ++l) {
      if (impacts.known[l] == 0) continue;
      const std::uint32_t i = at[l]->particle;
      PartialStep& partial = partial_[at[l]->partial];
      impacts_.push_back(impacts.of(l));
      partial.impact = &impacts_.back();
      ++partial.tests.tests;  // on which side p is
      vertices_[i] = at[l]->corners;
      if constexpr (kind == CacheKind::none) continue;
      if (moved || partial.tests.tests <= short_tests) {
        caches_[i / 4].put(i % 4, caches.of(l));
        if (!moved) marks_[i] = 0;
      } else {
        forget(caches_, marks_, i);
      }
    }
  }
  DARTCAST_TARGET void arrive(const WalkCursor& cursor, const VertexNumbers& corners, std::size_t k) {
    end(cursor);
    vertices_[cursor.particle] = corners;
    arrival_[arrivals_] = {cursor.particle, static_cast<std::uint32_t>(k)};
    arrivals_ += kind != CacheKind::barycentric || needs_coordinates(cursor) ? 1 : 0;
  }

  DARTCAST_TARGET void end(const WalkCursor& cursor) {
    ParticleState& s = states_[cursor.particle];
    s.put({Cell(cursor.cell), cursor.index}, targets_[cursor.particle]);
    s.touching_count = 0;
    count_step(cursor, counters_);
    if (moved && cursor.place != no_facet) counters_.updated_by_deformation += left_behind_[cursor.particle] ? 1 : 0;
  }

  static constexpr std::uint16_t short_tests = 13;  // three simplices

  // Who passes many simplices in a step is likely to leave the last one in the next, too: it gets none.
  DARTCAST_TARGET bool needs_coordinates(const WalkCursor& cursor) {
    const std::uint32_t i = cursor.particle;
    if (cursor.place == no_facet && has_coordinates(caches_, i)) {
      marks_[i] &= exact_flag;
      return false;
    }
    marks_[i] = 0;
    if (cursor.tests <= short_tests) return true;
    forget(caches_, marks_, i);
    return false;
  }

  // At a target on facets of the simplex. The next is likely to be on some, too: of coordinates, exact ones are kept.
  [[gnu::noinline]] DARTCAST_TARGET void arrive_on_facets(const WalkCursor& cursor, const VertexNumbers& corners,
                                                          std::size_t k, unsigned on) {
    if constexpr (kind != CacheKind::barycentric) return arrive(cursor, corners, k);
    const std::uint32_t i = cursor.particle;
    end(cursor);
    vertices_[i] = corners;
    if (cursor.place != no_facet || !has_coordinates(caches_, i)) forget(caches_, marks_, i);
    if ((marks_[i] & exact_flag) != 0)
      marks_[i] = static_cast<CacheFlags>(exact_flag | on);
    else if (cursor.tests <= short_tests)
      facet_arrival_[facet_arrivals_++] = {i, static_cast<CacheFlags>(on)};
  }

  // Keeps memos of the simplices that walks of the block have ended in.
  DARTCAST_TARGET void remember_arrivals() {
    SimplexCache4 four;
    for (std::uint32_t a = 0; a < arrivals_;) {
      const std::uint32_t k = arrival_[a].place / 4;
      if constexpr (moved) store_previous_geometry(determinants_[k], four);
      if constexpr (kind == CacheKind::barycentric) store_barycentric<false>(determinants_[k], ends_[k], four);
      for (; a < arrivals_ && arrival_[a].place / 4 == k; ++a) {
        const std::uint32_t i = arrival_[a].particle;
        caches_[i / 4].put(i % 4, four.of(arrival_[a].place % 4));
      }
    }
  }

  // Of the batch, where targets lie on facets. Few of a block's walks do: four of them are taken together.
  [[gnu::noinline]] DARTCAST_TARGET void remember_exact() {
    SimplexCache4 four;
    for (std::uint32_t a = 0; a < facet_arrivals_; a += 4) {
      const Index4 at = index4_from(a, facet_arrivals_);
      const Index4 i = particles_of(facet_arrival_.data(), at);
      const Vec3x4 q = targets_of(i);
      const unsigned exact = store_barycentric<true>(BatchDeterminants(simplices_of(now_, i), q), q, four);
      for (std::uint32_t l = 0; l < 4; ++l) {
        if (((exact >> l) & 1U) == 0) continue;
        caches_[i.at[l] / 4].put(i.at[l] % 4, four.of(l));
        marks_[i.at[l]] = exact_flag | facet_arrival_[at.at[l]].on;
      }
    }
  }

  const CombinatorialMap& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  bool caches_match_;
  bool walls_match_;
  double tolerance_;
  std::uint32_t size_;
  ParticleState* states_;
  VertexNumbers* vertices_;
  SimplexCache4* caches_;
  CacheFlags* marks_;
  const Vec3* targets_;
  StepStatus* taken_;
  std::vector<PartialStep>& partial_;
  std::vector<WallImpact>& impacts_;
  Counters& counters_;

  // Of the block. Bits: one per particle.
  std::array<VertexNumbers, block> corners_;
  std::array<BatchDeterminants, block / 4> determinants_;
  std::array<Vec3x4, block / 4> ends_;  // of walks
  std::array<long long, block> signs_;
  std::uint32_t inside_;
  std::uint32_t on_facets_ = 0;
  std::uint32_t still_free_;
  std::uint32_t one_part_;
  std::uint32_t carried_inside_;
  std::array<std::uint32_t, block> leaving_;
  std::array<Arrival, block> arrival_;
  std::uint32_t arrivals_;

  // Of the batch.
  std::array<AtWall, max_batch> at_walls_;
  std::uint32_t at_wall_count_ = 0;
  std::array<WalkCursor, max_batch> visits_;  // walks that go on
  std::array<ExitCandidate, max_batch> departures_;
  std::array<UndecidedExit, max_batch> unproved_;
  std::size_t unproved_count_ = 0;
  std::array<CellExit, max_batch> outward_;
  std::array<SimplexCache4::Table<double>, max_batch / 4> began_with_;  // determinants before the move
  std::array<bool, max_batch> left_behind_;
  std::array<FacetArrival, max_batch> facet_arrival_;
  std::uint32_t facet_arrivals_ = 0;
};
