// The loop of walk/filtered.cpp, compiled there once per instruction set: no include guard, no includes, and not to be
// included elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function, and lanes_set(Mask).

// The corners of a simplex: x, y, z and one double that means nothing.
struct Rows {
  Quad corner[4];

  DARTCAST_TARGET Rows(const Vec3* positions, const VertexNumbers& v)
      : corner{at(positions + v[0]), at(positions + v[1]), at(positions + v[2]), at(positions + v[3])} {}

 private:
  DARTCAST_TARGET static Quad at(const Vec3* row) { return *reinterpret_cast<const UnalignedQuad*>(row); }
};

DARTCAST_TARGET inline Vec3 vec_of(const Quad& row) { return {row[0], row[1], row[2]}; }
DARTCAST_TARGET inline Quad magnitude(const Quad& v) {
  constexpr long long all_but_sign = 0x7fffffffffffffff;
  return reinterpret_cast<Quad>(reinterpret_cast<Mask>(v) &
                                Mask{all_but_sign, all_but_sign, all_but_sign, all_but_sign});
}
DARTCAST_TARGET inline Quad larger(const Quad& a, const Quad& b) { return a > b ? a : b; }
DARTCAST_TARGET inline double square(const Quad& row) {
  const Quad squares = row * row;
  return (squares[0] + squares[1]) + squares[2];
}

// The determinants of geometry/simplex.hpp, by the same operations, one in each lane; and their bound.
struct FilteredDeterminants {
  Quad value;
  double bound;
  bool applies;

  FilteredDeterminants() = default;
  DARTCAST_TARGET FilteredDeterminants(const Rows& v, const Quad& point) {
    const Quad r0 = v.corner[0] - point;
    const Quad r1 = v.corner[1] - point;
    const Quad r2 = v.corner[2] - point;
    const Quad r3 = v.corner[3] - point;
    const Quad most = larger(larger(magnitude(r0), magnitude(r1)), larger(magnitude(r2), magnitude(r3)));
    const double m = most[0] * most[1] * most[2];
    bound = determinant_error * m;
    applies = (lanes_set(most > 0x1p+301) & 7U) == 0 && m >= 0x1p-700;
    // Corners in lanes, as they are and with neighbours exchanged: (r1, r0, r3, r2).
    const Quad xz01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
    const Quad xz23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
    const Quad y01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
    const Quad y23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
    const Quad x = __builtin_shufflevector(xz01, xz23, 0, 1, 4, 5);
    const Quad y = __builtin_shufflevector(y01, y23, 0, 1, 4, 5);
    const Quad z = __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7);
    const Quad xs = __builtin_shufflevector(x, x, 1, 0, 3, 2);
    const Quad ys = __builtin_shufflevector(y, y, 1, 0, 3, 2);
    const Quad zs = __builtin_shufflevector(z, z, 1, 0, 3, 2);
    // (n, -n, n', -n') with n = r0 x r1, n' = r2 x r3; then its halves exchanged.
    const Quad nx = y * zs - z * ys;
    const Quad ny = z * xs - x * zs;
    const Quad nz = x * ys - y * xs;
    const Quad mx = __builtin_shufflevector(nx, nx, 2, 3, 0, 1);
    const Quad my = __builtin_shufflevector(ny, ny, 2, 3, 0, 1);
    const Quad mz = __builtin_shufflevector(nz, nz, 2, 3, 0, 1);
    value = xs * mx + ys * my + zs * mz;
  }

  [[nodiscard]] DARTCAST_TARGET double volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  // Surely no more than six times the volume.
  [[nodiscard]] DARTCAST_TARGET double least_volume6() const { return volume6() - 8.0 * bound; }
  [[nodiscard]] DARTCAST_TARGET bool proves_positive() const { return applies && least_volume6() > 0.0; }
  [[nodiscard]] DARTCAST_TARGET bool proves_coordinates() const { return applies && volume6() > 0x1p+30 * bound; }
  // Bit i: value i is proved positive, or negative.
  [[nodiscard]] DARTCAST_TARGET unsigned positive() const { return lanes_set(value > bound); }
  [[nodiscard]] DARTCAST_TARGET unsigned negative() const { return lanes_set(value < -bound); }
  [[nodiscard]] DARTCAST_TARGET bool all_positive() const { return applies && positive() == 15U; }
};

