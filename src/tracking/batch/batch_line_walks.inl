// Walks along their lines: from simplex to simplex by the side on which the line passes the new corner. Four walks at a
// time, one in each lane. Part of the batch's kernel.
//
// Each corner is projected along the line once (tracking/batch/line_bounds.hpp). The triangle that a walk enters a
// simplex by turns around the line. The simplex brings one more corner. Its sides towards the three others say by which
// facet the line leaves. It replaces the corner opposite to that facet, and the next triangle turns around the line
// again. No determinant of the target is needed before the end is near.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/double4.inl"
#include "dartcast/combinatorial_map.hpp"
#include "topology/exit_table.hpp"
#include "tracking/batch/batch_simplex.inl"
#include "tracking/batch/line_bounds.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline Double4 with_signs(const Double4& x, const Mask4& signs) { return bits_as<Double4>(bits_as<Mask4>(x) ^ signs); }
inline Mask4 sign_bits(const Double4& x) { return bits_as<Mask4>(x) & splat_bits(static_cast<long long>(1ULL << 63U)); }

// The order of coordinates in which the axis where a line is longest comes last: (y, z, x), (z, x, y) or (x, y, z).
struct AxisOrder4 {
  Mask4 x_last, y_last;

  AxisOrder4() = default;
  explicit AxisOrder4(const Vec3x4& d) {
    const Vec3x4 m = magnitude(d);
    const Mask4 z_last = m.z > larger(m.x, m.y);
    y_last = (m.y > m.x) & ~z_last;
    x_last = ~(y_last | z_last);
  }

  [[nodiscard]] [[gnu::always_inline]] Vec3x4 order(const Vec3x4& a) const {
    const Mask4 x = by_sign(x_last);
    const Mask4 y = by_sign(y_last);
    return {choose(x, a.y, choose(y, a.z, a.x)), choose(x, a.z, choose(y, a.x, a.y)),
            choose(x, a.x, choose(y, a.y, a.z))};
  }
};

// The lines from p to q, and the bounds of what is said about them.
struct Lines4 {
  AxisOrder4 axes;
  Mask4 flip;    // signs of v and z: D_z is positive, and space is not mirrored
  Vec3x4 start;  // p, in that order
  Double4 slope_u, slope_v;
  Double4 length;  // D_z
  Double4 reach;   // G
  Double4 side_bound;

  Lines4() = default;
  // Without bounds.
  Lines4(const Vec3x4& p, const Vec3x4& q) : axes(q - p), start(axes.order(p)) {
    const Vec3x4 d = axes.order(q) - start;
    flip = sign_bits(d.z);
    length = magnitude(d.z);
    slope_u = d.x / length;
    slope_v = with_signs(d.y, flip) / length;
  }

  // Coordinates along the lines.
  [[nodiscard]] [[gnu::always_inline]] Vec3x4 project(const Vec3x4& x) const {
    const Vec3x4 r = axes.order(x) - start;
    const Double4 z = with_signs(r.z, flip);
    return {r.x - slope_u * z, with_signs(r.y, flip) - slope_v * z, z};
  }

  void set_reach(const Double4& largest_coordinate) {
    reach_to(splat(reach_of_first_simplex) * largest_coordinate + (length + length));
  }
  void reach_to(const Double4& most) {
    reach = most;
    side_bound = splat(side_error) * (reach * reach);
  }
  [[nodiscard]] Mask4 in_range() const { return (reach > nearest_reach) & (reach < farthest_reach); }
  [[nodiscard]] Double4 bound3(double error) const { return splat(error / side_error) * (side_bound * reach); }

  // Lane `to` becomes lane `from` of others.
  void take(unsigned to, const Lines4& others, unsigned from) {
    axes.x_last[to] = others.axes.x_last[from];
    axes.y_last[to] = others.axes.y_last[from];
    flip[to] = others.flip[from];
    start.x[to] = others.start.x[from];
    start.y[to] = others.start.y[from];
    start.z[to] = others.start.z[from];
    slope_u[to] = others.slope_u[from];
    slope_v[to] = others.slope_v[from];
    length[to] = others.length[from];
    reach[to] = others.reach[from];
    side_bound[to] = others.side_bound[from];
  }
};

inline Double4 side(const Vec3x4& a, const Vec3x4& b) { return a.x * b.y - a.y * b.x; }

