// Makes meshes, draws edits, moves vertices.
#include "soak/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/validity.hpp"
#include "mesh/cell_types.hpp"
#include "soak/periodic.hpp"
#include "support/meshes.hpp"
#include "support/patchwork.hpp"
#include "support/random_edits.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::soak {

Random random_for(const Case& c, Use use, std::uint64_t step, std::uint64_t id) {
  return Random(c.seed * 0x9e3779b97f4a7c15U + step * 1000003U + id, static_cast<std::uint64_t>(use));
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// --- meshes

MeshData make_box(const Case& c, std::array<std::uint32_t, 3> cells, Random& random) {
  BoxOptions box;
  box.cells = cells;
  box.size = {double(cells[0]), double(cells[1]), double(cells[2])};
  constexpr std::array<std::pair<std::string_view, CellType>, 4> types = {{{"tetrahedra", CellType::tetrahedron},
                                                                           {"prisms", CellType::prism},
                                                                           {"pyramids", CellType::pyramid},
                                                                           {"slivers", CellType::tetrahedron}}};
  for (const auto& [name, type] : types)
    if (c.is(Knob::mesh, name)) box.type = type;
  box.mixed = c.is(Knob::mesh, "mixed");
  box.jitter = c.is(Knob::mesh, "slivers") ? 0.45 : random.below(2) == 0 ? 0.0 : 0.25;
  box.seed = c.seed;
  return generate_box(box);
}

MeshData make_cells(const Case& c, Random& random) {
  const std::uint32_t n = 2 + c[Knob::size];
  const std::string_view kind = c.name(Knob::mesh);
  if (kind == "one cell") return make_box(c, {1, 1, 1}, random);
  if (kind == "10^4 cells") return make_box(c, {22, 22, 22}, random);
  if (kind == "patchwork") return test::patchwork({n + 1, n, n}, random);
  if (kind == "octahedra") {
    OctahedraOptions o;
    o.cells = {n, n, n};
    o.size = {double(n), double(n), double(n)};
    return generate_octahedra(o);
  }
  if (kind == "vessel") {
    VesselOptions vessel;
    vessel.core = 2;
    vessel.rings = 1;
    vessel.step_length = 1.5e-3;
    return generate_vessel(vessel);
  }
  if (kind == "plane") {
    RectangleOptions o;
    o.cells = {3 * n, 2 * n};
    o.size = {3.0 * n, 2.0 * n};
    o.mixed = random.below(2) == 0;
    o.type = random.below(2) == 0 ? CellType::triangle : CellType::quadrilateral;
    o.jitter = random.below(2) == 0 ? 0.0 : 0.25;
    o.seed = c.seed;
    return generate_rectangle(o);
  }
  if (kind == "maze") {
    MazeOptions o;
    o.rooms = {2, 1 + c[Knob::size] / 2};
    o.room_cells = 3 + n / 2;
    o.obstacles = 2;
    o.size = {double(o.rooms[0] * (o.room_cells + 1)), double(o.rooms[1] * (o.room_cells + 1))};
    o.seed = c.seed;
    return generate_maze(o);
  }
  return make_box(c, {n + random.below(2), n, n}, random);
}

// Blocks cells, and leaves those blocked that are.
void block(MeshData& mesh, std::uint32_t one_of, Random& random) {
  if (mesh.free.empty()) mesh.free.assign(mesh.cell_count(), 1);
  for (auto& free : mesh.free)
    if (random.below(one_of) == 0) free = 0;
  if (std::none_of(mesh.free.begin(), mesh.free.end(), [](auto f) { return f != 0; })) mesh.free[0] = 1;
}

// Some faces between two cells become walls.
void add_baffles(MeshData& mesh, Random& random) {
  std::map<std::vector<std::uint32_t>, std::pair<int, std::vector<std::uint32_t>>> faces;  // by sorted corners
  for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell) {
    for_each_face(mesh, cell, [&](std::span<const std::uint32_t> f) {
      std::vector<std::uint32_t> sorted(f.begin(), f.end());
      std::sort(sorted.begin(), sorted.end());
      auto& face = faces[sorted];
      ++face.first;
      face.second.assign(f.begin(), f.end());
    });
  }
  constexpr std::int32_t tag = 4711;
  for (const auto& [corners, face] : faces)
    if (face.first == 2 && random.below(8) == 0) mesh.add_patch_face(face.second, tag);
  mesh.patch_names[tag] = "baffle";
  mesh.baffle_tags = {tag};
}

// --- edits

Cell any_cell(const CombinatorialMap& map, Random& random) {
  const std::vector<Cell> cells = map.cells();
  return cells[random.below(static_cast<std::uint32_t>(cells.size()))];
}

// Walls on some faces between two cells.
std::function<void(ComplexEdit&)> new_walls(const CombinatorialMap& map, Random& random) {
  std::vector<CellFace> faces;
  for (int i = 0; i < 12; ++i) {
    const Cell c = any_cell(map, random);
    const auto count = static_cast<std::uint32_t>(map.shape(c).face_count());
    const CellFace f{c, static_cast<std::uint16_t>(random.below(count))};
    if (map.opposite(f).valid()) faces.push_back(f);
  }
  return [faces](ComplexEdit& edit) { set_walls(edit.topology(), faces, Patch{}); };
}