DARTCAST_TARGET inline Corners corners_of(const Rows& v) {
  return {vec_of(v.corner[0]), vec_of(v.corner[1]), vec_of(v.corner[2]), vec_of(v.corner[3])};
}

// Whether the determinants' values are exact (rounds_nothing() in exact/predicates.hpp), where the filter applies.
DARTCAST_TARGET inline bool is_exact(const Rows& v, const Quad& point) {
  Quad extent = magnitude(v.corner[0] - point);
  for (unsigned i = 1; i < 4; ++i) extent = larger(extent, magnitude(v.corner[i] - point));
  const Quad unit = extent * 0x1p+37;
  const Quad m = magnitude(point);
  Mask rounded = ((m + unit) - unit) != m;
  for (const Quad& corner : v.corner) {
    const Quad c = magnitude(corner);
    rounded |= ((c + unit) - unit) != c;
  }
  return (lanes_set(rounded) & 7U) == 0;
}

// The coordinates of walk/ride.hpp, and the point that has them in the moved simplex. False where the filter does not
// prove that the simplexes are positive, and the point inside.
DARTCAST_TARGET inline bool ride_along(const Rows& before, const Rows& now, const Vec3& p, Vec3& ridden) {
  const FilteredDeterminants at(before, load_row(p));
  if (!at.proves_coordinates()) return false;
  const Quad w = larger(at.value, Quad{});
  const double sum = ((w[0] + w[1]) + w[2]) + w[3];
  const Quad share = w / sum;
  const Quad x =
      (now.corner[0] * share[0] + now.corner[1] * share[1]) + (now.corner[2] * share[2] + now.corner[3] * share[3]);
  ridden = flushed(vec_of(x));
  return FilteredDeterminants(now, load_row(ridden)).all_positive();
}

// Whether a step relative to moving vertices surely needs no splitting (walk/step.hpp). With D the longest displacement
// of a corner relative to the first, L the longest edge from there, before and after, and V six times the volume
// before: |A| <= 3 D L^2 / V, the shortest edge is at least V / L^2, V at least the volume after less 3 D L^2, and the
// particle's own motion at most |q - p - u0| + D.
DARTCAST_TARGET inline bool is_one_part(const Rows& before, const Rows& now, double volume_now, const Vec3& p,
                                        const Quad& q, double tolerance) {
  const Quad u0 = now.corner[0] - before.corner[0];
  Quad longest = magnitude(now.corner[1] - now.corner[0]);
  Quad farthest = magnitude((now.corner[1] - before.corner[1]) - u0);
  for (unsigned i = 2; i < 4; ++i) {
    longest = larger(longest, magnitude(now.corner[i] - now.corner[0]));
    farthest = larger(farthest, magnitude((now.corner[i] - before.corner[i]) - u0));
  }
  const double d = std::sqrt(square(farthest));
  const double own = std::sqrt(square(q - load_row(p) - u0)) + d;
  const double l = std::sqrt(square(longest)) + d;
  constexpr double rounding = 1.01;
  const double change = 3.0 * rounding * d * l * l;  // of the volume
  const double volume = volume_now - change;
  return volume > 0.0 && change * own * l * l <= 2.0 * tolerance * volume * volume;
}

// A simplex that a walk has come to.
struct Visit {
  std::uint32_t particle;
  std::uint32_t cell;   // its value
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint16_t place;  // facet that was entered by (4: none), or triangle of that face
  std::uint16_t tests;  // so far
  std::uint16_t exact;  // of these, those that the filter left open
  bool through_face;
};

