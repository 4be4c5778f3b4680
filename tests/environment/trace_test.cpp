// The crossings of one particle: against integers on lattices, and against what advance() does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "oracle/scenes.hpp"
#include "support/cells_passed.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::trace_test {

using test::CellsPassed;
using test::Ratio;
using test::WeightedPoint;
using test::Whole;

constexpr int plane_kinds = 3;
constexpr int kinds = plane_kinds + oracle::scene_kinds;

// 0 to 2: triangles, quadrilaterals, mixed polygons; then the kinds of scenes in space.
MeshData lattice(int kind, std::uint64_t seed) {
  if (kind >= plane_kinds) {
    MeshData mesh = oracle::lattice_scene(static_cast<oracle::SceneKind>(kind - plane_kinds), seed);
    for (Vec3& p : mesh.points) p *= 4.0;
    return mesh;
  }
  RectangleOptions o;
  o.cells = {6, 5};
  o.size = {48, 40};
  o.blocked_share = seed % 2 == 0 ? 0.0 : 0.15;
  o.seed = seed;
  if (kind == 0) o.type = CellType::triangle;
  o.mixed = kind == 2;
  return generate_rectangle(o);
}

// Integers in the mesh's box, often on its vertices' coordinates.
class Draw {
 public:
  Draw(const MeshData& mesh, std::uint64_t seed) : random_(seed), low_(mesh.points[0]), high_(mesh.points[0]) {
    for (const Vec3& p : mesh.points) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
    }
  }
  Vec3 operator()() {
    const bool on_planes = random_.below(3) == 0;
    const auto between = [&](double a, double b) {
      const double x = a + static_cast<double>(random_.below(static_cast<std::uint32_t>(b - a) + 1));
      return on_planes ? std::round(x / 8.0) * 8.0 : x;
    };
    const double x = between(low_.x, high_.x);
    const double y = between(low_.y, high_.y);
    return {x, y, low_.z == high_.z ? 0.0 : between(low_.z, high_.z)};
  }
  bool one_in(std::uint32_t n) { return random_.below(n) == 0; }

 private:
  Random random_;
  Vec3 low_, high_;
};

// Whether the dart is where x is: the vertex, on the edge, of the face that holds it.
void expect_dart_at(const Environment& environment, const Crossing& c, const WeightedPoint& x) {
  const CombinatorialMap& map = environment.map();
  ASSERT_EQ(c.dart.cell, c.from);
  const auto corner = [&](Dart d) { return test::whole(environment.positions()[map.origin(d).value]); };
  if (c.kind == Kind::vertex) {
    EXPECT_TRUE(CellsPassed::at_corner(corner(c.dart), x));
    EXPECT_EQ(c.point, environment.positions()[map.origin(c.dart).value]) << "a vertex is given as it is";
  } else if (c.kind == Kind::edge) {
    EXPECT_TRUE(CellsPassed::on_edge(corner(c.dart), corner(map.phi1(c.dart)), x));
  } else {
    EXPECT_EQ(map.opposite(map.face(c.dart)).cell, c.to) << "through a face it comes to the cell behind it";
  }
}

struct Counts {
  std::size_t crossings = 0, vertices = 0, edges = 0, faces = 0, at_start = 0, contacts = 0, unique = 0;
};

