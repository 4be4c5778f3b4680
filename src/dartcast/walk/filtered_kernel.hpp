// The loop of walk/filtered.cpp, compiled there once per instruction set: no include guard, no includes, and not to be
// included elsewhere. Defined before: DARTCAST_TARGET, the attribute of every function, and lanes_set(Mask).

// The rows of a simplex: x, y, z and one double that means nothing, per corner.
struct Rows {
  std::array<Quad, 4> corner;

  // `offset`: in doubles.
  DARTCAST_TARGET Rows(const double* positions, const std::array<std::size_t, 4>& offset) {
    for (unsigned i = 0; i < 4; ++i) std::memcpy(&corner[i], positions + offset[i], sizeof(Quad));
  }
};

DARTCAST_TARGET inline Vec3 vec_of(const Quad& row) { return {row[0], row[1], row[2]}; }
DARTCAST_TARGET inline Quad magnitude(const Quad& v) {
  constexpr long long all_but_sign = 0x7fffffffffffffff;
  return reinterpret_cast<Quad>(reinterpret_cast<Mask>(v) &
                                Mask{all_but_sign, all_but_sign, all_but_sign, all_but_sign});
}
DARTCAST_TARGET inline Quad larger(const Quad& a, const Quad& b) { return a > b ? a : b; }
DARTCAST_TARGET inline double square(const Quad& row) { return row[0] * row[0] + row[1] * row[1] + row[2] * row[2]; }

// The determinants of geometry/simplex.hpp, by the same operations, one in each lane; and their bound.
struct FilteredDeterminants {
  Quad value;
  double bound = 0.0;
  bool applies = false;

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

  DARTCAST_TARGET [[nodiscard]] double volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  DARTCAST_TARGET [[nodiscard]] bool proves_positive() const { return applies && volume6() > 8.0 * bound; }
  // Bit i: value i is proved positive, or negative.
  DARTCAST_TARGET [[nodiscard]] unsigned positive() const { return lanes_set(value > bound); }
  DARTCAST_TARGET [[nodiscard]] unsigned negative() const { return lanes_set(value < -bound); }
  DARTCAST_TARGET [[nodiscard]] bool all_positive() const { return applies && positive() == 15U; }
};

// The coordinates of walk/ride.hpp, and the point that has them in the moved simplex. False where the filter does not
// prove that the simplexes are positive, and the point inside.
DARTCAST_TARGET inline bool ride_along(const Rows& before, const Rows& now, const Vec3& p, Vec3& ridden) {
  const FilteredDeterminants at(before, load_row(p));
  if (!at.proves_positive()) return false;
  const Quad w = larger(at.value, Quad{});
  const double sum = ((w[0] + w[1]) + w[2]) + w[3];
  const Quad share = w / sum;
  const Quad x =
      (now.corner[0] * share[0] + now.corner[1] * share[1]) + (now.corner[2] * share[2] + now.corner[3] * share[3]);
  ridden = flushed(vec_of(x));
  return FilteredDeterminants(now, load_row(ridden)).all_positive();
}

// Whether a step relative to moving vertices surely needs no splitting (walk/step.hpp). With u the corners'
// displacements relative to the first, D the longest, L the longest edge from there and V six times the volume before:
// |A| <= 3 D L^2 / V, the shortest edge is at least V / L^2, and the particle's own motion at most |q - p - u0| + D.
DARTCAST_TARGET inline bool is_one_part(const Rows& before, const Rows& now, const Vec3& p, const Vec3& q,
                                        double tolerance) {
  const Quad u0 = now.corner[0] - before.corner[0];
  Quad longest{};
  Quad farthest{};
  std::array<Quad, 3> edge;
  for (unsigned i = 0; i < 3; ++i) {
    edge[i] = before.corner[i + 1] - before.corner[0];
    longest = larger(longest, magnitude(edge[i]));
    farthest = larger(farthest, magnitude((now.corner[i + 1] - before.corner[i + 1]) - u0));
  }
  const double volume = dot(vec_of(edge[0]), cross(vec_of(edge[1]), vec_of(edge[2])));
  const double l2 = square(longest);
  const double d = std::sqrt(square(farthest));
  const double own = std::sqrt(square(load_row(q) - load_row(p) - u0)) + d;
  constexpr double rounding = 1.01;
  return 3.0 * rounding * d * own * l2 * l2 <= 2.0 * tolerance * volume * volume;
}

// A simplex that a walk has come to.
struct Visit {
  std::uint32_t particle;
  Cell cell;
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint16_t place;  // facet that was entered by, or triangle of that face
  std::uint16_t tests;  // so far
  bool through_face;
};