std::function<void(ComplexEdit&)> single(const Environment& environment, test::EditKind kind, Random& random) {
  const CombinatorialMap& map = environment.map();
  const test::CellBag bag(map);
  const test::Edit e =
      test::draw_edit(map, test::in_dimension(kind, map.dimension()), bag.draw(map, random), bag, random);
  return [e](ComplexEdit& edit) { test::apply(edit.topology(), e); };
}

}  // namespace

SceneMesh make_mesh(const Case& c) {
  Random random = random_for(c, Use::mesh);
  SceneMesh scene;
  if (c[Knob::periodic] != 0)
    scene = make_periodic_mesh(c, random);
  else
    scene.mesh = make_cells(c, random);
  const std::string_view walls = c.name(Knob::walls);
  if (walls == "a few cells") block(scene.mesh, 12, random);
  if (walls == "many cells") block(scene.mesh, 3, random);
  if (walls == "baffles" && scene.mesh.dimension() == 3) add_baffles(scene.mesh, random);
  check_and_repair(scene.mesh);  // points that no cell has
  scene.low = scene.high = scene.mesh.points.front();
  for (const Vec3& p : scene.mesh.points) {
    scene.low = {std::min(scene.low.x, p.x), std::min(scene.low.y, p.y), std::min(scene.low.z, p.z)};
    scene.high = {std::max(scene.high.x, p.x), std::max(scene.high.y, p.y), std::max(scene.high.z, p.z)};
  }
  scene.edge = c.is(Knob::mesh, "vessel") ? 1.5e-3 : 1.0;
  return scene;
}

bool has_bent_sheets(const Case& c) {
  return c[Knob::edits] > 0 &&
         (c.is(Knob::walls, "baffles") || c.is(Knob::edit, "open faces") || c.is(Knob::edit, "all"));
}

Chambers::Chambers(const CombinatorialMap& map, const std::function<CellFace(CellFace)>& partner) {
  std::uint32_t next = 0;
  std::vector<Cell> open;
  for (const Cell start : map.cells()) {
    if (!number_.emplace(start.value, next).second) continue;
    open.assign(1, start);
    while (!open.empty()) {
      const Cell at = open.back();
      const CellView view = map.view(at);
      open.pop_back();
      for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
        Cell other = view.neighbour(f);
        bool leads_on = other.valid() && map.is_free(other) == view.is_free() && !view.is_wall(f);
        if (view.is_free() && view.is_wall(f)) {
          other = partner({at, f}).cell;
          leads_on = other.valid();
        }
        if (leads_on && number_.emplace(other.value, next).second) open.push_back(other);
      }
    }
    ++next;
  }
}

std::function<void(ComplexEdit&)> Editor::draw(const Environment& environment, std::uint64_t step,
                                               std::uint64_t number) {
  Random random = random_for(case_, Use::edit, step, number);
  const CombinatorialMap& map = environment.map();
  made_.clear();
  used_ = none;
  std::string_view kind = case_.name(Knob::edit);
  if (kind == "all") {
    const auto names = knob_texts()[static_cast<std::size_t>(Knob::edit)].values;
    kind = names[1 + random.below(static_cast<std::uint32_t>(names.size()) - 3)];
  }
  const Cell c = any_cell(map, random);
  const bool space = map.dimension() == 3;
  if (kind == "mark") return single(environment, test::EditKind::mark, random);
  if (kind == "merge")
    return single(environment,
                  std::array{test::EditKind::merge_cells, test::EditKind::merge_faces,
                             test::EditKind::merge_edges}[random.below(3)],
                  random);
  if (kind == "open faces")
    return random.below(2) == 0 ? single(environment, test::EditKind::unsew, random) : new_walls(map, random);
  if (kind == "sew") {
    const std::vector<CellFace> walls = inner_walls(map);
    if (walls.empty() || random.below(2) == 0) return single(environment, test::EditKind::sew, random);
    const std::size_t some = 2 * (1 + random.below(static_cast<std::uint32_t>(walls.size() / 2)));
    return [sides = std::vector<CellFace>(walls.begin(), walls.begin() + static_cast<std::ptrdiff_t>(some))](
               ComplexEdit& edit) { remove_walls(edit.topology(), sides); };
  }
  if (kind == "split" || !space)
    return single(
        environment,
        std::array{test::EditKind::split_edge, test::EditKind::split_face, test::EditKind::split_cell}[random.below(3)],
        random);
  if (kind == "coarsen" && !subdivisions_.empty()) {
    used_ = random.below(static_cast<std::uint32_t>(subdivisions_.size()));
    return [this](ComplexEdit& edit) { coarsen(edit, subdivisions_[used_]); };
  }
  if (kind == "subdivide" || kind == "coarsen")
    return [this, c](ComplexEdit& edit) { made_ = {subdivide(edit, c).subdivision}; };
  const Vec3 through = environment.positions()[map.view(c).vertex(0).value] + Vec3{0.4, 0.45, 0.5} * scene_.edge;
  if (kind == "plane") {
    const Plane plane = plane_through(through, test::random_vector(random, 1.0));
    return [plane, c](ComplexEdit& edit) { split_by_plane(edit, std::vector<Cell>{c}, plane); };
  }
  if (kind == "carve") {
    const Disc disc{through, test::random_vector(random, 1.0), scene_.edge * random.uniform(0.3, 1.5), 6};
    const std::vector<ConvexTool> tools = thicken(disc, 0.2 * scene_.edge);
    const Carving what = random.below(4) == 0 ? Carving::remove : Carving::open;
    const std::vector<Cell> near = cells_near(environment.complex(), tools);
    return [=](ComplexEdit& edit) { carve(edit, near, tools, what); };
  }
  if (kind == "remesh") {
    std::vector<Cell> invalid;
    for (const auto& bad : environment.validity(20).first) invalid.push_back(bad.cell);
    return [invalid](ComplexEdit& edit) { repair(edit, invalid); };
  }
  return [](ComplexEdit&) {};
}