inline void take(Vec3x4& points, unsigned to, const Vec3x4& others, unsigned from) {
  points.x[to] = others.x[from];
  points.y[to] = others.y[from];
  points.z[to] = others.z[from];
}

// Walks that begin in simplices. Sides are of the edges in this order.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> line_edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {2, 3}, {3, 1}}};
struct LineStarts4 {
  Lines4 line;
  Vec3x4 corner[4];
  Double4 edge_side[6];
  Mask4 turns;  // a bit for each edge that turns around the line
  Mask4 in_range;

  LineStarts4() = default;
  [[gnu::always_inline]] LineStarts4(const Corners4& v, const Vec3x4& p, const Vec3x4& q) : line(p, q) {
    for (unsigned i = 0; i < 4; ++i) corner[i] = line.project(v.corner[i]);
    Vec3x4 far = magnitude(corner[0]);
    for (unsigned i = 1; i < 4; ++i) far = larger(far, magnitude(corner[i]));
    line.set_reach(largest(far));
    in_range = line.in_range();
    turns = Mask4{};
    for (unsigned e = 0; e < 6; ++e) {
      edge_side[e] = side(corner[line_edges[e][0]], corner[line_edges[e][1]]);
      turns |= (edge_side[e] > 0.0) & splat_bits(1LL << e);
    }
  }
};

// An edge of a facet among the six, and its direction: 1, or -1 for the opposite one.
struct LineEdge {
  unsigned number;
  double direction;
};
constexpr LineEdge line_edge(unsigned a, unsigned b) {
  for (unsigned e = 0; e < 6; ++e) {
    if (line_edges[e][0] == a && line_edges[e][1] == b) return {e, 1.0};
    if (line_edges[e][0] == b && line_edges[e][1] == a) return {e, -1.0};
  }
  return {0, 0.0};
}
// [facet][i]: from corner i + 1 of its corners to corner i + 2.
inline constexpr auto facet_edges = [] {
  std::array<std::array<LineEdge, 3>, 4> edges{};
  for (unsigned f = 0; f < 4; ++f) {
    for (unsigned i = 0; i < 3; ++i)
      edges[f][i] = line_edge(facet_corners[f][(i + 1) % 3], facet_corners[f][(i + 2) % 3]);
  }
  return edges;
}();
// The facet that a line enters a simplex by, by the bits of LineStarts4::turns. 4: none.
inline constexpr auto facets_entered = [] {
  std::array<std::uint8_t, 64> facets{};
  for (unsigned bits = 0; bits < 64; ++bits) {
    facets[bits] = 4;
    for (std::uint8_t f = 0; f < 4; ++f) {
      bool all = true;
      for (const LineEdge& e : facet_edges[f]) all = all && ((bits >> e.number) & 1U) == (e.direction > 0.0 ? 1U : 0U);
      if (all) facets[bits] = f;
    }
  }
  return facets;
}();

// A simplex is entered by `facet`, and its corner j gives way to the new one. This is the facet by which the walk
// leaves, and how far that facet's corners are turned against those of exit_corners().
struct LineTurn {
  std::uint8_t facet;
  std::uint8_t turn;
};
constexpr LineTurn turn_of(unsigned facet, unsigned turn, unsigned slot) {
  const unsigned j = (slot + 3 - turn) % 3;
  const unsigned left_by = facet_corners[facet][j];
  const unsigned first = j == 0 ? facet : facet_corners[facet][0];
  unsigned n = 0;
  while (n < 2 && exit_corners(left_by)[n] != first) ++n;
  return {static_cast<std::uint8_t>(left_by), static_cast<std::uint8_t>((turn + 3 - n) % 3)};
}
// [4 * facet + turn][slot]
inline constexpr auto line_turns = [] {
  std::array<std::array<LineTurn, 4>, 16> turns{};
  for (unsigned facet = 0; facet < 4; ++facet) {
    for (unsigned turn = 0; turn < 3; ++turn) {
      for (unsigned slot = 0; slot < 3; ++slot) turns[4 * facet + turn][slot] = turn_of(facet, turn, slot);
    }
  }
  return turns;
}();
inline constexpr std::array<std::uint8_t, 8> modulo_3 = {0, 1, 2, 0, 1, 2, 0, 1};

// Four walks. Slot i of a triangle: its corner i, and the side of the edge from the next corner to the one after.
struct LineWalks4 {
  Lines4 line;
  Vec3x4 corner[3];
  Double4 edge_side[3];
  // The last simplex passed: a bit for each lane.
  unsigned undecided;
  unsigned near_end;  // not all corners of the exit are before the target
  Mask4 slot;         // in each lane: of the triangle's corner that the new one has replaced

