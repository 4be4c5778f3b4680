// Meshes with periodic pairs: boxes of cubes, whose points are moved in ways that fit at both sides.
//
// Tetrahedra and cells of the plane get points that move each by itself. Faces of more corners would be bent then, and
// partners may be cut along other diagonals. There, whole planes of points move.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dartcast/generators.hpp"
#include "mesh/cell_types.hpp"
#include "soak/periodic.hpp"

namespace dartcast::soak {

namespace {

using Corners = std::array<std::uint32_t, 8>;

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

double& part(Vec3& x, unsigned axis) { return axis == 0 ? x.x : axis == 1 ? x.y : x.z; }
double part(Vec3 x, int axis) { return part(x, static_cast<unsigned>(axis)); }

// Each cube is a hexahedron, six pyramids, or, in a whole column along z, two prisms. So opposite sides of the box are
// alike.
MeshData mixed_box(const std::array<std::uint32_t, 3>& n, Random& random) {
  MeshData mesh = generate_box({.cells = n});
  MeshData mixed;
  mixed.points = mesh.points;
  std::vector<bool> prisms(std::size_t{n[0]} * n[1]);
  for (std::size_t i = 0; i < prisms.size(); ++i) prisms[i] = random.below(3) == 0;
  for (std::size_t cube = 0; cube < mesh.cell_count(); ++cube) {
    Corners v{};
    std::copy_n(mesh.cell(cube).begin(), 8, v.begin());
    if (prisms[cube % prisms.size()]) {
      mixed.add_cell(CellType::prism, std::array{v[0], v[1], v[2], v[4], v[5], v[6]});
      mixed.add_cell(CellType::prism, std::array{v[0], v[2], v[3], v[4], v[6], v[7]});
    } else if (random.below(2) == 0) {
      mixed.add_cell(CellType::hexahedron, v);
    } else {
      const auto middle = static_cast<std::uint32_t>(mixed.points.size());
      mixed.points.push_back((mesh.points[v[0]] + mesh.points[v[6]]) * 0.5);
      for_each_face(mesh, cube, [&](std::span<const std::uint32_t> f) {  // as seen from the outside
        mixed.add_cell(CellType::pyramid, std::array{f[3], f[2], f[1], f[0], middle});
      });
    }
  }
  mixed.patch_names = mesh.patch_names;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto side = mesh.patch_face(f);
    const bool along_z = mesh.points[side[0]].z == mesh.points[side[2]].z;
    const Vec3 low = mesh.points[*std::min_element(side.begin(), side.end())];
    if (!along_z || !prisms[static_cast<std::size_t>(low.x) + n[0] * static_cast<std::size_t>(low.y)]) {
      mixed.add_patch_face(side, mesh.patch_tags[f]);
      continue;
    }
    std::array<std::uint32_t, 4> v{};  // from the lowest corner on, whose diagonal both prisms have
    std::copy(side.begin(), side.end(), v.begin());
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    mixed.add_patch_face(std::array{v[0], v[1], v[2]}, mesh.patch_tags[f]);
    mixed.add_patch_face(std::array{v[0], v[2], v[3]}, mesh.patch_tags[f]);
  }
  return mixed;
}

MeshData box_of(const Case& c, std::array<std::uint32_t, 3> n, Random& random) {
  if (c.is(Knob::mesh, "plane")) {
    RectangleOptions o;
    o.cells = {n[0], n[1]};
    o.mixed = random.below(2) == 0;
    o.type = random.below(2) == 0 ? CellType::triangle : CellType::quadrilateral;
    o.seed = c.seed;
    return generate_rectangle(o);
  }
  if (c.is(Knob::mesh, "mixed")) return mixed_box(n, random);
  BoxOptions box;
  box.cells = n;
  if (c.is(Knob::mesh, "tetrahedra")) box.type = CellType::tetrahedron;
  if (c.is(Knob::mesh, "prisms")) box.type = CellType::prism;
  if (c.is(Knob::mesh, "pyramids")) box.type = CellType::pyramid;
  return generate_box(box);
}

void add_shift(SceneMesh& scene, unsigned axis, Random& random) {
  Vec3 along;
  part(along, axis) = part(scene.box, static_cast<int>(axis));
  std::string low = axis_names[axis] + std::string("min"), high = axis_names[axis] + std::string("max");
  const bool back = random.below(2) == 0;
  if (back) std::swap(low, high);
  if (!back) along = -along;
  scene.pairs.push_back({0, along});
  scene.mesh.periodic.push_back({high, low, along});
}

// A quarter of a turn about the edge x = y = 0, which may be written in several ways.
void add_turn(SceneMesh& scene, Random& random) {
  PeriodicPair pair{"ymin", "xmin", {}, {0.0, 0.0, 1.0}, {0.0, 0.0, double(random.below(4))}, 90.0};
  Placing turn{1, {}};
  if (random.below(2) == 0) {
    std::swap(pair.a, pair.b);
    turn = turn.inverse();
    pair.angle = random.below(2) == 0 ? -90.0 : 270.0;
  }
  if (random.below(2) == 0) {
    pair.axis.z = -2.0;
    pair.angle = -pair.angle;
  }
  if (scene.mesh.dimension() == 2) pair.centre = {};
  scene.pairs.push_back(turn);
  scene.mesh.periodic.push_back(pair);
}

bool turns(const SceneMesh& scene) { return scene.pairs.front().quarters != 0; }

// The number of a place, the same at all places that pairs make one.
struct Key {
  Vec3 at;                // the first of these
  unsigned quarters = 0;  // that vectors there turn on the way here
};
Key key_of(const SceneMesh& scene, Vec3 x) {
  for (unsigned a = 0; a < 3; ++a) {
    const bool wraps = std::any_of(scene.pairs.begin(), scene.pairs.end(),
                                   [&](const Placing& p) { return part(p.shift, static_cast<int>(a)) != 0.0; });
    if (wraps && part(x, a) == part(scene.box, static_cast<int>(a))) part(x, a) = 0.0;
  }
  if (turns(scene) && x.x == 0.0 && x.y != 0.0) return {{x.y, 0.0, x.z}, 1};
  return {x, 0};
}

// A multiple of 2^-15 in [-size, size).
double amount(const Case& c, std::uint64_t step, std::uint64_t id, double size) {
  Random random = random_for(c, Use::motion, 5000 + step, id);
  const auto half = static_cast<std::uint32_t>(size * 0x1p15);
  return (double(random.below(2 * half)) - half) * 0x1p-15;
}

}  // namespace