void Editor::follow(const Environment& environment) {
  const ComplexEditReport& report = environment.last_edit();
  if (used_ != none) subdivisions_.erase(subdivisions_.begin() + static_cast<std::ptrdiff_t>(used_));
  subdivisions_.insert(subdivisions_.end(), made_.begin(), made_.end());
  for (Subdivision& s : subdivisions_) update_after_edit(environment.map(), report.map.added, s);
  used_ = none;
  made_.clear();
}

std::vector<Vec3> Motion::next(const Environment& environment, std::uint64_t step) {
  const auto now = environment.positions();
  std::vector<Vec3> next(now.begin(), now.end());
  if (is_out()) {  // back again; vertices that edits made stay
    std::copy(home_.begin(), home_.end(), next.begin());
    home_.clear();
    return next;
  }
  Random random = random_for(case_, Use::motion, step);
  const std::string_view kind = case_.name(Knob::motion);
  const bool periodic = case_[Knob::periodic] != 0;
  if (periodic && kind != "infinite vertices") {
    const bool strong = kind == "near inversion" || kind == "inversion and back";
    if (strong) home_ = next;
    return shaken_alike(case_, scene_, step + 1, strong ? random.uniform(0.3, 2.0) : 0.05);
  }
  if (kind == "infinite vertices") {
    home_ = next;
    // The last two are in the exact range. Exact touches take long there.
    constexpr std::array<double, 6> far = {infinity, -infinity, 0x1.8p+300, 1e200, 0x1p+300, -1e90};
    const std::uint32_t kinds = case_.is(Knob::mover, "environment") ? 6 : 4;
    for (std::uint32_t i = 0; i < 1 + random.below(3); ++i) {
      const std::uint32_t number = random.below(static_cast<std::uint32_t>(next.size()));
      Vec3& v = next[number];
      if (periodic && is_on_border(scene_, number)) continue;
      (random.below(2) == 0 ? v.x : v.y) = far[random.below(kinds)];
    }
    return next;
  }
  for (std::size_t i = 0; i < next.size(); ++i) next[i] = moved(now[i], step, i);
  if (kind == "inversion and back") home_.assign(now.begin(), now.end());
  if (kind == "near inversion") {
    home_.assign(now.begin(), now.end());
    const auto inversion = environment.first_inversion(next);
    const double share = inversion ? inversion->how.safe_time : 1.0;
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = now[i] + (next[i] - now[i]) * share;
    if (environment.first_inversion(next)) next = home_;
  }
  return next;
}

Vec3 Motion::moved(const Vec3& p, std::uint64_t step, std::size_t vertex) const {
  Random random = random_for(case_, Use::motion, step, 1);
  const double e = scene_.edge;
  const bool plane = scene_.low.z == scene_.high.z;
  const Vec3 centre = (scene_.low + scene_.high) * 0.5;
  const std::string_view kind = case_.name(Knob::motion);
  const auto turned = [&](double angle) {
    const Vec3 d = p - centre;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return centre + Vec3{c * d.x - s * d.y, s * d.x + c * d.y, d.z};
  };
  if (kind == "turn") return turned(random.uniform(-0.5, 0.5));
  if (kind == "twist" && !plane) return turned(random.uniform(-0.2, 0.2) * (p.z - centre.z) / e);
  if (kind == "frames") {
    const auto noise = [&](std::uint64_t frame) {
      Random of_vertex = random_for(case_, Use::motion, frame, 2 + vertex);
      return Vec3{of_vertex.uniform(), of_vertex.uniform(), plane ? 0.0 : of_vertex.uniform()} * (0.1 * e);
    };
    return p + (noise(step + 1) - noise(step));
  }
  const bool strong = kind == "near inversion" || kind == "inversion and back";
  const double far = (strong ? random.uniform(0.5, 2.5) : random.uniform(0.0, 0.15)) * e;
  const Vec3 q = p * (1.0 / e);
  return p + Vec3{std::sin(q.y + q.z), std::sin(q.x), plane ? 0.0 : std::sin(q.x + q.y)} * far;
}

}  // namespace dartcast::soak
