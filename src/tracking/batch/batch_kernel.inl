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
template <MemoKind kind>
class Batch {
 public:
  DARTCAST_TARGET Batch(const FilteredScene& scene, const FilteredSteps& steps, Counters& counters)
      : map_(scene.complex->map()),
        now_(scene.complex->positions().data()),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        memos_match_(scene.memos_match),
        walls_match_(scene.walls_match),
        tolerance_(scene.tolerance),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        memos_(steps.memos.fours.data()),
        marks_(steps.memos.marks.data()),
        targets_(steps.targets.data()),
        taken_(steps.taken.data()),
        begun_(steps.begun),
        landings_(steps.landings),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint64_t most_rounds) {
    if (kind != MemoKind::none && !memos_match_) make_memos();
    if (kind == MemoKind::coordinates && !walls_match_) std::fill_n(marks_, size_, Mark{0});
    std::fill_n(taken_, size_, taken_all);
    std::size_t count = kind == MemoKind::coordinates ? begin_by_coordinates() : begin();
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round > most_rounds) {
        for (std::size_t k = 0; k < count; ++k) leave(visits_[k].particle);
        break;
      }
      count = walk_on(count);
    }
    land_all();
    if (facet_arrivals_ != 0) remember_exact();
  }

 private:
  static constexpr std::uint32_t block = 32;
  static constexpr bool moved = kind == MemoKind::trail;

  // The first simplex of each step: most end there. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t begin() {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) ask_for(now_, vertices_[i]);
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      test_block(first, n);
      const std::uint32_t leaving = ride_all(first, end_inside(first, n));
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        const std::uint32_t* record = map_.record(states_[i].cell);
        const Signs signs(signs_[leaving_[l]]);
        if (signs.negative() != 0 && signs.is_known()) {
          departures_[count++] = departure(i, signs.negative(), signs.open(), record);
        } else {
          Visit visit = first_visit(i, states_[i], record, 4, 0);
          leave_simplex(visit, vertices_[i], leaving_[l]);
        }
      }
    }
    return depart(count);
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
        const Signs signs(signs_[leaving_[l]]);
        const unsigned behind = signs.negative();
        departures_[count] = departure(i, behind, signs.zero(), record);
        unproved_[unproved_count_] = {i, record};
        if ((behind & (behind - 1)) != 0) ask_for(now_, vertices_[i]);
        const std::size_t proved = behind != 0 ? 1 : 0;
        count += proved;
        unproved_count_ += 1 - proved;
      }
    }
    return depart(count);
  }

  // Of particles in a row.
  DARTCAST_TARGET Points targets_from(std::uint32_t i) const {
    return i + 4 <= size_ ? load_points(targets_ + i) : targets_of(four_from(i, size_));
  }
  DARTCAST_TARGET Points targets_of(const Four& i) const {
    return load_points(targets_[i.at[0]], targets_[i.at[1]], targets_[i.at[2]], targets_[i.at[3]]);
  }
  DARTCAST_TARGET Points places_of(const Four& i) const {
    return load_points(states_[i.at[0]].position, states_[i.at[1]].position, states_[i.at[2]].position,
                       states_[i.at[3]].position);
  }
  [[gnu::always_inline]] DARTCAST_TARGET Tetrahedra simplices_of(const Vec3* positions, const Four& i) const {
    return Tetrahedra(positions, vertices_[i.at[0]], vertices_[i.at[1]], vertices_[i.at[2]], vertices_[i.at[3]]);
  }

  DARTCAST_TARGET void test_block(std::uint32_t first, std::uint32_t n) {
    inside_ = 0;
    one_part_ = 0;
    rides_inside_ = 0;
    arrivals_ = 0;
    for (std::uint32_t k = 0; k < n; k += 4) {
      ask_ahead(first + k);
      const Four i = four_from(first + k, size_);
      const Tetrahedra now = simplices_of(now_, i);
      const Points q = targets_from(first + k);
      const FilteredDeterminants d(now, q);
      const Mask signs = d.signs(now, q);
      store_signs(signs, k);
      inside_ |= lanes_set(signs == splat_bits(Signs::valid)) << k;
      if constexpr (moved) {
        MemosOfFour& trails = memos_[i.at[0] / 4];
        const OnePart one(trails, d.relative, places_of(i), q, tolerance_);
        Mask proved = one.by_size();
        if (lanes_set(proved) != 15U) proved |= one.by_shape();
        one_part_ |= lanes_set(proved) << k;
        rides_inside_ |= lanes_set(surely_rides_inside(trails, d, q)) << k;
        began_with_[i.at[0] / 4] = trails.w;
        leave_trails(d, trails);  // who goes on, or is left, gets another one later
      }
    }
  }

  // For four particles from i on, a block before they are tested.
  [[gnu::always_inline]] DARTCAST_TARGET void ask_ahead(std::uint32_t i) const {
    const std::uint32_t end = std::min(i + block + 4, size_);
    for (i += block; i < end; ++i) ask_for(now_, vertices_[i]);
  }

  DARTCAST_TARGET void store_signs(const Mask& signs, std::size_t k) {
    *reinterpret_cast<UnalignedMask*>(&signs_[k]) = signs;
  }

  // Signs of coordinates that are proved: bits for each facet that a target is behind, or on; none where any is left
  // open.
  DARTCAST_TARGET void test_coordinates(std::uint32_t first, std::uint32_t n) {
    inside_ = 0;
    on_facets_ = 0;
    still_free_ = 0;
    for (std::uint32_t k = 0; k < n; k += 4) {
      const Points q = targets_from(first + k);
      const MemosOfFour& memos = memos_[(first + k) / 4];
      const Quad c[4] = {coordinate_of(memos, 0, q), coordinate_of(memos, 1, q), coordinate_of(memos, 2, q),
                         coordinate_of(memos, 3, q)};
      const Quad m[4] = {magnitude(c[0]), magnitude(c[1]), magnitude(c[2]), magnitude(c[3])};
      const Quad least = smaller(smaller(c[0], c[1]), smaller(c[2], c[3]));
      inside_ |= lanes_set(least > coordinate_margin) << k;
      const Mask in_range = larger(larger(m[0], m[1]), larger(m[2], m[3])) <= most_for_sign;
      const Mask known = (smaller(smaller(m[0], m[1]), smaller(m[2], m[3])) > coordinate_margin) & in_range;
      const Mask negative = facet_bits(c[0] < 0.0, c[1] < 0.0, c[2] < 0.0, c[3] < 0.0);
      store_signs(known & negative, k);
      if (any_marked(marks_ + first + k)) {
        const Mask proved = facet_bits(m[0] > coordinate_margin, m[1] > coordinate_margin, m[2] > coordinate_margin,
                                       m[3] > coordinate_margin);
        test_zeros(first, k, q, in_range, proved, negative);
      }
    }
  }

  // The same where coordinates are exact. A target that lies on facets that its particle lies on, and on no other, is
  // on no wall either: that would reach to the particle.
  [[gnu::noinline]] DARTCAST_TARGET void test_zeros(std::uint32_t first, std::uint32_t k, const Points& q,
                                                    const Mask& in_range, const Mask& proved, const Mask& negative) {
    const Mark* of_four = marks_ + first + k;
    const Mask marks = {of_four[0], of_four[1], of_four[2], of_four[3]};
    const Mask zeros = proved_zeros(memos_[(first + k) / 4], q) & ((marks & splat_bits(exact_mark)) != 0);
    const Mask known = in_range & ((proved | zeros) == splat_bits(15));
    store_signs(known & (negative | (zeros << 4)), k);
    const Mask on_facets = known & (negative == 0) & (zeros != 0);
    const Mask still_free = on_facets & ((zeros & ~marks) == 0);
    on_facets_ |= lanes_set(on_facets & ~still_free) << k;
    still_free_ |= lanes_set(still_free) << k;
    inside_ |= lanes_set(still_free) << k;
    mark_zeros(zeros, inside_ >> k, marks_ + first + k);
  }

  // The first way out of each walk. Which of them lead out of their cell cannot be foretold: those come last, in a row.
  // Walks of whose targets nothing is proved come first: they are to be tested where they are.
  DARTCAST_TARGET std::size_t depart(std::size_t count) {
    std::size_t next = 0;
    for (; next < unproved_count_; ++next) {
      const auto [i, record] = unproved_[next];
      visits_[next] = first_visit(i, states_[i], record, 1, 0);  // three more tests there
    }
    std::size_t outward = 0;
    for (std::size_t k = 0; k < count; ++k) {
      auto [i, behind, exact, record] = departures_[k];
      const State& s = states_[i];
      std::uint16_t tests = 4;
      auto facet = static_cast<unsigned>(std::countr_zero(behind));
      if (!std::has_single_bit(behind)) {
        Visit visit = first_visit(i, s, record, tests, exact);
        facet = first_exit(visit, vertices_[i], behind);
        tests = visit.tests;
        exact = visit.exact;
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
      visits_[next] = first_visit(i, states_[i], record, tests, exact);
      if (pass_face(visits_[next], vertices_[i], facet, across)) ++next;
    }
    return next;
  }

  // For particles that have none of this kind: trails, of where they were before the move, or coordinates.
  DARTCAST_TARGET void make_memos() {
    const Vec3* positions = moved ? before_ : now_;
    for (std::uint32_t first = 0; first < size_; first += 4) {
      for (std::uint32_t i = first + block; i < std::min(first + block + 4, size_); ++i)
        ask_for(positions, vertices_[i]);
      const Four i = four_from(first, size_);
      const Points p = places_of(i);
      const FilteredDeterminants d(simplices_of(positions, i), p);
      if constexpr (moved) leave_trails(d, memos_[first / 4]);
      if constexpr (kind == MemoKind::coordinates) leave_coordinates<false>(d, p, memos_[first / 4]);
    }
    if constexpr (kind == MemoKind::coordinates) std::fill_n(marks_, size_, Mark{0});
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
    if constexpr (kind == MemoKind::coordinates) {
      for (std::uint32_t on = inside_ & still_free_; on != 0; on &= on - 1)
        counters_.orientation.exact +=
            static_cast<unsigned>(std::popcount(Signs(signs_[static_cast<std::size_t>(std::countr_zero(on))]).zero()));
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
      const unsigned on = Signs(signs_[k]).zero();
      const Visit visit = first_visit(i, states_[i], map_.record(states_[i].cell), 4, std::popcount(on));
      if (const auto wall = find_touched_wall(map_, visit, vertices_[i], on)) {
        end_on_wall(visit, on, *wall);
      } else {
        end(visit);
        marks_[i] = static_cast<Mark>(exact_mark | on);
      }
    }
  }

  // Leaves a step that is held, or is to be split, or stays where it touches a wall.
  DARTCAST_TARGET bool is_left(std::uint32_t i, std::uint32_t k) {
    const State& s = states_[i];
    const bool one_part = !moved || ((one_part_ >> k) & 1U) != 0;
    if (!s.held && (one_part || is_one_part_by_rule(i)) && (s.touching_count == 0 || !rests(i))) return false;
    leave(i);
    return true;
  }

  // Where a particle with these determinants has ridden to, in the simplex that its step begins in.
  [[nodiscard]] DARTCAST_TARGET Vec3 ridden(std::uint32_t i, const Weights& w) const {
    return flushed(combine(corners_of(now_, vertices_[i]), shares_of(w)));
  }
  // None where the filter does not prove that this lies inside of the moved simplex, as of nothing that is unknown.
  [[nodiscard]] DARTCAST_TARGET std::optional<Vec3> ridden_alone(std::uint32_t i) const {
    const Vec3 x = ridden(i, determinants_of(began_with_.data(), i));
    return Determinants(corners_of(now_, vertices_[i]), x).all_proved_positive() ? std::optional(x) : std::nullopt;
  }

  // By the rule itself.
  [[nodiscard]] DARTCAST_TARGET bool is_one_part_by_rule(std::uint32_t i) const {
    const auto ridden = ridden_alone(i);
    if (!ridden) return false;
    const auto [gradient, edge] = deformation(corners_of(before_, vertices_[i]), corners_of(now_, vertices_[i]));
    return gradient * norm(targets_[i] - *ridden) <= 2.0 * tolerance_ * edge;
  }

  // Whether a particle that touches a wall is to stay at its place: it goes on touching it.
  [[nodiscard]] DARTCAST_TARGET bool rests(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position == targets_[i];
    const auto ridden = ridden_alone(i);
    return !ridden || *ridden == targets_[i];
  }

  // Of those in leaving_, who goes on. Meanwhile their cells are on the way from memory.
  DARTCAST_TARGET std::uint32_t ride_all(std::uint32_t first, std::uint32_t leaving) {
    for (std::uint32_t l = 0; l < leaving; ++l) {
      __builtin_prefetch(map_.record(states_[first + leaving_[l]].cell));
    }
    if constexpr (!moved) return leaving;
    std::uint32_t riding = 0;
    for (std::uint32_t l = 0; l < leaving; l += 4) {
      const std::uint32_t last = leaving - 1;
      const Four i = {{first + leaving_[l], first + leaving_[std::min(l + 1, last)],
                       first + leaving_[std::min(l + 2, last)], first + leaving_[std::min(l + 3, last)]}};
      riding = ride(i, std::min(leaving - l, 4U), riding, first);
    }
    return riding;
  }

  // Of four walks, lists those that go on from `riding` on: their starts, moved along with the vertices, are proved to
  // lie inside. The others are left.
  DARTCAST_TARGET std::uint32_t ride(const Four& i, std::uint32_t count, std::uint32_t riding, std::uint32_t first) {
    const Tetrahedra now = simplices_of(now_, i);
    const unsigned behind = lanes_set(FilteredDeterminants(now, places_of(i)).any_negative());
    unsigned on = 0;
    for (std::uint32_t l = 0; l < 4; ++l) on |= ((rides_inside_ >> (i.at[l] - first)) & 1U) << l;
    if (on != 15U) on |= rides_inside(began_with_.data(), i, now, targets_of(i));
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
        Visit& v = visits_[next] = visits_[first + k];
        v.tests = static_cast<std::uint16_t>(v.tests + 3);
        if (Signs(signs_[k]).is_inside()) {
          arrive(v, corners_[k], k);
        } else if (leave_simplex(v, corners_[k], k)) {
          ++next;
        }
      }
      if constexpr (kind != MemoKind::none) remember_arrivals();
    }
    return next;
  }

  [[gnu::always_inline]] DARTCAST_TARGET void test_visits(const Visit* visits, std::size_t k, std::size_t last) {
    const std::size_t k1 = std::min(k + 1, last);
    const std::size_t k2 = std::min(k + 2, last);
    const std::size_t k3 = std::min(k + 3, last);
    const Tetrahedra v(now_, corners_[k], corners_[k1], corners_[k2], corners_[k3]);
    const Points q = targets_of({{visits[k].particle, visits[k1].particle, visits[k2].particle, visits[k3].particle}});
    const FilteredDeterminants& d = *new (&determinants_[k / 4]) FilteredDeterminants(v, q);
    store_signs(d.signs(v, q), k);
    if constexpr (kind == MemoKind::coordinates) ends_[k / 4] = q;
  }

  // Finds the simplex behind the face that was entered through, and its corners.
  DARTCAST_TARGET void enter(Visit& v, VertexNumbers& corners) const {
    if (kind == MemoKind::coordinates && !v.through_face && v.place == no_facet) {  // where the step began
      corners = vertices_[v.particle];
      ask_for(now_, corners);
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
    ask_for(now_, corners);
  }

  // Goes on into the next simplex, if the filter says which; else leaves the step. k: its place in the block.
  DARTCAST_TARGET bool leave_simplex(Visit& visit, const VertexNumbers& corners, std::size_t k) {
    const Signs signs(signs_[k]);
    const unsigned asked = 15U & ~(1U << visit.place);
    if (!signs.is_known(asked)) return leave(visit.particle);
    const unsigned open = signs.open() & asked;
    visit.exact = static_cast<std::uint16_t>(visit.exact + std::popcount(open));
    const unsigned behind = signs.negative() & asked;
    if (behind == 0) {
      const unsigned on = signs.zero() & asked;
      if (on != 0) {
        if (const auto wall = find_touched_wall(map_, visit, corners, on)) return end_on_wall(visit, on, *wall);
      }
      on == 0 ? arrive(visit, corners, k) : arrive_on_facets(visit, corners, k, on);
      return false;
    }
    const bool single = std::has_single_bit(behind);
    return pass_on(visit, corners,
                   single ? static_cast<unsigned>(std::countr_zero(behind)) : first_exit(visit, corners, behind));
  }

  // Of several facets that the target lies behind, the one by which the segment leaves.
  DARTCAST_TARGET unsigned first_exit(Visit& visit, const VertexNumbers& corners, unsigned behind) const {
    const std::uint32_t i = visit.particle;
    const Vec3 p = start_of(i);
    const Vec3& q = targets_[i];
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    while ((behind &= behind - 1) != 0) {
      const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
      const auto& edge = side_edge[facet][other];
      const Vec3& a = now_[corners[edge[0]]];
      const Vec3& b = now_[corners[edge[1]]];
      const int first = filtered_sign(a - q, p - q, b - q);
      ++visit.tests;
      visit.exact = static_cast<std::uint16_t>(visit.exact + (first == 0 ? 1 : 0));
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
      if (kind == MemoKind::coordinates && (marks_[i] & exact_mark) != 0) zeros = marks_[i] & 15U;
      s = Ties<Stored, 4>(space, states_[i].at(), p, q, zeros).line(a, b);
    }
    return s == Sign::positive;
  }

  // Few walks ask where they began: those that come to a wall, or to several facets that the target is behind.
  [[nodiscard]] DARTCAST_TARGET Vec3 start_of(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position;
    return ridden(i, determinants_of(began_with_.data(), i));
  }

  DARTCAST_TARGET bool pass_on(Visit& visit, const VertexNumbers& corners, unsigned facet) {
    const Across across = across_of(visit, facet);
    if (across.outer()) return pass_face(visit, corners, facet, across);
    visit.through_face = false;
    visit.index = across.index;
    visit.place = across.place;
    return true;
  }

  [[nodiscard]] DARTCAST_TARGET Across across_of(const Visit& visit, unsigned facet) const {
    return map_.view(Cell(visit.cell), visit.record).shape().simplices()[visit.index].across[facet];
  }

  // Into the cell beyond.
  DARTCAST_TARGET bool pass_face(Visit& visit, const VertexNumbers& corners, unsigned facet, Across across) {
    const CellView cell = map_.view(Cell(visit.cell), visit.record);
    const std::uint16_t face = across.face();
    if (cell.is_wall(face)) return end_at_wall(visit, corners, facet);
    visit.through_face = true;
    visit.cell = cell.neighbour(face).value;
    visit.index = cell.neighbour_face(face);
    visit.place = cell.shape().triangle_from_other_side(face, across.place);
    visit.record = map_.record(Cell(visit.cell));
    __builtin_prefetch(visit.record);
    return true;
  }

  // The step is not taken here. Returns false: it does not go on.
  DARTCAST_TARGET bool leave(std::uint32_t i) {
    taken_[i] = taken_nothing;
    return false;
  }
  // The target is beyond a wall.
  [[gnu::cold, gnu::noinline]] DARTCAST_TARGET bool end_at_wall(const Visit& visit, const VertexNumbers& corners,
                                                                unsigned facet) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = walk.wall_simplex = {Cell(visit.cell), visit.index};
    walk.wall_facet = static_cast<std::uint8_t>(facet);
    at_walls_[at_wall_count_++] = {visit.particle, static_cast<Taken>(begun_.size()), walk.wall_facet, corners};
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
    if constexpr (moved) {  // what follows asks how the wall has moved
      const CellView cell = map_.view(walk.wall_simplex.cell);
      for (const std::uint16_t local : cell.shape().simplices()[walk.wall_simplex.simplex].vertex)
        __builtin_prefetch(before_ + cell.vertex(local).value);
    }
    taken_[i] = static_cast<Taken>(begun_.size());
    begun_.emplace_back(start_of(i), walk, TestCounts{visit.tests, visit.exact});
    return false;
  }

  // What follows at walls, where doubles prove it.
  DARTCAST_TARGET void land_all() {
    landings_.reserve(at_wall_count_);
    for (std::uint32_t k = 0; k < at_wall_count_; k += 4) land(k);
  }

  DARTCAST_TARGET void land(std::uint32_t k) {
    const std::uint32_t last = at_wall_count_ - 1;
    const AtWalls at = {&at_walls_[k], &at_walls_[std::min(k + 1, last)], &at_walls_[std::min(k + 2, last)],
                        &at_walls_[std::min(k + 3, last)]};
    FourLandings landings(at, begun_, now_, targets_);
    if (lanes_set(landings.known) == 0) return;
    landings.put(Tetrahedra(now_, at[0]->corners, at[1]->corners, at[2]->corners, at[3]->corners));
    if constexpr (moved) landings.move_walls(at, before_);
    MemosOfFour memos;
    if constexpr (moved) leave_trails(landings.there, memos);
    if constexpr (kind == MemoKind::coordinates) leave_coordinates<false>(landings.there, landings.position, memos);
    for (std::uint32_t l = 0; l < 4 && k + l < at_wall_count_; ++l) {
      if (landings.known[l] == 0) continue;
      const std::uint32_t i = at[l]->particle;
      Begun& begun = begun_[at[l]->begun];
      landings_.push_back(landings.of(l));
      begun.landing = &landings_.back();
      ++begun.tests.tests;  // on which side p is
      vertices_[i] = at[l]->corners;
      if constexpr (kind == MemoKind::none) continue;
      if (moved || begun.tests.tests <= few_tests) {
        memos_[i / 4].put(i % 4, memos.of(l));
        if (!moved) marks_[i] = 0;
      } else {
        forget(memos_, marks_, i);
      }
    }
  }
  DARTCAST_TARGET void arrive(const Visit& visit, const VertexNumbers& corners, std::size_t k) {
    end(visit);
    vertices_[visit.particle] = corners;
    arrival_[arrivals_] = {visit.particle, static_cast<std::uint32_t>(k)};
    arrivals_ += kind != MemoKind::coordinates || needs_coordinates(visit) ? 1 : 0;
  }

  DARTCAST_TARGET void end(const Visit& visit) {
    State& s = states_[visit.particle];
    s.put({Cell(visit.cell), visit.index}, targets_[visit.particle]);
    s.touching_count = 0;
    count_step(visit, counters_);
    if (moved && visit.place != no_facet) counters_.updated_by_deformation += left_behind_[visit.particle] ? 1 : 0;
  }

  static constexpr std::uint16_t few_tests = 13;  // three simplices

  // Who passes many simplices in a step is likely to leave the last one in the next, too: it gets none.
  DARTCAST_TARGET bool needs_coordinates(const Visit& visit) {
    const std::uint32_t i = visit.particle;
    if (visit.place == no_facet && has_coordinates(memos_, i)) {
      marks_[i] &= exact_mark;
      return false;
    }
    marks_[i] = 0;
    if (visit.tests <= few_tests) return true;
    forget(memos_, marks_, i);
    return false;
  }

  // At a target on facets of the simplex. The next is likely to be on some, too: of coordinates, exact ones are kept.
  [[gnu::noinline]] DARTCAST_TARGET void arrive_on_facets(const Visit& visit, const VertexNumbers& corners,
                                                          std::size_t k, unsigned on) {
    if constexpr (kind != MemoKind::coordinates) return arrive(visit, corners, k);
    const std::uint32_t i = visit.particle;
    end(visit);
    vertices_[i] = corners;
    if (visit.place != no_facet || !has_coordinates(memos_, i)) forget(memos_, marks_, i);
    if ((marks_[i] & exact_mark) != 0)
      marks_[i] = static_cast<Mark>(exact_mark | on);
    else if (visit.tests <= few_tests)
      facet_arrival_[facet_arrivals_++] = {i, static_cast<Mark>(on)};
  }

  // Keeps memos of the simplices that walks of the block have ended in.
  DARTCAST_TARGET void remember_arrivals() {
    MemosOfFour four;
    for (std::uint32_t a = 0; a < arrivals_;) {
      const std::uint32_t k = arrival_[a].place / 4;
      if constexpr (moved) leave_trails(determinants_[k], four);
      if constexpr (kind == MemoKind::coordinates) leave_coordinates<false>(determinants_[k], ends_[k], four);
      for (; a < arrivals_ && arrival_[a].place / 4 == k; ++a) {
        const std::uint32_t i = arrival_[a].particle;
        memos_[i / 4].put(i % 4, four.of(arrival_[a].place % 4));
      }
    }
  }

  // Of the batch, where targets lie on facets. Few of a block's walks do: four of them are taken together.
  [[gnu::noinline]] DARTCAST_TARGET void remember_exact() {
    MemosOfFour four;
    for (std::uint32_t a = 0; a < facet_arrivals_; a += 4) {
      const Four at = four_from(a, facet_arrivals_);
      const Four i = particles_of(facet_arrival_.data(), at);
      const Points q = targets_of(i);
      const unsigned exact = leave_coordinates<true>(FilteredDeterminants(simplices_of(now_, i), q), q, four);
      for (std::uint32_t l = 0; l < 4; ++l) {
        if (((exact >> l) & 1U) == 0) continue;
        memos_[i.at[l] / 4].put(i.at[l] % 4, four.of(l));
        marks_[i.at[l]] = exact_mark | facet_arrival_[at.at[l]].on;
      }
    }
  }

  const Map& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  bool memos_match_;
  bool walls_match_;
  double tolerance_;
  std::uint32_t size_;
  State* states_;
  VertexNumbers* vertices_;
  MemosOfFour* memos_;
  Mark* marks_;
  const Vec3* targets_;
  Taken* taken_;
  std::vector<Begun>& begun_;
  std::vector<Landing>& landings_;
  Counters& counters_;

  // Of the block. Bits: one per particle.
  std::array<VertexNumbers, block> corners_;
  std::array<FilteredDeterminants, block / 4> determinants_;
  std::array<Points, block / 4> ends_;  // of walks
  std::array<long long, block> signs_;
  std::uint32_t inside_;
  std::uint32_t on_facets_ = 0;
  std::uint32_t still_free_;
  std::uint32_t one_part_;
  std::uint32_t rides_inside_;
  std::array<std::uint32_t, block> leaving_;
  std::array<Arrival, block> arrival_;
  std::uint32_t arrivals_;

  // Of the batch.
  std::array<AtWall, filtered_batch> at_walls_;
  std::uint32_t at_wall_count_ = 0;
  std::array<Visit, filtered_batch> visits_;  // walks that go on
  std::array<Departure, filtered_batch> departures_;
  std::array<Unproved, filtered_batch> unproved_;
  std::size_t unproved_count_ = 0;
  std::array<Outward, filtered_batch> outward_;
  std::array<MemosOfFour::Table<double>, filtered_batch / 4> began_with_;  // determinants before the move
  std::array<bool, filtered_batch> left_behind_;
  std::array<FacetArrival, filtered_batch> facet_arrival_;
  std::uint32_t facet_arrivals_ = 0;
};