// One step of a trace against the truth. Where a crossing is follows from its cells alone: it leaves a cell at the last
// moment at which the closed cell holds the segment.
void check_trace(const Environment& environment, const CellsPassed& truth, const Trace& trace, const Vec3& target,
                 Counts& counts) {
  const Whole p = test::whole(trace.before.position);
  const Whole q = test::whole(target);
  const auto source = [&](Cell c) { return environment.map().source(c); };
  Cell at = trace.before.cell;
  Ratio since{0, 1};
  for (std::size_t i = 0; i < trace.crossings.size(); ++i) {
    const Crossing& c = trace.crossings[i];
    ASSERT_EQ(c.from, at);
    ASSERT_NE(c.to, c.from);
    const auto stay = truth.stay(source(c.from), p, q);
    ASSERT_TRUE(stay);
    if (i > 0) ASSERT_TRUE(since < stay->last) << "crossings at one place are joined";
    ASSERT_FALSE(since < stay->first) << "the cell did not hold it";
    since = stay->last;
    const WeightedPoint x(p, q, since);
    ASSERT_TRUE(truth.holds(source(c.to), x));
    ASSERT_NEAR(c.time, since.rounded(), 1e-12);
    ASSERT_LT(norm(c.point - x.rounded()), 1e-11);
    ASSERT_EQ(c.kind, truth.kind(source(c.from), x));
    ASSERT_EQ(c.kind, truth.kind(source(c.to), x));
    ASSERT_NO_FATAL_FAILURE(expect_dart_at(environment, c, x));
    at = c.to;
    ++counts.crossings;
    counts.vertices += c.kind == Kind::vertex ? 1 : 0;
    counts.edges += c.kind == Kind::edge ? 1 : 0;
    counts.faces += c.kind == Kind::face ? 1 : 0;
    counts.at_start += since == Ratio{0, 1} ? 1 : 0;
  }
  ASSERT_EQ(at, trace.after.cell);
  const auto stay = truth.stay(source(at), p, q);
  ASSERT_TRUE(stay);
  if (!trace.result.stopped) {
    ASSERT_EQ(trace.after.position, target);
    ASSERT_FALSE(stay->last < (Ratio{1, 1})) << "the last cell holds the target";
    return;
  }
  ASSERT_EQ(trace.contacts.contacts.size(), 1U);
  const double impact = trace.contacts.contacts[0].time_of_impact;
  ASSERT_GE(impact, since.rounded() - 1e-12);
  ASSERT_LE(impact, stay->last.rounded() + 1e-12);
  ++counts.contacts;
}

// Where the segment is inside one cell at every time but finitely many, and passes no vertex or edge of space: there is
// but one list of cells.
void check_unique(const Environment& environment, const CellsPassed& truth, const Trace& trace, const Vec3& target,
                  Counts& counts) {
  if (trace.result.stopped) return;
  const Whole p = test::whole(trace.before.position);
  const Whole q = test::whole(target);
  std::vector<std::pair<double, std::uint32_t>> cells;
  double whole = 0.0;
  for (std::uint32_t c = 0; c < truth.size(); ++c) {
    const auto stay = truth.stay(c, p, q);
    if (!stay || !(stay->first < stay->last)) continue;
    cells.emplace_back(stay->first.rounded(), c);
    whole += stay->last.rounded() - stay->first.rounded();
  }
  if (whole > 1.0 + 1e-9) return;  // it runs along a face
  std::sort(cells.begin(), cells.end());
  std::vector<std::uint32_t> expected, found;
  for (const auto& [time, c] : cells) expected.push_back(c);
  const bool starts_elsewhere = !trace.crossings.empty() && trace.crossings[0].time == 0.0;
  if (!starts_elsewhere) found.push_back(environment.map().source(trace.before.cell));
  for (const Crossing& c : trace.crossings) found.push_back(environment.map().source(c.to));
  ASSERT_EQ(found, expected);
  ++counts.unique;
}

class Traces : public testing::TestWithParam<int> {};

