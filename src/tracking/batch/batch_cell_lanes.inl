// Walks through hexahedra along their lines, from cell to cell: eight at a time, one in each lane. Part of the batch's
// kernel.
//
// Corners are projected along the line as in batch_line_walks.inl, then rounded to floats. A cell has twelve triangles.
// Ten are asked about, all but those of the face that was entered by. Let the line leave by one of the ten alone, and
// each corner of that face be before the target. Then the walk from simplex to simplex leaves by this triangle, too
// (tracking/batch/line_bounds.hpp). Simplices are not looked at. So the cell must be known to be positive.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/float8.inl"
#include "dartcast/cell_complex.hpp"
#include "topology/cell_rows.hpp"
#include "tracking/batch/batch_line_walks.inl"
#include "tracking/batch/line_bounds.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// A corner in each lane, along the lines.
struct LineCorner8 {
  Float8 u, v, z;
};
inline Float8 side(const LineCorner8& a, const LineCorner8& b) { return a.u * b.v - a.v * b.u; }
inline LineCorner8 choose(const Mask8& m, const LineCorner8& a, const LineCorner8& b) {
  return {choose(m, a.u, b.u), choose(m, a.v, b.v), choose(m, a.z, b.z)};
}

// By which triangles lines leave.
struct TrianglesLeft {
  Bits8 at_near_edge;  // of the four lateral faces
  Bits8 at_far_edge;
  Bits8 far_12;  // of the far face: at b1 b2
  Bits8 far_30;  // and at b3 b0
};

// The far corners of eight cells, and their diagonals (CellRow).
struct FarCorners8 {
  const Vec3* at[4][8];
  Mask8 diagonals;

  void set_all(const Vec3* corner) {
    for (auto& lanes : at) std::fill_n(lanes, 8, corner);
    diagonals = splat_int(0);
  }
};

// The faces that four walks enter by.
struct CellStarts4 {
  Lines4 line;
  Vec3x4 near[4];
};

struct CellWalks8 {
  static constexpr unsigned sides_asked = 17;  // edges and diagonals, of each cell

  LineCorner8 near[4];  // the corners of the faces entered by
  Lines4 line[2];       // of four lanes each
  Float8 length;        // as in Lines4
  Float8 reach;         // at most that of Lines4
  Float8 side_bound;    // at least that of Lines4
  // The last cell passed: a bit for each lane.
  unsigned undecided;
  unsigned near_end;  // not all corners of the exit's face are before the target
  Mask8 exit;         // in each lane: number of the way out (CellRow::ways)

  // Lane `to` is the walk of lane `from`. Its length and reach are in the range of floats.
  void begin(unsigned to, const CellStarts4& starts, unsigned from) {
    line[to / 4].take(to % 4, starts.line, from);
    length[to] = static_cast<float>(starts.line.length[from]);
    reach[to] = static_cast<float>(starts.line.reach[from] * (1.0 - 0x1p-22));
    side_bound[to] = static_cast<float>(starts.line.side_bound[from] * (1.0 + 0x1p-22));
    for (unsigned i = 0; i < 4; ++i) {
      near[i].u[to] = static_cast<float>(starts.near[i].x[from]);
      near[i].v[to] = static_cast<float>(starts.near[i].y[from]);
      near[i].z[to] = static_cast<float>(starts.near[i].z[from]);
    }
  }

  // Passes cells.
  [[gnu::always_inline]] void pass(const FarCorners8& corners) {
    LineCorner8 far[4];
    for (unsigned i = 0; i < 4; ++i) far[i] = project(corners.at[i]);
    Mask8 diagonal[5];
    for (unsigned i = 0; i < 5; ++i) diagonal[i] = (corners.diagonals & splat_int(1 << i)) == splat_int(1 << i);
    Float8 least = splat_float(std::numeric_limits<float>::infinity());
    Bits8 entry_behind = 0;
    const TrianglesLeft left = triangles_left(far, diagonal, least, entry_behind);
    undecided = in_a_row(negative_bits(~(least > bound(far))) | unclear(left, entry_behind));
    leave(far, left);
    const Float8 farthest = larger(larger(near[0].z, near[1].z), larger(near[2].z, near[3].z));
    near_end = in_a_row(negative_bits(~(farthest < length)));
  }

 private:
  [[nodiscard]] [[gnu::always_inline]] LineCorner8 project(const Vec3* const (&x)[8]) const {
    const Vec3x4 low = line[0].project(load_vec3x4(*x[0], *x[1], *x[2], *x[3]));
    const Vec3x4 high = line[1].project(load_vec3x4(*x[4], *x[5], *x[6], *x[7]));
    return {narrowed(low.x, high.x), narrowed(low.y, high.y), narrowed(low.z, high.z)};
  }

  // The bound of sides. Infinite if a corner is out of reach.
  [[nodiscard]] [[gnu::always_inline]] Float8 bound(const LineCorner8 (&far)[4]) const {
    Float8 most = Float8{};
    Float8 farthest = Float8{};
    for (unsigned i = 0; i < 4; ++i) {
      most = larger(most, larger(larger(magnitude(near[i].u), magnitude(near[i].v)),
                                 larger(magnitude(far[i].u), magnitude(far[i].v))));
      farthest = larger(farthest, larger(magnitude(near[i].z), magnitude(far[i].z)));
    }
    const Float8 sum = splat_float(rounded_side_error) * (most * most) + side_bound;
    return choose(larger(most, farthest) <= reach, sum, splat_float(std::numeric_limits<float>::infinity()));
  }

