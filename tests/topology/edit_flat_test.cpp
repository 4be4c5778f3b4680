// The marks of straight and coplanar places after edits, against coordinates: no such corner or edge is without its
// mark.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "dartcast/error.hpp"
#include "support/edit_meshes.hpp"
#include "support/exact_vectors.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::edit_flat_test {

using test::CellBag;
using test::cross;
using test::dot;
using test::Edit;
using test::EditKind;
using test::minus;

using Point = std::array<std::int64_t, 3>;

bool is_zero(const Point& a) { return a == Point{0, 0, 0}; }

// A box of cells on a lattice fine enough to halve edges some times: all faces stay flat, all positions exact.
class Lattice {
 public:
  explicit Lattice(CellType type) : map(test::edit_box(type, false, 2)), t(map) {
    const MeshData mesh = test::edit_box(type, false, 2);
    for (const Vec3& p : mesh.points) {
      at.push_back({static_cast<std::int64_t>(p.x * 2 * unit), static_cast<std::int64_t>(p.y * 2 * unit),
                    static_cast<std::int64_t>(p.z * 2 * unit)});
    }
  }

  Point operator()(Dart d) const { return at[map.origin(d).value]; }
  Point edge(Dart d) const { return minus((*this)(map.phi1(d)), (*this)(d)); }

  [[nodiscard]] bool straight(Dart d) const { return is_zero(cross(edge(map.phi_1(d)), edge(d))); }

  // The normal of a face, from a corner that is not straight; none where all are.
  [[nodiscard]] std::optional<Point> normal(Dart d) const {
    Dart x = d;
    do {
      if (!straight(x)) return cross(edge(map.phi_1(x)), edge(x));
      x = map.phi1(x);
    } while (x != d);
    return {};
  }
  [[nodiscard]] bool coplanar(Dart d) const {
    const auto a = normal(d);
    const auto b = normal(map.phi2(d));
    return !a || !b || is_zero(cross(*a, *b));
  }

  // Whether the edit leaves faces flat and positions on the lattice.
  [[nodiscard]] bool possible(const Edit& e) const {
    switch (e.kind) {
      case EditKind::split_edge: {
        const Point v = edge(e.darts[0]);
        return v[0] % 2 == 0 && v[1] % 2 == 0 && v[2] % 2 == 0;
      }
      case EditKind::split_face: return real_parts(e);
      case EditKind::split_cell: return flat_path(e.darts);
      case EditKind::merge_faces: return coplanar(e.darts[0]) && same_way(e.darts[0]);
      case EditKind::merge_edges: return straight(e.darts[0]);
      case EditKind::sew: return on_itself(e);
      default: return true;
    }
  }

  // Whether no corner of the cell lies beyond a face, and no face turns back; a map of other cells is no scene.
  [[nodiscard]] bool convex(Cell c) const {
    const Shape& s = map.shape(c);
    for (std::uint16_t f = 0; f < s.face_count(); ++f) {
      const auto n = normal({c, s.first_dart(f)});
      if (!n) return false;
      for (std::uint16_t d = s.first_dart(f); d < s.first_dart(f) + s.degree(f); ++d) {
        const Point turn = cross(edge({c, s.phi_1(d)}), edge({c, d}));
        if (dot(turn, *n) < 0) return false;
      }
      for (std::uint16_t d = 0; d < s.dart_count(); ++d) {
        if (dot(*n, minus((*this)({c, d}), (*this)({c, s.first_dart(f)}))) > 0) return false;
      }
    }
    return true;
  }

  void place(const EditReport& report) {
    for (const CreatedVertex& v : report.created) {
      if (at.size() <= v.vertex.value) at.resize(v.vertex.value + std::size_t{1});
      const Point& a = at[v.from.value];
      const Point& b = at[v.other.value];
      at[v.vertex.value] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    }
  }

  static constexpr std::int64_t unit = 256;
  CombinatorialMap map;
  Transaction t;
  std::vector<Point> at;

 private:
  // The new edge is not along others.
  [[nodiscard]] bool real_parts(const Edit& e) const {
    const Point v = minus((*this)(e.darts[1]), (*this)(e.darts[0]));
    for (int i = 0; i < 2; ++i) {
      const Dart d = e.darts[static_cast<std::size_t>(i)];
      if (is_zero(cross(v, edge(d))) || is_zero(cross(v, edge(map.phi_1(d))))) return false;
    }
    return true;
  }
  [[nodiscard]] bool flat_path(const std::vector<Dart>& path) const {
    std::optional<Point> n;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Point c = cross(edge(path[i]), edge(path[(i + 1) % path.size()]));
      if (!n && !is_zero(c)) n = c;
    }
    if (!n) return false;
    for (const Dart d : path) {
      if (dot(*n, minus((*this)(d), (*this)(path[0]))) != 0) return false;
      // A face in the plane of the cut would be cut off flat.
      for (const Dart side : {d, map.phi2(d)}) {
        const auto m = normal(side);
        if (!m || is_zero(cross(*m, *n))) return false;
      }
    }
    return true;
  }
  [[nodiscard]] bool same_way(Dart d) const {
    const auto a = normal(d);
    const auto b = normal(map.phi2(d));
    return a && b && dot(*a, *b) > 0;
  }
  [[nodiscard]] bool on_itself(const Edit& e) const {
    Dart a = e.darts[0];
    Dart b = map.phi1(e.darts[1]);
    do {
      if ((*this)(a) != (*this)(b)) return false;
      a = map.phi1(a);
      b = map.phi_1(b);
    } while (a != e.darts[0]);
    return true;
  }
};