TEST_P(Traces, AreRightOnLattices) {
  Counts counts;
  const int seeds = std::max(2, test::scaled(8, 400));
  for (int seed = 1; seed <= seeds; ++seed) {
    const MeshData mesh = lattice(GetParam(), static_cast<std::uint64_t>(seed));
    const CellsPassed truth(mesh);
    Environment environment(mesh);
    Draw draw(mesh, static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 200; ++i) {
      Particles set;
      const Vec3 p = draw();
      if (environment.add(set, {&p, 1})[0].location.place != Place::free) continue;
      Vec3 q = draw();
      if (draw.one_in(3)) q.x = p.x;
      if (draw.one_in(3)) q.y = p.y;
      if (draw.one_in(3)) q.z = p.z;
      SCOPED_TRACE(testing::Message() << "kind " << GetParam() << ", seed " << seed << ", from " << p.x << " " << p.y
                                      << " " << p.z << " to " << q.x << " " << q.y << " " << q.z);
      const std::vector<Trace> traces = environment.trace(set, 0, {&q, 1});
      ASSERT_EQ(traces.size(), 1U);
      ASSERT_NO_FATAL_FAILURE(check_trace(environment, truth, traces[0], q, counts));
      ASSERT_NO_FATAL_FAILURE(check_unique(environment, truth, traces[0], q, counts));
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(counts.crossings, 250U * static_cast<unsigned>(seeds) / 8U);
  EXPECT_GT(counts.vertices, counts.crossings / 50U);
  EXPECT_GT(counts.edges, counts.crossings / 50U);
  if (GetParam() >= plane_kinds) EXPECT_GT(counts.faces, counts.crossings / 10U);
  EXPECT_GT(counts.at_start, counts.crossings / 50U);
  EXPECT_GT(counts.contacts, 0U);
  EXPECT_GT(counts.unique, 0U);
}

// Without flat corners: the own points of their faces are rounded off the planes.
INSTANTIATE_TEST_SUITE_P(Kinds, Traces, testing::Values(0, 1, 2, 3, 4, 5, 6, 7, 8, 10));

bool same_contacts(const ContactList& a, const ContactList& b, std::uint32_t particle) {
  std::vector<Contact> of_particle;
  for (const Contact& c : b.contacts) {
    if (c.particle == particle) of_particle.push_back(c);
  }
  return std::equal(a.contacts.begin(), a.contacts.end(), of_particle.begin(), of_particle.end(),
                    [&](const Contact& x, const Contact& y) {
                      const auto u = a.walls_of(x);
                      const auto v = b.walls_of(y);
                      return x.time_of_impact == y.time_of_impact && x.point == y.point && x.kind == y.kind &&
                             x.dart == y.dart && x.unused == y.unused && x.particle == y.particle &&
                             std::equal(u.begin(), u.end(), v.begin(), v.end(), [](const WallHit& s, const WallHit& t) {
                               return s.face == t.face && s.normal == t.normal;
                             });
                    });
}

// How far x is from the face, edge or vertex at a time of the step.
double distance(const Environment& environment, const Crossing& c) {
  const CombinatorialMap& map = environment.map();
  const auto at = [&](Vertex v) {
    const Vec3 a = environment.complex().previous_positions()[v.value];
    return a + (environment.complex().positions()[v.value] - a) * c.time;
  };
  const Vec3 a = at(map.origin(c.dart));
  if (c.kind == Kind::vertex) return norm(c.point - a);
  if (c.kind == Kind::edge) {
    const Vec3 along = at(map.origin(map.phi1(c.dart))) - a;
    const double t = std::clamp(dot(c.point - a, along) / dot(along, along), 0.0, 1.0);
    return norm(c.point - a - along * t);
  }
  const CellView cell = map.view(c.dart.cell);
  const std::uint16_t face = map.face(c.dart).face;
  double least = 1e300;
  for (std::uint16_t t = 0; t < cell.shape().triangle_count(face); ++t) {
    const auto corners = cell.shape().triangle(face, t);
    const Vec3 u = at(cell.vertex(corners[0]));
    const Vec3 n = cross(at(cell.vertex(corners[1])) - u, at(cell.vertex(corners[2])) - u);
    least = std::min(least, std::abs(dot(c.point - u, n)) / norm(n));
  }
  return least;
}

struct Compared {
  std::size_t steps = 0, crossings = 0, passages = 0, contacts = 0, held = 0, rounded = 0;
};

// Cells follow one another, times and contacts too, and passages are where they say.
void check_chain(const Environment& environment, const Trace& trace, bool moved, Compared& compared) {
  Cell at = trace.before.cell;
  double time = 0.0;
  std::uint32_t contacts = 0;
  for (const Crossing& c : trace.crossings) {
    ASSERT_EQ(c.from, at);
    ASSERT_NE(c.to, c.from);
    ASSERT_TRUE(environment.map().is_free(c.to));
    ASSERT_GE(c.time, time);
    ASSERT_LE(c.time, 1.0);
    ASSERT_GE(c.contacts, contacts);
    if (c.contacts > 0) ASSERT_GE(c.time, trace.contacts.contacts[c.contacts - 1].time_of_impact);
    if (c.contacts < trace.contacts.contacts.size())
      ASSERT_LE(c.time, trace.contacts.contacts[c.contacts].time_of_impact + 1e-12);
    at = c.to;
    time = c.time;
    contacts = c.contacts;
    ++compared.crossings;
    if (!c.dart.valid()) {
      ++compared.rounded;
      continue;
    }
    ++compared.passages;
    ASSERT_EQ(c.dart.cell, c.from);
    if (moved) ASSERT_LT(distance(environment, c), 1e-10);
  }
  ASSERT_EQ(at, trace.after.cell);
}

// One step of many particles: each is traced first, and does then what the trace said.
void compare_step(Environment& environment, Particles& set, const std::vector<Vec3>& targets, bool moved, bool responds,
                  Compared& compared) {
  ContactCallback respond;
  if (responds)
    respond = [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
      return AfterContact{reflected(c.unused, walls, 1.0, 0.0), false};
    };
  std::vector<Trace> traces;
  const std::vector<ParticleState> before = test::copy_of(set);
  for (std::size_t i = 0; i < set.size(); ++i) {
    traces.push_back(environment.trace(set, i, {&targets[i], 1}, respond)[0]);
    ASSERT_NO_FATAL_FAILURE(check_chain(environment, traces[i], moved, compared));
  }
  ASSERT_TRUE(test::same_bits(before, set)) << "a trace changes nothing";
  const StepReport report = environment.advance(set, targets, respond);
  for (std::size_t i = 0; i < set.size(); ++i) {
    ASSERT_TRUE(test::same_bits(traces[i].after, set[i])) << "particle " << i;
    ASSERT_TRUE(same_contacts(traces[i].contacts, report.contacts, static_cast<std::uint32_t>(i)));
    const auto is_it = [&](const auto& x) { return x.particle == i; };
    ASSERT_EQ(traces[i].result.held, std::any_of(report.held.begin(), report.held.end(), is_it));
    ASSERT_EQ(traces[i].result.stopped, std::any_of(report.stopped.begin(), report.stopped.end(), is_it));
  }
  compared.steps += set.size();
  compared.contacts += report.contacts.contacts.size();
  compared.held += report.held.size();
}

MeshData warped(int kind, std::uint64_t seed) {
  if (kind >= plane_kinds) return oracle::random_scene(static_cast<oracle::SceneKind>(kind - plane_kinds), seed, 0.4);
  RectangleOptions o;
  o.cells = {8, 7};
  o.size = {8, 7};
  o.jitter = 0.25;
  o.blocked_share = 0.15;
  o.seed = seed;
  if (kind == 0) o.type = CellType::triangle;
  o.mixed = kind == 2;
  return generate_rectangle(o);
}

// A scene whose diagonal is 10, whatever the size that it comes in; nothing where it is warped too far, or squashed too
// thin.
std::unique_ptr<Environment> scaled_environment(MeshData mesh) {
  Vec3 low = mesh.points[0], high = low;
  for (const Vec3& p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double scale = 10.0 / norm(high - low);
  for (Vec3& p : mesh.points) p = (p - low) * scale;
  try {
    return std::make_unique<Environment>(mesh);
  } catch (const InvalidMesh&) {
    return {};
  }
}

// Turned and shifted, by much or little.
void move(Environment& environment, const std::vector<Vec3>& rest, int step) {
  const double a = (step % 2 == 0 ? 0.3 : 0.05) * std::sin(1.0 + step);
  const std::span<Vec3> next = environment.next_positions();
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const Vec3 r = {rest[k].x - 3.0, rest[k].y - 3.0, rest[k].z};
    next[k] = {r.x * std::cos(a) - r.y * std::sin(a) + a, r.x * std::sin(a) + r.y * std::cos(a), r.z};
  }
  environment.move();
}

void compare_scene(int kind, int seed, Compared& still, Compared& moving) {
  const auto environment = scaled_environment(warped(kind, static_cast<std::uint64_t>(seed)));
  if (!environment) return;
  Random random(static_cast<std::uint64_t>(seed));
  const std::vector<Vec3> rest(environment->positions().begin(), environment->positions().end());
  Vec3 high;
  for (const Vec3& p : rest) high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  Particles set;
  environment->add(set, test::random_points(60, {}, high, random));
  for (int step = 1; step <= 12; ++step) {
    SCOPED_TRACE(testing::Message() << "kind " << kind << ", seed " << seed << ", step " << step);
    const bool moved = step % 3 != 0;
    const double length = step % 4 == 0 ? 8.0 : 1.5;
    std::vector<Vec3> targets;
    for (const ParticleState& s : set.states()) {
      Vec3 r = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      if (kind < plane_kinds) r.z = 0.0;
      targets.push_back(s.position + r * length);
    }
    if (moved) move(*environment, rest, step);
    ASSERT_NO_FATAL_FAILURE(compare_step(*environment, set, targets, moved, step % 2 == 0, moved ? moving : still));
  }
}

class TracesAsAdvanced : public testing::TestWithParam<int> {};

TEST_P(TracesAsAdvanced, ComeToTheSameBits) {
  Compared still, moving;
  for (int seed = 1; seed <= std::max(1, test::scaled(4, 200)); ++seed)
    ASSERT_NO_FATAL_FAILURE(compare_scene(GetParam(), seed, still, moving));
  if (!test::sanitized()) {  // in one scene of a few steps there are less
    EXPECT_GT(still.passages, still.steps / 2);
    EXPECT_GT(moving.passages, moving.steps / 2);
  }
  EXPECT_GT(moving.contacts, 10U);
  EXPECT_LT(still.rounded + moving.rounded, (still.crossings + moving.crossings) / 50U);
}

// Among slivers so thin that a contact or a carried position is rounded into the next cell.
TEST(Trace, SaysWhereRoundingChangesTheCell) {
  Compared still, moving;
  compare_scene(kinds - 1, 162, still, moving);
  EXPECT_GT(still.rounded + moving.rounded, 0U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, TracesAsAdvanced, testing::Range(0, kinds));

// A scene that is carried along by d sees a particle that goes from p to q as one that goes to q - d in the same time.
TEST(Trace, InASceneThatIsCarriedAlongIsThatOfTheRelativeMotion) {
  std::size_t crossings = 0;
  for (int kind = 0; kind < kinds; ++kind) {
    const MeshData mesh = lattice(kind, 2);
    Environment still(mesh);
    Environment carried(mesh);
    Random random(5);
    const Vec3 d = {3.0, -5.0, kind < plane_kinds ? 0.0 : 2.0};
    std::vector<Vec3> next(still.positions().begin(), still.positions().end());
    for (Vec3& x : next) x += d;
    const Vec3 high = {48, 40, kind < plane_kinds ? 0.0 : 48.0};
    const std::vector<Vec3> from = test::random_points(200, {}, high, random);
    const std::vector<Vec3> to = test::random_points(200, {}, high, random);
    Particles a, b;
    const std::vector<AddResult> added = still.add(a, from);
    carried.add(b, from);
    carried.move(next);
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (added[i].location.place != Place::free) continue;
      const Vec3 relative = to[i] - d;
      const Trace here = still.trace(a, added[i].particle, {&relative, 1})[0];
      const Trace there = carried.trace(b, added[i].particle, {&to[i], 1})[0];
      ASSERT_EQ(here.crossings.size(), there.crossings.size());
      for (std::size_t k = 0; k < here.crossings.size(); ++k) {
        const Crossing& x = here.crossings[k];
        const Crossing& y = there.crossings[k];
        ASSERT_TRUE(x.from == y.from && x.to == y.to && x.kind == y.kind && x.dart == y.dart);
        ASSERT_NEAR(x.time, y.time, 1e-12);
        ASSERT_LT(norm(x.point + d * x.time - y.point), 1e-11);
        ++crossings;
      }
    }
  }
  EXPECT_GT(crossings, 500U);
}

TEST(Trace, OfAPathIsThatOfItsSteps) {
  Environment environment(lattice(1, 2));
  Particles set;
  environment.add(set, std::vector<Vec3>{{3, 3, 0}});
  const std::vector<Vec3> path = {{13, 5, 0}, {16, 16, 0}, {40, 16, 0}, {20, 60, 0}, {1, 1, 0}};
  const std::vector<Trace> traces = environment.trace(set, 0, path);
  ASSERT_EQ(traces.size(), 4U) << "it leaves the scene at the fourth";
  for (std::size_t i = 0; i < traces.size(); ++i) {
    EXPECT_TRUE(test::same_bits(traces[i].before, set[0]));
    EXPECT_EQ(traces[i].start.dart,
              forecast(environment.map(), set[0], environment.complex().corners(set[0].at())).dart);
    environment.advance(set, {&path[i], 1});
    EXPECT_TRUE(test::same_bits(traces[i].after, set[0]));
    EXPECT_EQ(traces[i].result.stopped, i == 3);
  }
  EXPECT_EQ(traces[0].start.kind, Kind::face);
  EXPECT_EQ(traces[0].end.kind, Kind::face);
  EXPECT_EQ(traces[1].end.kind, Kind::vertex);
  EXPECT_EQ(traces[2].start.kind, Kind::vertex);
  EXPECT_EQ(traces[3].end.kind, Kind::edge) << "at the wall";
}

// The first step is along with the vertices, the next is in the scene as it stands.
TEST(Trace, OfAPathAfterAMoveMovesOnce) {
  Environment environment(lattice(1, 2));
  Particles set;
  environment.add(set, std::vector<Vec3>{{3, 3, 0}});
  std::vector<Vec3> next(environment.positions().begin(), environment.positions().end());
  for (Vec3& x : next) x += Vec3{4, 0, 0};
  environment.move(next);
  const std::vector<Vec3> path = {{13, 5, 0}, {30, 6, 0}};
  const std::vector<Trace> traces = environment.trace(set, 0, path);
  ASSERT_EQ(traces.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    environment.advance(set, {&path[i], 1});
    EXPECT_TRUE(test::same_bits(traces[i].after, set[0]));
  }
  ASSERT_EQ(traces[0].crossings.size(), 1U);  // 3 + 10 t = 8 + 4 t
  EXPECT_NEAR(traces[0].crossings[0].time, 5.0 / 6.0, 1e-12);
  EXPECT_NEAR(traces[0].crossings[0].point.x, 3.0 + 10.0 * 5.0 / 6.0, 1e-12);
  ASSERT_EQ(traces[1].crossings.size(), 2U);
  EXPECT_NEAR(traces[1].crossings[0].time, 7.0 / 17.0, 1e-12);
  EXPECT_NEAR(traces[1].crossings[1].time, 15.0 / 17.0, 1e-12);
}

// From cell to cell over the corner where four meet: one crossing.
TEST(Trace, ThroughAVertexIsOneCrossing) {
  Environment environment(lattice(1, 2));
  Particles set;
  environment.add(set, std::vector<Vec3>{{4, 4, 0}});
  const std::vector<Vec3> target = {{12, 12, 0}};
  const Trace trace = environment.trace(set, 0, target)[0];
  ASSERT_EQ(trace.crossings.size(), 1U);
  const Crossing& c = trace.crossings[0];
  EXPECT_EQ(c.time, 0.5);
  EXPECT_EQ(c.point, (Vec3{8, 8, 0}));
  EXPECT_EQ(c.kind, Kind::vertex);
  EXPECT_EQ(environment.map().source(c.from), 0U);
  EXPECT_EQ(environment.map().source(c.to), 7U);
}

TEST(Trace, RefusesWhatAdvanceRefuses) {
  Environment environment(lattice(1, 2));
  Particles set;
  environment.add(set, std::vector<Vec3>{{3, 3, 0}});
  const Vec3 target = {13, 5, 0};
  const Vec3 above = {13, 5, 1};
  EXPECT_THROW((void)environment.trace(set, 1, {&target, 1}), InvalidArgument);
  EXPECT_THROW((void)environment.trace(set, 0, {&above, 1}), InvalidArgument);
  EXPECT_THROW((void)environment.trace(set, 0, {&target, 1}, {}, {16, 0.0, 256}), InvalidArgument);
  EXPECT_TRUE(environment.trace(set, 0, {}).empty()) << "nowhere to go";
  environment.move();
  EXPECT_NO_THROW((void)environment.trace(set, 0, {&target, 1}));
  environment.move();
  EXPECT_THROW((void)environment.trace(set, 0, {&target, 1}), InvalidArgument);
}

}  // namespace dartcast::trace_test