// A simplex, found in memory.
struct Place {
  const std::uint32_t* word;  // the cell's record
  const Shape* shape;
  const ImplicitSimplex* simplex;
  std::array<std::size_t, 4> offset;  // of its corners in the positions, in doubles
};

class Batch {
 public:
  DARTCAST_TARGET Batch(const FilteredScene& scene, std::span<State> states, std::span<const Vec3> targets,
                        std::span<std::uint8_t> left, Counters& counters)
      : map_(scene.complex->map()),
        now_(&scene.complex->positions().data()->x),
        before_(scene.moved ? &scene.complex->previous_positions().data()->x : nullptr),
        tolerance_(scene.tolerance),
        states_(states.data()),
        targets_(targets.data()),
        left_(left.data()),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint32_t size, std::uint64_t most_rounds) {
    std::size_t count = before_ == nullptr ? begin<false>(size) : begin<true>(size);
    for (std::uint64_t round = 1; count > 0; ++round) {
      if (round == most_rounds) return leave(count);
      count = walk_on(count);
    }
  }

 private:
  // Simplices are found block by block, so that the corners of all in a block are on their way from memory before the
  // first is used; and cells two blocks ahead.
  static constexpr std::uint32_t block = 16;

  // The first simplex of each step: most steps end there. Returns the number of walks that go on.
  template <bool moved>
  DARTCAST_TARGET std::size_t begin(std::uint32_t size) {
    for (std::uint32_t i = 0; i < std::min(size, block); ++i) ask_for(states_[i].cell);
    std::array<Place, block> places;
    std::size_t count = 0;
    std::uint64_t kept = 0;
    for (std::uint32_t first = 0; first < size; first += block) {
      const std::uint32_t end = std::min(first + block, size);
      for (std::uint32_t i = first; i < end; ++i) {
        if (i + block < size) ask_for(states_[i + block].cell);
        find<moved>(states_[i].cell, states_[i].simplex, places[i - first]);
      }
      for (std::uint32_t i = first; i < end; ++i) {
        if (begin_one<moved>(i, places[i - first], visits_[count], kept)) ++count;
      }
    }
    counters_.particle_steps += kept;
    counters_.orientation.tests += 4 * kept;
    counters_.histogram[4] += kept;
    counters_.forecast_kept += kept;
    return count;
  }

  // Takes one step's first simplex; true where the walk goes on, with `visit` in the next.
  template <bool moved>
  DARTCAST_TARGET bool begin_one(std::uint32_t i, const Place& place, Visit& visit, std::uint64_t& kept) {
    State& s = states_[i];
    const Rows now(now_, place.offset);
    const FilteredDeterminants d(now, load_row(targets_[i]));
    // Strictly inside: wherever it comes from in this simplex, nothing is in the way.
    bool stays = d.all_positive();
    left_[i] = 1;
    if (s.held || (s.touching_count != 0 && s.position == targets_[i])) return false;
    if constexpr (moved) {
      const Rows before(before_, place.offset);
      if (!is_one_part(before, now, s.position, targets_[i], tolerance_)) return false;
      if (!stays || s.touching_count != 0) {
        if (!ride_along(before, now, s.position, start_[i]) || start_[i] == targets_[i]) return false;
        left_behind_[i] = FilteredDeterminants(now, load_row(s.position)).negative() != 0;
      }
    }
    left_[i] = 0;
    if (stays) {
      s.position = targets_[i];
      s.touching_count = 0;
      ++kept;
      return false;
    }
    visit.particle = i;
    visit.cell = s.cell;
    visit.tests = 4;
    return leave_simplex(visit, place, now, d, 4, moved ? start_[i] : s.position);
  }

  // The next simplex of every walk. Returns the number of walks that go on.
  DARTCAST_TARGET std::size_t walk_on(std::size_t count) {
    std::array<Place, block> places;
    std::array<Across, block> at;  // simplex, and facet entered by
    std::size_t next = 0;
    for (std::size_t first = 0; first < count; first += block) {
      const std::size_t size = std::min<std::size_t>(block, count - first);
      for (std::size_t k = 0; k < size; ++k) {
        const Visit& v = visits_[first + k];
        at[k] = {v.index, v.place};
        if (v.through_face) at[k] = map_.shape(v.cell).entry(v.index, v.place);
        find<false>(v.cell, at[k].index, places[k]);
      }
      for (std::size_t k = 0; k < size; ++k) {
        visits_[next] = visits_[first + k];
        if (visit_one(visits_[next], places[k], at[k])) ++next;
      }
    }
    return next;
  }

  DARTCAST_TARGET bool visit_one(Visit& visit, const Place& place, const Across& at) {
    const std::uint32_t i = visit.particle;
    const Rows now(now_, place.offset);
    const FilteredDeterminants d(now, load_row(targets_[i]));
    visit.tests = static_cast<std::uint16_t>(visit.tests + 3);
    if (d.all_positive()) {
      arrive(visit, at.index);
      return false;
    }
    return leave_simplex(visit, place, now, d, at.place, before_ == nullptr ? states_[i].position : start_[i]);
  }

  DARTCAST_TARGET void ask_for(Cell c) const { __builtin_prefetch(map_.record(c)); }

  template <bool moved>
  DARTCAST_TARGET void find(Cell cell, std::uint16_t simplex, Place& place) const {
    const CellView view = map_.view(cell);
    place.word = view.words();
    place.shape = &view.shape();
    place.simplex = place.shape->simplices().data() + simplex;
    for (unsigned i = 0; i < 4; ++i) {
      place.offset[i] = std::size_t{3} * view.vertex(place.simplex->vertex[i]).value;
      __builtin_prefetch(now_ + place.offset[i]);
      if constexpr (moved) __builtin_prefetch(before_ + place.offset[i]);
    }
  }

  // Goes on into the next simplex, if the filter says which.
  DARTCAST_TARGET bool leave_simplex(Visit& visit, const Place& place, const Rows& now, const FilteredDeterminants& d,
                                     unsigned entered, const Vec3& from) {
    const unsigned negative = d.negative();
    const unsigned known = 1U << entered;
    unsigned behind = negative & ~known;
    const bool proved = d.proves_positive() && ((d.positive() | negative | known) & 15U) == 15U;
    if (!proved || behind == 0) return give_up(visit);
    unsigned facet = static_cast<unsigned>(std::countr_zero(behind));
    while ((behind &= behind - 1) != 0) {
      const unsigned other = static_cast<unsigned>(std::countr_zero(behind));
      const int first = leaves_first(now, facet, other, from, targets_[visit.particle]);
      ++visit.tests;
      if (first == 0) return give_up(visit);
      if (first < 0) facet = other;
    }
    return pass_on(visit, place, facet);
  }

  // 1 where the segment leaves by facet i before j, -1 where not, 0 where the filter does not say.
  DARTCAST_TARGET static int leaves_first(const Rows& rows, unsigned i, unsigned j, const Vec3& p, const Vec3& q) {
    const Vec3 u = vec_of(rows.corner[side_edge[i][j][0]]) - q;
    const Vec3 w = vec_of(rows.corner[side_edge[i][j][1]]) - q;
    return filtered_sign(u, p - q, w);
  }

  DARTCAST_TARGET bool pass_on(Visit& visit, const Place& place, unsigned facet) {
    const Across across = place.simplex->across[facet];
    visit.through_face = across.outer();
    if (!across.outer()) {
      visit.index = across.index;
      visit.place = across.place;
      return true;
    }
    const CellView cell(place.word, *place.shape, visit.cell.pool() == Map::general_pool);
    const std::uint16_t face = across.face();
    if (cell.is_wall(face)) return give_up(visit);
    visit.cell = cell.neighbour(face);
    visit.index = cell.neighbour_face(face);
    visit.place = place.shape->triangle_from_other_side(face, across.place);
    ask_for(visit.cell);
    return true;
  }

  DARTCAST_TARGET bool give_up(const Visit& visit) {
    left_[visit.particle] = 1;
    return false;
  }
  DARTCAST_TARGET void leave(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) left_[visits_[k].particle] = 1;
  }

  DARTCAST_TARGET void arrive(const Visit& visit, std::uint16_t simplex) {
    State& s = states_[visit.particle];
    s.put({visit.cell, simplex}, targets_[visit.particle]);
    s.touching_count = 0;
    ++counters_.particle_steps;
    counters_.orientation.tests += visit.tests;
    ++counters_.histogram[std::min<std::size_t>(visit.tests, Counters::histogram_size - 1)];
    if (before_ != nullptr) counters_.updated_by_deformation += left_behind_[visit.particle] ? 1 : 0;
  }

  const Map& map_;
  const double* now_;
  const double* before_;  // null where the scene stands still
  double tolerance_;
  State* states_;
  const Vec3* targets_;
  std::uint8_t* left_;
  Counters& counters_;
  std::array<Visit, filtered_batch> visits_;  // walks that go on
  std::array<Vec3, filtered_batch> start_;    // where each particle has ridden to
  std::array<bool, filtered_batch> left_behind_;
};