struct Marks {
  std::size_t true_straight = 0, true_coplanar = 0, straight = 0, coplanar = 0;
};

Marks marks_of(const Lattice& l, std::span<const Cell> cells) {
  Marks m;
  for (const Cell c : cells) {
    for (std::uint16_t n = 0; n < l.map.shape(c).dart_count(); ++n) {
      const Dart d{c, n};
      const CombinatorialMap::Flat flat = l.map.flat(d);
      if (l.straight(d)) {
        ++m.true_straight;
        EXPECT_TRUE(flat.straight) << "cell " << l.map.source(c) << " vertex " << l.map.origin(d).value;
      }
      if (l.coplanar(d)) {
        ++m.true_coplanar;
        EXPECT_TRUE(flat.coplanar) << "cell " << l.map.source(c) << " vertex " << l.map.origin(d).value;
      }
      EXPECT_EQ(flat.coplanar, l.map.flat(l.map.phi2(d)).coplanar);
      EXPECT_TRUE(!(flat.straight || flat.coplanar) || l.map.has_flat(c));
      m.straight += flat.straight ? 1 : 0;
      m.coplanar += flat.coplanar ? 1 : 0;
    }
  }
  return m;
}

class Flats : public testing::TestWithParam<CellType> {};
INSTANTIATE_TEST_SUITE_P(CombinatorialMap, Flats,
                         testing::Values(CellType::tetrahedron, CellType::hexahedron, CellType::prism,
                                         CellType::pyramid),
                         [](const auto& i) { return std::string(cell_type_names[static_cast<std::size_t>(i.param)]); });

void edit_and_check(Lattice& l, std::span<const EditKind> kinds, int count, std::uint64_t seed,
                    std::array<int, test::edit_kinds>& done) {
  CellBag bag(l.map);
  Random random(seed);
  const std::size_t most = 3 * bag.size();
  for (int i = 0; i < count; ++i) {
    EditKind kind = kinds[random.below(static_cast<std::uint32_t>(kinds.size()))];
    if (kind == EditKind::split_cell && bag.size() > most) kind = EditKind::merge_cells;
    const Edit edit = draw_edit(l.map, kind, bag.draw(l.map, random), bag, random);
    if (edit.darts.empty() || !l.possible(edit)) continue;
    std::vector<Cell> made;
    try {
      made = apply(l.t, edit);
    } catch (const Error&) {
      continue;
    }
    if (kind == EditKind::merge_cells || kind == EditKind::merge_faces) {
      const bool convex = std::all_of(made.begin(), made.end(), [&](Cell c) { return l.convex(c); });
      if (!convex) {
        l.t.roll_back();
        continue;
      }
    }
    const EditReport report = l.t.commit();
    bag.update(report);
    l.place(report);
    ++done[static_cast<std::size_t>(kind)];
    marks_of(l, report.added);
    ASSERT_FALSE(testing::Test::HasFailure()) << "edit " << i << " of kind " << static_cast<int>(kind);
  }
}

TEST_P(Flats, NoneIsWithoutItsMark) {
  using enum EditKind;
  constexpr std::array kinds = {split_edge,  split_face,  split_face,  split_cell,  split_cell,
                                merge_cells, merge_faces, merge_faces, merge_edges, merge_edges,
                                merge_edges, sew,         sew,         unsew};
  std::array<int, test::edit_kinds> done{};
  const int rounds = test::scaled(20, 400);
  Marks all;
  for (int i = 0; i < rounds; ++i) {
    Lattice l(GetParam());
    edit_and_check(l, kinds, 1000, static_cast<std::uint64_t>(i), done);
    const Marks m = marks_of(l, l.map.cells());
    all.true_straight += m.true_straight;
    all.true_coplanar += m.true_coplanar;
  }
  if (test::sanitized()) return;  // too few edits for all kinds
  for (const EditKind kind : kinds)
    EXPECT_GT(done[static_cast<std::size_t>(kind)], rounds / 2) << static_cast<int>(kind);
  EXPECT_GT(all.true_straight, static_cast<std::size_t>(20 * rounds));
  EXPECT_GT(all.true_coplanar, static_cast<std::size_t>(20 * rounds));
}

// Splitting edges and faces marks what is so and nothing else.
TEST_P(Flats, SplittingMarksNothingElse) {
  using enum EditKind;
  constexpr std::array kinds = {split_edge, split_face, split_face};
  std::array<int, test::edit_kinds> done{};
  Lattice l(GetParam());
  edit_and_check(l, kinds, 150, 32, done);
  const Marks m = marks_of(l, l.map.cells());
  EXPECT_EQ(m.straight, m.true_straight);
  EXPECT_EQ(m.coplanar, m.true_coplanar);
  EXPECT_GT(m.straight, 10U);
}

}  // namespace dartcast::edit_flat_test