  // Which triangles the lines leave by. `least`: the smallest magnitude of a side. `entry_behind`: edges of the face
  // entered by that do not turn around the line.
  [[gnu::always_inline]] TrianglesLeft triangles_left(const LineCorner8 (&far)[4], const Mask8 (&diagonal)[5],
                                                      Float8& least, Bits8& entry_behind) const {
    const auto ask = [&](const LineCorner8& a, const LineCorner8& b) {
      const Float8 s = side(a, b);
      least = smaller(least, magnitude(s));
      return bits_as<Mask8>(s);
    };
    Mask8 entry[4];
    Mask8 lateral[4];
    Mask8 end[4];
    Mask8 across[4];
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned j = (i + 1) % 4;
      entry[i] = ask(near[i], near[j]);
      lateral[i] = ask(near[i], far[i]);
      end[i] = ask(far[i], far[j]);
      across[i] = ask(choose(diagonal[i], near[j], near[i]), choose(diagonal[i], far[i], far[j]));
    }
    const Bits8 far_across =
        negative_bits(ask(choose(diagonal[4], far[1], far[0]), choose(diagonal[4], far[3], far[2])));
    entry_behind = negative_bits(entry[0], entry[1], entry[2], entry[3]);
    const Bits8 l = negative_bits(lateral[0], lateral[1], lateral[2], lateral[3]);
    const Bits8 e = negative_bits(end[0], end[1], end[2], end[3]);
    const Bits8 d = negative_bits(across[0], across[1], across[2], across[3]);
    const Bits8 from_next = negative_bits(diagonal[0], diagonal[1], diagonal[2], diagonal[3]);
    const Bits8 from_1 = negative_bits(diagonal[4]);
    const Bits8 next = next_numbers(l);
    // The line leaves by a triangle if all its edges turn around it, in their order as seen from outside. In each row
    // the first case is that of a diagonal that ends at a_(i+1) or b1.
    return {
        ~entry_behind & ((from_next & ~d & l) | (~from_next & ~next & d)),
        e & ((from_next & ~next & d) | (~from_next & ~d & l)),
        far_across & ~number_of(e, 1) & ~(from_1 & number_of(e, 2)) & ~(~from_1 & number_of(e, 0)) & bits_of_number_0,
        ~far_across & ~number_of(e, 3) & ~(from_1 & number_of(e, 0)) & ~(~from_1 & number_of(e, 2)) & bits_of_number_0,
    };
  }

  // Where the way out is not clear: by several triangles, or none. And where the line leaves two edges in a row of the
  // entry face on their outer side: it may cross that face twice.
  [[nodiscard]] static Bits8 unclear(const TrianglesLeft& left, Bits8 entry_behind) {
    const Bits8 lateral = left.at_near_edge | left.at_far_edge;
    const Bits8 beyond = left.far_12 | left.far_30;
    const Bits8 some = in_any_of_4(lateral);
    const Bits8 several = in_any_of_4(left.at_near_edge & left.at_far_edge) | in_two_of_4(lateral) |
                          (left.far_12 & left.far_30) | (some & beyond);
    const Bits8 none = ~(some | beyond) & bits_of_number_0;
    return several | none | in_any_of_4(entry_behind & next_numbers(entry_behind));
  }

  // The faces left by become those entered by.
  [[gnu::always_inline]] void leave(const LineCorner8 (&far)[4], const TrianglesLeft& left) {
    const Bits8 lateral = left.at_near_edge | left.at_far_edge;
    Mask8 by[4];
    for (unsigned i = 0; i < 4; ++i) by[i] = lanes_with(lateral, i);
    exit = splat_int(8);
    for (unsigned i = 0; i < 4; ++i) exit = choose(by[i], splat_int(2 * static_cast<int>(i)), exit);
    exit -= lanes_with(in_any_of_4(left.at_far_edge) | left.far_30, 0);
    const LineCorner8 a[4] = {near[0], near[1], near[2], near[3]};
    near[0] = next_corner(by, far[0], a[0], a[1], a[2], a[3]);
    near[1] = next_corner(by, far[1], a[1], a[2], a[3], a[0]);
    near[2] = next_corner(by, far[2], far[1], far[2], far[3], far[0]);
    near[3] = next_corner(by, far[3], far[0], far[1], far[2], far[3]);
  }

  // `beyond`, or that of the lateral face that is left by.
  [[nodiscard]] [[gnu::always_inline]] static LineCorner8 next_corner(const Mask8 (&by)[4], const LineCorner8& beyond,
                                                                      const LineCorner8& x0, const LineCorner8& x1,
                                                                      const LineCorner8& x2, const LineCorner8& x3) {
    return choose(by[0], x0, choose(by[1], x1, choose(by[2], x2, choose(by[3], x3, beyond))));
  }
};

// Whether all cells are known to be positive: they were when the complex was made and edited, and no vertex has moved.
inline bool are_known_positive(const CellComplex& complex) {
  return complex.previous_positions().data() == complex.positions().data() && complex.invalid_cells().empty();
}

// Whether a line can be followed in floats.
inline bool in_range_of_floats(const Lines4& line, unsigned lane) {
  return line.reach[lane] > nearest_reach_of_floats && line.reach[lane] < farthest_reach_of_floats;
}

constexpr std::uint32_t hexahedra = CombinatorialMap::pool_of(CellType::hexahedron);
constexpr std::uint32_t words_of_hexahedron = 16;  // their pool's record_stride()

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
