// What a batch notes of its steps, all left as it is when the batch is made; and what it asks of particles in a row.
// Part of walk/filtered_kernel.hpp: no include guard, no includes.

// A simplex that a walk has come to.
struct Visit {
  std::uint32_t particle;
  std::uint32_t cell;   // its value
  std::uint16_t index;  // of the simplex, or of the face that was entered through
  std::uint16_t place;  // facet that was entered by (no_facet: none), or triangle of that face
  std::uint16_t tests;  // so far
  std::uint16_t exact;  // of these, those that the filter left open
  bool through_face;
  const std::uint32_t* record;  // of the cell
};

inline constexpr std::uint8_t no_facet = 4;

// Of the simplex that a step begins in.
DARTCAST_TARGET inline Visit first_visit(std::uint32_t particle, const State& s, const std::uint32_t* record,
                                         std::uint16_t tests, int exact) {
  return {particle, s.cell.value, s.simplex, no_facet, tests, static_cast<std::uint16_t>(exact), false, record};
}

// A walk that may leave its first simplex, and what is proved of its target.
struct Departure {
  std::uint32_t particle;
  Signs signs;
  const std::uint32_t* record;  // of its cell
};
struct Arrival {
  std::uint32_t particle;
  std::uint32_t place;  // in the block
};
struct FacetArrival {
  std::uint32_t particle;
  std::uint16_t place;
  Mark on;
};

// Inlined: a call that does nothing but ask would be left out.
[[gnu::always_inline]] DARTCAST_TARGET inline void ask_for(const Vec3* positions, const VertexNumbers& v) {
  for (unsigned i = 0; i < 4; ++i) {
    __builtin_prefetch(positions + v[i]);
    __builtin_prefetch(&(positions + v[i])->z);
  }
}

struct Four {
  std::uint32_t at[4];
};

// What trails keep of a corner.
DARTCAST_TARGET inline Quad determinants_of(const MemosOfFour* memos, const Four& i, unsigned corner) {
  const auto of = [&](std::uint32_t particle) { return memos[particle / 4].w[corner][particle % 4]; };
  return Quad{of(i.at[0]), of(i.at[1]), of(i.at[2]), of(i.at[3])};
}

// Bits of the lanes where it is proved that ride_along() comes to a place strictly inside, other than q; as computed.
DARTCAST_TARGET inline unsigned rides_inside(const MemosOfFour* trails, const Four& i, const Tetrahedra& now,
                                             const Points& q) {
  const Quad w[4] = {determinants_of(trails, i, 0), determinants_of(trails, i, 1), determinants_of(trails, i, 2),
                     determinants_of(trails, i, 3)};
  const Points x = ride_along(w, now);
  const Mask proved = (w[0] == w[0]) & FilteredDeterminants(now, x).all_positive();
  return lanes_set(proved & ((x.x != q.x) | (x.y != q.y) | (x.z != q.z)));
}

DARTCAST_TARGET inline bool any_marked(const Mark* of_four) {
  std::uint32_t four;
  std::memcpy(&four, of_four, sizeof four);
  return four != 0;
}

// Which particles are held, or touch a wall: a bit for each. Few are, so that four are looked at together.
DARTCAST_TARGET inline std::uint32_t held_or_touching(const State* states, std::uint32_t size, std::uint32_t first,
                                                      std::uint32_t n) {
  const auto is = [&](std::uint32_t i) {  // both at once
    static_assert(offsetof(State, held) == offsetof(State, touching_count) + 1);
    std::uint16_t both;
    std::memcpy(&both, reinterpret_cast<const char*>(states + i) + offsetof(State, touching_count), sizeof both);
    return both;
  };
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t i = first + k;
    if (i + 4 <= size && (is(i) | is(i + 1) | is(i + 2) | is(i + 3)) == 0) {
      k += 3;
    } else if (is(i) != 0) {
      bits |= std::uint32_t{1} << k;
    }
  }
  return bits;
}