// Simplices are taken block by block, in passes without branches as far as possible: all are found, so that their
// corners are on the way from memory before the first is used; all are tested; then those that are left go on.
class Batch {
 public:
  DARTCAST_TARGET Batch(const FilteredScene& scene, const FilteredSteps& steps, Counters& counters)
      : map_(scene.complex->map()),
        now_(scene.complex->positions().data()),
        before_(scene.moved ? scene.complex->previous_positions().data() : nullptr),
        tolerance_(scene.tolerance),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        targets_(steps.targets.data()),
        left_(steps.left.data()),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint64_t most_rounds) {
    std::size_t count = before_ == nullptr ? begin<false>() : begin<true>();
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round == most_rounds) return leave_all(count);
      count = walk_on(count);
    }
  }

 private:
  static constexpr std::uint32_t block = 32;

  // The first simplex of each step: most end there. Returns the number of walks that go on.
  template <bool moved>
  DARTCAST_TARGET std::size_t begin() {
    std::memset(left_, 0, size_);
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) ask_for<moved>(vertices_[i]);
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      for (std::uint32_t k = 0; k < n; ++k) {
        if (first + k + block < size_) ask_for<moved>(vertices_[first + k + block]);
        test<moved>(first + k, k);
      }
      const std::uint32_t leaving = end_inside<moved>(first, n);
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        if (moved && !ride(i)) continue;
        visits_[count] = {i, states_[i].cell.value, states_[i].simplex, 4, 4, 0, false};
        if (leave_simplex(visits_[count], vertices_[i], determinants_[leaving_[l]])) ++count;
      }
    }
    return count;
  }

  template <bool moved>
  DARTCAST_TARGET void test(std::uint32_t i, std::uint32_t k) {
    const Rows now(now_, vertices_[i]);
    determinants_[k] = FilteredDeterminants(now, load_row(targets_[i]));
    inside_[k] = determinants_[k].all_positive();
    if constexpr (moved) {
      one_part_[k] = is_one_part(Rows(before_, vertices_[i]), now, determinants_[k].least_volume6(),
                                 states_[i].position, load_row(targets_[i]), tolerance_);
    }
  }

  // Ends the steps whose targets lie strictly inside: wherever they come from in the same simplex, nothing is in the
  // way. Lists the others in leaving_.
  template <bool moved>
  DARTCAST_TARGET std::uint32_t end_inside(std::uint32_t first, std::uint32_t n) {
    std::uint32_t leaving = 0;
    std::uint32_t ended = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t i = first + k;
      State& s = states_[i];
      if (s.held || (moved && !one_part_[k] && !is_one_part_after_all(i)) ||
          (s.touching_count != 0 && rests<moved>(i))) {
        left_[i] = 1;
        continue;
      }
      const bool inside = inside_[k];
      leaving_[leaving] = k;
      leaving += inside ? 0 : 1;
      ended += inside ? 1 : 0;
      store_where(inside, load_row(targets_[i]), s.position);
      s.touching_count = inside ? 0 : s.touching_count;
    }
    counters_.particle_steps += ended;
    counters_.orientation.tests += std::uint64_t{4} * ended;
    counters_.histogram[4] += ended;
    counters_.forecast_kept += ended;
    return leaving;
  }

  // The rule itself, where the bound of it does not do.
  DARTCAST_TARGET bool is_one_part_after_all(std::uint32_t i) const {
    const Rows before(before_, vertices_[i]);
    const Rows now(now_, vertices_[i]);
    Vec3 ridden;
    if (!ride_along(before, now, states_[i].position, ridden)) return false;
    const auto [gradient, edge] = deformation(corners_of(before), corners_of(now));
    return gradient * norm(targets_[i] - ridden) <= 2.0 * tolerance_ * edge;
  }

  // Whether a particle that touches a wall is to stay at its place: it goes on touching it.
  template <bool moved>
  DARTCAST_TARGET bool rests(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position == targets_[i];
    Vec3 ridden;
    return !ride_along(Rows(before_, vertices_[i]), Rows(now_, vertices_[i]), states_[i].position, ridden) ||
           ridden == targets_[i];
  }

  // Moves the start of a walk along with the vertices; false where the step is left.
  DARTCAST_TARGET bool ride(std::uint32_t i) {
    const Rows now(now_, vertices_[i]);
    const Vec3 p = states_[i].position;
    left_behind_[i] = FilteredDeterminants(now, load_row(p)).negative() != 0;
    Vec3 ridden;
    if (!ride_along(Rows(before_, vertices_[i]), now, p, ridden) || ridden == targets_[i]) return leave(i);
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
        determinants_[k] =
            FilteredDeterminants(Rows(now_, corners_[k]), load_row(targets_[visits_[first + k].particle]));
      }
      for (std::size_t k = 0; k < n; ++k) {
        Visit& v = visits_[next] = visits_[first + k];
        v.tests = static_cast<std::uint16_t>(v.tests + 3);
        if (determinants_[k].all_positive()) {
          arrive(v, corners_[k]);
        } else if (leave_simplex(v, corners_[k], determinants_[k])) {
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
    ask_for<false>(corners);
  }

  template <bool moved>
  DARTCAST_TARGET void ask_for(const VertexNumbers& v) const {
    for (unsigned i = 0; i < 4; ++i) {
      __builtin_prefetch(now_ + v[i]);
      __builtin_prefetch(&(now_ + v[i])->z);
      if constexpr (moved) __builtin_prefetch(before_ + v[i]);
      if constexpr (moved) __builtin_prefetch(&(before_ + v[i])->z);
    }
  }

  // Goes on into the next simplex, if the filter says which; else leaves the step.
  DARTCAST_TARGET bool leave_simplex(Visit& visit, const VertexNumbers& corners, const FilteredDeterminants& d) {
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
      if (touches_wall(visit, on)) return leave(visit.particle);
      arrive(visit, corners);
      return false;
    }
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    if ((behind & (behind - 1)) != 0) facet = first_exit(visit, corners, behind);
    return facet < 4 ? pass_on(visit, facet) : leave(visit.particle);
  }

  // Whether a target that lies on facets of its simplex lies on a wall.
  DARTCAST_TARGET bool touches_wall(const Visit& visit, unsigned on) const {
    const SimplexId id{Cell(visit.cell), visit.index};
    const CellView cell = map_.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    return find_wall(map_, id, on, feature_of(cell, s, on)).has_value();
  }

  // Of several facets that the target lies behind, the one by which the segment leaves; 4 where the filter does not
  // say.
  DARTCAST_TARGET unsigned first_exit(Visit& visit, const VertexNumbers& corners, unsigned behind) const {
    const Rows now(now_, corners);
    const std::uint32_t i = visit.particle;
    const Vec3 p = before_ == nullptr ? states_[i].position : vec_of(ridden_[i]);
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
    if (cell.is_wall(face)) return leave(visit.particle);
    visit.cell = cell.neighbour(face).value;
    visit.index = cell.neighbour_face(face);
    visit.place = cell.shape().triangle_from_other_side(face, across.place);
    __builtin_prefetch(map_.record(Cell(visit.cell)));
    return true;
  }

  // The step is not taken here. Returns false: it does not go on.
  DARTCAST_TARGET bool leave(std::uint32_t i) {
    left_[i] = 1;
    return false;
  }
  DARTCAST_TARGET void leave_all(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) leave(visits_[k].particle);
  }

  DARTCAST_TARGET void arrive(const Visit& visit, const VertexNumbers& corners) {
    State& s = states_[visit.particle];
    s.put({Cell(visit.cell), visit.index}, targets_[visit.particle]);
    s.touching_count = 0;
    vertices_[visit.particle] = corners;
    ++counters_.particle_steps;
    counters_.orientation.tests += visit.tests;
    counters_.orientation.exact += visit.exact;
    ++counters_.histogram[std::min<std::size_t>(visit.tests, Counters::histogram_size - 1)];
    const bool kept = visit.place == 4;
    counters_.forecast_kept += kept ? 1 : 0;
    if (before_ != nullptr && !kept) counters_.updated_by_deformation += left_behind_[visit.particle] ? 1 : 0;
  }

  const Map& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  double tolerance_;
  std::uint32_t size_;
  State* states_;
  VertexNumbers* vertices_;
  const Vec3* targets_;
  std::uint8_t* left_;
  Counters& counters_;

  // Of the block.
  std::array<VertexNumbers, block> corners_;
  std::array<FilteredDeterminants, block> determinants_;
  std::array<bool, block> inside_;
  std::array<bool, block> one_part_;
  std::array<std::uint32_t, block> leaving_;

  // Of the batch.
  std::array<Visit, filtered_batch> visits_;  // walks that go on
  std::array<Quad, filtered_batch> ridden_;   // where particles have ridden to
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