SceneMesh make_periodic_mesh(const Case& c, Random& random) {
  SceneMesh scene;
  const bool one = c.is(Knob::mesh, "one cell"), many = c.is(Knob::mesh, "10^4 cells");
  const bool plane = c.is(Knob::mesh, "plane"), turned = c.is(Knob::periodic, "turned");
  const std::uint32_t size = one ? 1 : many ? 22 : 2 + c[Knob::size] % 3;
  std::array<std::uint32_t, 3> n = {size, size, size};
  if (!one && !many) n = {size, turned ? size : 1 + random.below(size), 1 + random.below(size)};
  scene.mesh = box_of(c, n, random);
  scene.box = {double(n[0]), double(n[1]), plane ? 0.0 : double(n[2])};
  const unsigned axes = plane ? 2 : 3;
  if (turned) {
    add_turn(scene, random);
    if (!plane && random.below(2) == 0) add_shift(scene, 2, random);
  } else if (c.is(Knob::periodic, "one axis")) {
    add_shift(scene, random.below(axes), random);
  } else {
    for (unsigned a = 0; a < axes; ++a) add_shift(scene, a, random);
  }
  scene.lattice = scene.mesh.points;
  if (random.below(2) == 0) scene.mesh.points = shaken_alike(c, scene, 0, 0.05);
  return scene;
}

bool is_on_border(const SceneMesh& scene, std::uint32_t point) {
  const Vec3& x = scene.lattice[point];
  for (int a = 0; a < 3; ++a)
    if (part(scene.box, a) != 0.0 && (part(x, a) == 0.0 || part(x, a) == part(scene.box, a))) return true;
  return false;
}

std::vector<Vec3> shaken_alike(const Case& c, const SceneMesh& scene, std::uint64_t step, double size) {
  std::vector<Vec3> next;
  const bool plane = scene.mesh.dimension() == 2;
  const bool each = plane || c.is(Knob::mesh, "tetrahedra");
  const auto of_plane = [&](unsigned axis, double at) {  // of points; between two planes the mean
    const auto one = [&](double x) {
      Vec3 place;
      part(place, axis) = x;
      const bool alike = turns(scene) && axis < 2;
      const double key = alike ? x : part(key_of(scene, place).at, static_cast<int>(axis));
      if (alike && x == 0.0) return 0.0;
      return amount(c, step, static_cast<std::uint64_t>(key) * 4 + (alike ? 0 : axis), size);
    };
    return 0.5 * (one(std::floor(at)) + one(std::ceil(at)));
  };
  for (const Vec3& x : scene.lattice) {
    Vec3 by;
    if (each) {
      const Key key = key_of(scene, x);
      const std::uint64_t id =
          1000 + std::uint64_t(2 * key.at.x) + 64 * std::uint64_t(2 * key.at.y) + 4096 * std::uint64_t(2 * key.at.z);
      for (unsigned a = 0; a < 3; ++a) part(by, a) = amount(c, step, id * 3 + a, size);
      if (turns(scene) && key.at.x == 0.0 && key.at.y == 0.0) by.x = by.y = 0.0;
      by = Placing{key.quarters, {}}.vector(by);
    } else {
      for (unsigned a = 0; a < 3; ++a) part(by, a) = of_plane(a, part(x, static_cast<int>(a)));
    }
    if (plane) by.z = 0.0;
    next.push_back(x + by);
  }
  return next;
}

Vec3 place_on_border(const SceneMesh& scene, Random& random) {
  std::vector<std::uint32_t> corners;
  for (int tries = 0; tries < 20; ++tries) {
    const auto faces = static_cast<std::uint32_t>(scene.mesh.patch_tags.size());
    const std::uint32_t f = random.below(faces);
    const auto side = scene.mesh.patch_face(f);
    corners.assign(side.begin(), side.end());
    const std::string& name = scene.mesh.patch_names.at(scene.mesh.patch_tags[f]);
    const auto& pairs = scene.mesh.periodic;
    if (std::any_of(pairs.begin(), pairs.end(), [&](const auto& p) { return p.a == name || p.b == name; })) break;
  }
  const auto any = [&] { return scene.mesh.points[corners[random.below(std::uint32_t(corners.size()))]]; };
  const Vec3 a = any(), b = any(), d = any();
  return a * 0.25 + b * 0.5 + d * 0.25;
}

}  // namespace dartcast::soak