  // Passes simplices by their new corners.
  [[gnu::always_inline]] void pass(const Vec3x4& x) {
    const Vec3x4 d = line.project(x);
    const Double4 a = side(d, corner[0]);
    const Double4 b = side(d, corner[1]);
    const Double4 c = side(d, corner[2]);
    const Mask4 proved = (smaller(smaller(magnitude(a), magnitude(b)), magnitude(c)) > line.side_bound) &
                         (largest(magnitude(d)) <= line.reach) & (volume(d, a, b, c) > line.bound3(volume_error));
    undecided = lanes_set(~proved);
    const Mask4 slot0 = (b > 0.0) & (c < 0.0);
    const Mask4 slot1 = (c > 0.0) & (a < 0.0);
    const Mask4 slot2 = (a > 0.0) & (b < 0.0);
    slot = (slot1 & splat_bits(1)) | (slot2 & splat_bits(2));
    corner[0] = choose(slot0, d, corner[0]);
    corner[1] = choose(slot1, d, corner[1]);
    corner[2] = choose(slot2, d, corner[2]);
    edge_side[0] = choose(slot1, c, choose(slot2, -b, edge_side[0]));
    edge_side[1] = choose(slot2, a, choose(slot0, -c, edge_side[1]));
    edge_side[2] = choose(slot0, b, choose(slot1, -a, edge_side[2]));
    near_end = lanes_set(larger(larger(corner[0].z, corner[1].z), corner[2].z) >= line.length);
  }

  // Six times the volume of the triangle's and the corner's simplex. a, b, c: sides of the corner and the triangle's.
  [[nodiscard]] [[gnu::always_inline]] Double4 volume(const Vec3x4& d, const Double4& a, const Double4& b,
                                                      const Double4& c) const {
    const Double4 around = edge_side[0] + edge_side[1] + edge_side[2];
    const Double4 triangle = corner[0].z * (edge_side[0] + (b - c)) + corner[1].z * (edge_side[1] + (c - a)) +
                             corner[2].z * (edge_side[2] + (a - b));
    return d.z * around - triangle;
  }

  // Where the target is, seen from the exit: +1 before it, -1 beyond, 0 undecided.
  [[nodiscard]] int side_of_target(unsigned lane) const {
    const double length = line.length[lane];
    const double reach = line.reach[lane];
    const double sum = edge_side[0][lane] * (corner[0].z[lane] - length) +
                       edge_side[1][lane] * (corner[1].z[lane] - length) +
                       edge_side[2][lane] * (corner[2].z[lane] - length);
    const double bound = end_error / side_error * (line.side_bound[lane] * reach);
    return sum > bound ? 1 : sum < -bound ? -1 : 0;
  }

  // Lane `to` is the walk of lane `from` of those that begin, in the simplex that it enters by this facet.
  void begin(unsigned to, const LineStarts4& starts, unsigned from, unsigned facet) {
    line.take(to, starts.line, from);
    for (unsigned i = 0; i < 3; ++i) {
      take(corner[i], to, starts.corner[facet_corners[facet][i]], from);
      const LineEdge e = facet_edges[facet][i];
      edge_side[i][to] = e.direction * starts.edge_side[e.number][from];
    }
  }
  // Whether it is proved that the line passes inside of the triangle.
  [[nodiscard]] bool is_inside(unsigned lane) const {
    const double bound = line.side_bound[lane];
    return std::min({edge_side[0][lane], edge_side[1][lane], edge_side[2][lane]}) > bound;
  }
};

// Where a walk is: its next simplex, and the last one that it has passed.
struct LinePlace {
  const std::uint32_t* record;  // of the cell
  const Vec3* corner;           // the new corner of the next simplex
  const SimplexExit* exits;     // of that simplex
  std::uint32_t cell;
  std::uint32_t passed_cell;
  std::uint32_t particle;
  std::uint32_t passed;  // simplices
  std::uint32_t tests;   // besides the three of each simplex
  std::uint32_t face;    // entered by, and
  std::uint32_t place;   // its triangle, as in ExitTable::entry()
  std::uint32_t turn;    // of that triangle's corners
  std::uint32_t row;
  std::uint32_t turned_facet;  // 4 times the row's facet, and its turn
  std::uint32_t exit_facet;

