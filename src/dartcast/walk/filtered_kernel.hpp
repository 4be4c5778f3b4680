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
DARTCAST_TARGET inline Quad smaller(const Quad& a, const Quad& b) { return a < b ? a : b; }

// The corners of a simplex relative to a point, one in each lane.
struct Lanes {
  Quad x, y, z;
};
DARTCAST_TARGET inline Quad square(const Lanes& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
DARTCAST_TARGET inline Lanes operator-(const Lanes& u, const Lanes& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
// Each lane from the lane named.
template <int a, int b, int c, int d>
DARTCAST_TARGET inline Lanes lanes(const Lanes& v) {
  return {__builtin_shufflevector(v.x, v.x, a, b, c, d), __builtin_shufflevector(v.y, v.y, a, b, c, d),
          __builtin_shufflevector(v.z, v.z, a, b, c, d)};
}
DARTCAST_TARGET inline double sum(const Quad& v) { return (v[0] + v[1]) + (v[2] + v[3]); }
DARTCAST_TARGET inline double most(const Quad& v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
DARTCAST_TARGET inline double least(const Quad& v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

// The determinants of geometry/simplex.hpp, by the same operations, one in each lane; and their bound.
struct FilteredDeterminants {
  Quad value;
  double bound;
  bool applies;

  FilteredDeterminants() = default;
  DARTCAST_TARGET FilteredDeterminants(const Rows& v, const Quad& point) {
    Lanes ignored;
    *this = FilteredDeterminants(v, point, ignored);
  }
  // Leaves the corners relative to the point in `relative`.
  DARTCAST_TARGET FilteredDeterminants(const Rows& v, const Quad& point, Lanes& relative) {
    const Quad r0 = v.corner[0] - point;
    const Quad r1 = v.corner[1] - point;
    const Quad r2 = v.corner[2] - point;
    const Quad r3 = v.corner[3] - point;
    const Quad extent = larger(larger(magnitude(r0), magnitude(r1)), larger(magnitude(r2), magnitude(r3)));
    const double m = extent[0] * extent[1] * extent[2];
    bound = determinant_error * m;
    applies = (lanes_set(extent > 0x1p+301) & 7U) == 0 && m >= 0x1p-700;
    // Corners in lanes, as they are and with neighbours exchanged: (r1, r0, r3, r2).
    const Quad xz01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
    const Quad xz23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
    const Quad y01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
    const Quad y23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
    relative = {__builtin_shufflevector(xz01, xz23, 0, 1, 4, 5), __builtin_shufflevector(y01, y23, 0, 1, 4, 5),
                __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7)};
    const auto& [x, y, z] = relative;
    const auto [xs, ys, zs] = lanes<1, 0, 3, 2>(relative);
    // (n, -n, n', -n') with n = r0 x r1, n' = r2 x r3; then its halves exchanged.
    const Quad nx = y * zs - z * ys;
    const Quad ny = z * xs - x * zs;
    const Quad nz = x * ys - y * xs;
    const Quad mx = __builtin_shufflevector(nx, nx, 2, 3, 0, 1);
    const Quad my = __builtin_shufflevector(ny, ny, 2, 3, 0, 1);
    const Quad mz = __builtin_shufflevector(nz, nz, 2, 3, 0, 1);
    value = xs * mx + ys * my + zs * mz;
  }

  [[nodiscard]] DARTCAST_TARGET double volume6() const { return sum(value); }
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

// What is kept of a simplex for the particle that its corners are relative to, d being its determinants.
DARTCAST_TARGET inline void leave_trail(const Lanes& relative, const FilteredDeterminants& d, Trail& trail) {
  const auto store = [](const Quad& four, std::array<float, 4>& out) DARTCAST_TARGET {
    *reinterpret_cast<UnalignedFloats*>(out.data()) = __builtin_convertvector(four, Floats);
  };
  store(relative.x, trail.x);
  store(relative.y, trail.y);
  store(relative.z, trail.z);
  constexpr double unproved = std::numeric_limits<double>::quiet_NaN();
  const Quad value = d.proves_coordinates() ? d.value : Quad{unproved, unproved, unproved, unproved};
  *reinterpret_cast<UnalignedQuad*>(trail.determinants.data()) = value;
}
DARTCAST_TARGET inline Quad load_four(const std::array<double, 4>& numbers) {
  return *reinterpret_cast<const UnalignedQuad*>(numbers.data());
}

// The corners before the move, relative to where the particle was.
DARTCAST_TARGET inline Lanes corners_before(const Trail& trail) {
  const auto load = [](const std::array<float, 4>& in) DARTCAST_TARGET {
    const Floats four = *reinterpret_cast<const UnalignedFloats*>(in.data());
    return __builtin_convertvector(four, Quad);
  };
  return {load(trail.x), load(trail.y), load(trail.z)};
}

// The coordinates of walk/ride.hpp, and the point that has them in the moved simplex. False where the filter does not
// prove that the simplexes are positive, and the point inside.
DARTCAST_TARGET inline bool ride_along(const Trail& trail, const Rows& now, Vec3& ridden) {
  if (std::isnan(trail.determinants[0])) return false;
  const Quad w = larger(load_four(trail.determinants), Quad{});
  const Quad share = w / (((w[0] + w[1]) + w[2]) + w[3]);
  const Quad x =
      (now.corner[0] * share[0] + now.corner[1] * share[1]) + (now.corner[2] * share[2] + now.corner[3] * share[3]);
  ridden = flushed(vec_of(x));
  return FilteredDeterminants(now, load_row(ridden)).all_positive();
}

// Whether a step relative to moving vertices surely needs no splitting (walk/step.hpp): |A| |r| <= 2 tolerance edge.
//
// The corners' displacements d_i, less the particle's own q - p, have -r as a mean: |r| <= max |d_i|. With
// u_i = d_i - d_0 and n_i the cross products of the old edges e_i from corner 0, A = sum of u_i n_i^T / V, so that
// |A|^2 V^2 <= sum of |u_i|^2 times sum of |n_i|^2. Squares are compared. L is the old distance of the farthest corner:
// floats rounded the old corners by 2^-24 L, and the rule's own doubles round u_i by as much at most, as |q - p| and
// |d_i| are below 2^28 L. So the coordinates of d_i, u_i, n_i and the edges are off by 2^-24 L, 3 2^-24 L, 2^-20 L^2
// and 2^-23 L; squares count that as (a + b)^2 <= 17/16 a^2 + 17 b^2. Products reach L^12: with L in [2^-70, 2^70]
// those on the left neither overflow nor underflow.
class OnePart {
 public:
  // `after`: the moved corners relative to the target q; p: where the particle was.
  DARTCAST_TARGET OnePart(const Trail& trail, const Lanes& after, const Quad& p, const Quad& q, double tolerance)
      : before_(corners_before(trail)) {
    const Lanes d = after - before_;
    const Lanes u = d - lanes<0, 0, 0, 0>(d);
    l2_ = most(square(before_));
    const double farthest = most(square(d));
    const double r2 = 0x1.1p+0 * farthest + 0x1p-42 * l2_;
    const double u2 = 0x1.1p+0 * sum(square(u)) + 0x1p-37 * l2_;
    const Quad own = q - p;
    in_range_ = l2_ > 0x1p-140 && l2_ < 0x1p+140 && farthest < 0x1p+56 * l2_ &&
                (lanes_set(own * own < 0x1p+56 * l2_) & 7U) == 7U;
    u2_r2_ = u2 * r2;
    volume_ = sum(load_four(trail.determinants));  // NaN: then nothing is less
    limit_ = 1.98 * tolerance * volume_;
  }

  // By L alone: |e_i| <= 2 L, sum of |n_i|^2 <= 48 L^4, edge >= V / (4 L^2).
  [[nodiscard]] DARTCAST_TARGET bool by_size() const {
    const double limit = limit_ * volume_;
    const double l4 = l2_ * l2_;
    constexpr double rounding = 1.01;
    return in_range_ && u2_r2_ * (rounding * 48.0 * 16.0) * (l4 * l4) <= limit * limit;
  }

  // By the simplex's own faces and edges.
  [[nodiscard]] DARTCAST_TARGET bool by_shape() const {
    const Lanes e = before_ - lanes<0, 0, 0, 0>(before_);
    const Lanes f = lanes<0, 2, 3, 1>(e);
    const Lanes n = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
    const Quad edges =
        smaller(square(before_ - lanes<1, 2, 3, 0>(before_)), square(before_ - lanes<2, 3, 0, 1>(before_)));
    const double n2 = 0x1.1p+0 * sum(square(n)) + 0x1p-32 * l2_ * l2_;
    const double edge2 = 0.94 * (least(edges) - 0x1p-40 * l2_);
    return in_range_ && u2_r2_ * n2 <= limit_ * limit_ * edge2;
  }

 private:
  Lanes before_;
  double l2_;
  double u2_r2_;
  double volume_;
  double limit_;
  bool in_range_;
};

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
        trails_match_(scene.trails_match),
        tolerance_(scene.tolerance),
        size_(static_cast<std::uint32_t>(steps.states.size())),
        states_(steps.states.data()),
        vertices_(steps.vertices.data()),
        trails_(steps.trails.data()),
        targets_(steps.targets.data()),
        taken_(steps.taken.data()),
        begun_(steps.begun),
        counters_(counters) {}

  DARTCAST_TARGET void run(std::uint64_t most_rounds) {
    if (before_ != nullptr && !trails_match_) look_back();
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
    std::fill_n(taken_, size_, taken_all);
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < std::min(size_, block); ++i) ask_for(now_, vertices_[i]);
    for (std::uint32_t first = 0; first < size_; first += block) {
      const std::uint32_t n = std::min(block, size_ - first);
      for (std::uint32_t k = 0; k < n; ++k) {
        if (first + k + block < size_) ask_for(now_, vertices_[first + k + block]);
        test<moved>(first + k, k);
      }
      const std::uint32_t leaving = ride_all<moved>(first, end_inside<moved>(first, n));
      for (std::uint32_t l = 0; l < leaving; ++l) {
        const std::uint32_t i = first + leaving_[l];
        visits_[count] = {i, states_[i].cell.value, states_[i].simplex, 4, 4, 0, false};
        if (leave_simplex(visits_[count], vertices_[i], leaving_[l])) ++count;
      }
      if constexpr (moved) leave_trails(first, n);
    }
    return count;
  }

  // The trails of particles that followed an earlier move, or none.
  DARTCAST_TARGET void look_back() {
    for (std::uint32_t i = 0; i < size_; ++i) {
      if (i + block < size_) ask_for(before_, vertices_[i + block]);
      const Rows before(before_, vertices_[i]);
      const Quad p = load_row(states_[i].position);
      Lanes relative;
      const FilteredDeterminants d(before, p, relative);
      leave_trail(relative, d, trails_[i]);
    }
  }

  // Of all the block: who goes on, or is left, gets another one later.
  DARTCAST_TARGET void leave_trails(std::uint32_t first, std::uint32_t n) {
    for (std::uint32_t k = 0; k < n; ++k) {
      leave_trail(relative_[k], determinants_[k], trails_[first + k]);
    }
  }

  template <bool moved>
  DARTCAST_TARGET void test(std::uint32_t i, std::uint32_t k) {
    const Rows now(now_, vertices_[i]);
    const Quad target = load_row(targets_[i]);
    determinants_[k] = FilteredDeterminants(now, target, relative_[k]);
    inside_[k] = determinants_[k].all_positive();
    if constexpr (moved)
      one_part_[k] = OnePart(trails_[i], relative_[k], load_row(states_[i].position), target, tolerance_).by_size();
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
      if (s.held || (moved && !one_part_[k] && !is_one_part_after_all(i, k)) ||
          (s.touching_count != 0 && rests<moved>(i))) {
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
    counters_.particle_steps += ended;
    counters_.orientation.tests += std::uint64_t{4} * ended;
    counters_.histogram[4] += ended;
    counters_.forecast_kept += ended;
    return leaving;
  }

  // Of those in leaving_, who goes on. Meanwhile their cells are on the way from memory.
  template <bool moved>
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
    if (OnePart(trails_[i], relative_[k], load_row(states_[i].position), load_row(targets_[i]), tolerance_).by_shape())
      return true;
    const Rows now(now_, vertices_[i]);
    Vec3 ridden;
    if (!ride_along(trails_[i], now, ridden)) return false;
    const auto [gradient, edge] = deformation(corners_of(Rows(before_, vertices_[i])), corners_of(now));
    return gradient * norm(targets_[i] - ridden) <= 2.0 * tolerance_ * edge;
  }

  // Whether a particle that touches a wall is to stay at its place: it goes on touching it.
  template <bool moved>
  DARTCAST_TARGET bool rests(std::uint32_t i) const {
    if constexpr (!moved) return states_[i].position == targets_[i];
    Vec3 ridden;
    return !ride_along(trails_[i], Rows(now_, vertices_[i]), ridden) || ridden == targets_[i];
  }

  // Moves the start of a walk along with the vertices; false where the step is left.
  DARTCAST_TARGET bool ride(std::uint32_t i) {
    const Rows now(now_, vertices_[i]);
    const Vec3 p = states_[i].position;
    left_behind_[i] = FilteredDeterminants(now, load_row(p)).negative() != 0;
    Vec3 ridden;
    if (!ride_along(trails_[i], now, ridden) || ridden == targets_[i]) return leave(i);
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
  DARTCAST_TARGET bool end_at_wall(const Visit& visit, unsigned facet) {
    Walk walk;
    walk.end = WalkEnd::wall;
    walk.simplex = walk.wall_simplex = {Cell(visit.cell), visit.index};
    walk.wall_facet = static_cast<std::uint8_t>(facet);
    return hand_over(visit, walk);
  }
  // The target is on a wall.
  DARTCAST_TARGET bool end_on_wall(const Visit& visit, unsigned on, const SimplexFacet& wall) {
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
    begun_.push_back({before_ == nullptr ? states_[i].position : vec_of(ridden_[i]), walk, {visit.tests, visit.exact}});
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
    if (before_ != nullptr) leave_trail(relative_[k], determinants_[k], trails_[visit.particle]);
    const bool kept = visit.place == 4;
    counters_.forecast_kept += kept ? 1 : 0;
    if (before_ != nullptr && !kept) counters_.updated_by_deformation += left_behind_[visit.particle] ? 1 : 0;
  }

  const Map& map_;
  const Vec3* now_;
  const Vec3* before_;  // null where the scene stands still
  bool trails_match_;
  double tolerance_;
  std::uint32_t size_;
  State* states_;
  VertexNumbers* vertices_;
  Trail* trails_;
  const Vec3* targets_;
  Taken* taken_;
  std::vector<Begun>& begun_;
  Counters& counters_;

  // Of the block.
  std::array<VertexNumbers, block> corners_;
  std::array<FilteredDeterminants, block> determinants_;
  std::array<Lanes, block> relative_;
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