  // In the simplex that has this row (topology/exit_table.hpp): the walk enters it by the row's facet.
  void begin(std::uint32_t walker, std::uint32_t cell_of_row, const std::uint32_t* cell_record,
             std::uint32_t row_entered, std::uint32_t passed_before, std::uint32_t tests_before) {
    record = cell_record;
    particle = walker;
    cell = cell_of_row;
    passed = passed_before;
    tests = tests_before;
    face = 0;
    place = row_entered;
    turn = 0;
  }
  [[nodiscard]] std::uint32_t all_tests() const { return tests + 3 * passed; }
};

// Out of a cell, or on within it.
struct LineCrossing {
  std::uint32_t cell;
  std::uint32_t face;  // 0: within the cell; else 1 + its number in the cell beyond
  unsigned wall;
};

// Without branches.
[[gnu::always_inline]] inline LineCrossing cross(std::uint32_t cell, const std::uint32_t* record,
                                                 const SimplexExit& exit, std::uint32_t number, unsigned wall) {
  const std::uint32_t passes = 0U - (exit.outer & ~wall);
  return {cell ^ ((cell ^ record[exit.word]) & passes), (number + 1) & passes, wall};
}

[[gnu::always_inline]] inline LineCrossing cross_general(std::uint32_t cell, const std::uint32_t* record,
                                                         const SimplexExit& exit) {
  const std::uint32_t bits = record[exit.extra];
  const unsigned wall = exit.outer & static_cast<unsigned>(bits >> 16U != 0);
  return cross(cell, record, exit, bits & 0xffffU, wall);
}

// The number of a face's neighbour that may not fit in its 3 bits.
[[gnu::cold, gnu::noinline]] inline std::uint32_t wide_number(const CombinatorialMap& map, std::uint32_t cell,
                                                              const std::uint32_t* record, const SimplexExit& exit) {
  const CellView view = map.view(Cell(cell), record);
  return view.neighbour_face(static_cast<std::uint16_t>(exit.word - 2U - view.shape().point_count()));
}

[[gnu::always_inline]] inline LineCrossing cross_standard(const CombinatorialMap& map, std::uint32_t cell,
                                                          const std::uint32_t* record, const SimplexExit& exit) {
  const std::uint32_t bits = record[1];
  const unsigned wall = (bits >> exit.wall_shift) & 1U;
  std::uint32_t number = (bits >> exit.face_shift) & 7U;
  if (number == 7 && exit.outer > wall) [[unlikely]]
    number = wide_number(map, cell, record, exit);
  return cross(cell, record, exit, number, wall);
}

// Finds the next simplex, and prefetches its new corner. Returns false if the shape has no table.
[[gnu::always_inline]] inline bool find_corner(LinePlace& at, const CombinatorialMap& map, const Vec3* positions) {
  const ExitTable& table = map.view(Cell(at.cell), at.record).shape().exits();
  if (table.empty()) [[unlikely]]
    return false;
  const SimplexEntry entry = table.entry(at.face, at.place);
  at.corner = &positions[at.record[2U + entry.apex]];
  at.row = entry.row();
  at.turned_facet = 4 * (at.row % 4) + modulo_3[at.turn + 3 - entry.turn()];
  at.exits = table.exits_of(at.row / 4);
  __builtin_prefetch(at.corner);
  __builtin_prefetch(&at.corner->z);
  return true;
}

// Leaves the simplex, where the new corner has taken a slot of the triangle's, and prefetches the next cell. Returns
// whether the exit is a wall.
[[gnu::always_inline]] inline unsigned leave(LinePlace& at, unsigned slot, const CombinatorialMap& map) {
  const LineTurn way = line_turns[at.turned_facet][slot];
  const SimplexExit& exit = at.exits[way.facet];
  const std::uint32_t place = exit.place;
  const std::uint32_t turn = exit.turn;
  const bool general = Cell(at.cell).pool() == CombinatorialMap::general_pool;
  const LineCrossing next =
      general ? cross_general(at.cell, at.record, exit) : cross_standard(map, at.cell, at.record, exit);
  at.passed_cell = at.cell;
  at.exit_facet = way.facet;
  ++at.passed;
  at.cell = next.cell;
  at.record = map.record(Cell(next.cell));
  __builtin_prefetch(at.record);
  at.face = next.face;
  at.place = place;
  at.turn = way.turn + turn;
  return next.wall;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
