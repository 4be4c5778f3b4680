// Draws and makes the parts of a case's simulation.
#include "soak/plan.hpp"

#include <array>
#include <cmath>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "soak/periodic.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::soak {

namespace {

constexpr double dt = 0.05;

}  // namespace

namespace {

// A patch with a wall of a free cell; empty: there is none.
std::string door_of(const MeshData& mesh) {
  const CombinatorialMap map(mesh);
  for (const Cell c : map.cells()) {
    const CellView cell = map.view(c);
    for (std::uint16_t f = 0; cell.is_free() && f < cell.shape().face_count(); ++f)
      if (cell.is_wall(f) && map.patch({c, f}).value != 0) return map.patch_names()[map.patch({c, f}).value];
  }
  return "";
}

}  // namespace

Plan::Plan(const Case& c, const SceneMesh& scene)
    : case_(c),
      scene_(scene),
      space_(scene.mesh.dimension() == 3),
      door_(door_of(scene.mesh)),
      choice_(random_for(c, Use::mover, 77).next()) {}

bool Plan::has_inlet() const { return has(16) && !door_.empty(); }

bool Plan::flies_freely() const {
  const SimulationOptions o = options(nullptr);
  return case_.is(Knob::periodic, "all axes") && case_.is(Knob::walls, "sides") && case_[Knob::motion] == 0 &&
         !has_field() && !has_inlet() && o.diffusion == 0.0 && o.forces.terms.empty();
}

std::vector<double> Plan::user_data() const {
  std::vector<double> data = has(3) ? std::vector{1.5, -0.0, 3.0} : std::vector<double>{};
  if (case_[Knob::periodic] == 0) return data;
  data.insert(data.end(), {1.0, 2.0, 4.0});
  data.resize(data.size() + scene_.pairs.size());
  return data;
}

Vec3 Plan::velocity() const {
  const Vec3 v = test::random_vector(*in(1), scene_.edge * 20.0);
  return space_ ? v : Vec3{v.x, v.y, 0.0};
}

Scene Plan::scene() const {
  const SimulationOptions o = options(nullptr);
  Scene s;
  s.seed = o.seed;
  MeshData mesh = scene_.mesh;
  if (has_field()) {
    DataArray& array = mesh.point_data.emplace_back(DataArray{"u", 3, {}});
    for (const Vec3& v : field()) array.values.insert(array.values.end(), {v.x, v.y, v.z});
    s.motion.field.array = "u";
    s.motion.field.frame = has(15) ? FieldFrame::mesh : FieldFrame::space;
  }
  s.environment.mesh = std::move(mesh);
  if (case_[Knob::motion] != 0) s.deformation.push_back({deformation(), {}, {}, {}, 0.0});
  s.particles.push_back({RandomParticles{60}, velocity(), 0.0, user_data(), false, material()});
  if (has_inlet()) s.particles.push_back({InletParticles{door_, 40.0}, {}, 0.0, user_data(), false, material()});
  if (has(25)) s.particles.back().sizes = SizeDistribution{SizeLaw::lognormal, 0.1 * scene_.edge, 1.5};
  if (has(26) && has_field()) {
    auto& points = std::get<MeshData>(s.environment.mesh);
    points.point_data.push_back({"k", 1, std::vector<double>(points.points.size(), scene_.edge * scene_.edge)});
    points.point_data.push_back({"omega", 1, std::vector<double>(points.points.size(), 30.0)});
    s.motion.sample = {"k", "omega"};
    s.motion.turbulence.k = "k";
    s.motion.turbulence.omega = "omega";
  }
  if (has_varying_diffusion()) add_diffusivity(s);
  s.user_data = o.user_data;
  s.user_data.resize(o.user_data.size() - scene_.pairs.size());  // a scene counts images itself
  for (ParticlesScene& group : s.particles) group.user_data.resize(s.user_data.size());
  s.motion.dt = o.dt;
  s.motion.gravity = o.gravity;
  s.motion.drag = o.drag;
  s.motion.forces = o.forces;
  if (!has_varying_diffusion()) s.motion.diffusion = o.diffusion;
  s.contact.general = o.response;
  return s;
}

void Plan::add_diffusivity(Scene& s) const {
  const auto random = in(8);
  auto& points = std::get<MeshData>(s.environment.mesh);
  DataArray& array = points.point_data.emplace_back(DataArray{"D", 1, {}});
  const double largest = 0.05 * scene_.edge * scene_.edge;
  for (const Vec3& x : points.points)
    array.values.push_back(has_linear_diffusion()  ? diffusivity(x)
                           : random->below(4) == 0 ? 0.0
                                                   : random->uniform(0.0, largest));
  s.motion.sample.push_back("D");
  s.motion.diffusivity = "D";
}

double Plan::diffusivity(const Vec3& x) const {
  return 0.01 * scene_.edge * scene_.edge + dot(diffusivity_gradient(), x - scene_.low);
}

Vec3 Plan::diffusivity_gradient() const {
  const auto random = in(9);
  const double most = 0.02 * scene_.edge * scene_.edge / norm(scene_.high - scene_.low);
  const Vec3 g = {random->uniform(0.0, most), random->uniform(0.0, most), random->uniform(0.0, most)};
  return space_ ? g : Vec3{g.x, g.y, 0.0};
}

SimulationOptions Plan::options(Ranks* ranks) const {
  SimulationOptions o;
  o.dt = dt;
  o.seed = case_.seed;
  o.ranks = ranks;
  o.gravity = Vec3{has(0) ? 3.0 : 0.0, has(1) ? -9.81 : 0.0, 0.0} * scene_.edge;
  o.drag = has(2) ? 2.0 : 0.0;
  o.response = response();
  if (has(3)) o.user_data = {"first", "second", "number"};
  if (case_[Knob::periodic] != 0) o.user_data.insert(o.user_data.end(), {"arrow_x", "arrow_y", "arrow_z"});
  for (const PeriodicPair& pair : scene_.mesh.periodic) o.user_data.push_back("image_" + pair.a);
  if (has_field() && has(13) && o.drag == 0.0 && !collides() && case_[Knob::simultaneous] == 0)
    o.integrator = Integrator::rk4;
  else if (has(17) && o.drag == 0.0 && !collides())
    o.forces = forces();
  if (has(21) && !collides()) o.diffusion = 0.02 * scene_.edge * scene_.edge;
  if (collides()) o.collisions = CollisionOptions{.restitution = 0.5, .friction = 0.2};
  if (case_[Knob::simultaneous] != 0 && !collides() && !has_spheres())
    o.wall_motion = WallMotion::simultaneous;
  else if (!collides() && !has(14) && o.integrator == Integrator::euler)
    o.substeps = 1 + static_cast<unsigned>(choice_ >> 60U) % 3;
  return o;
}

void Plan::fill(Simulation& s, bool particles) const {
  if (case_[Knob::motion] != 0) s.set_deformation({{deformation()}, s.environment().positions()});
  if (has(5)) s.set_statistics(statistics());
  if (has_field()) s.set_field({s.environment().complex(), field(), has(15) ? FieldFrame::mesh : FieldFrame::space});
  if (has_inlet()) s.add_inlet(s.environment().map().patch(door_), 40.0, {}, 0.0, user_data(), material());
  if (case_[Knob::edit] != 0) s.set_events(events());
  const bool periodic = case_[Knob::periodic] != 0;
  if (space_ && has(6) && !periodic) s.set_remeshing({.every = 2, .options = {}});
  if (space_ && has(7) && !periodic)
    s.set_adaptive_subdivision({.every = 2, .options = {.max_particles = 6, .min_particles = 2}});
  if (particles) s.add_random(has(8) ? 60 : 12, velocity(), 0.0, user_data(), material());
  if (particles && has(25)) {
    ParticlesScene many{RandomParticles{6}, velocity(), 0.0, user_data(), false, material()};
    many.sizes = SizeDistribution{SizeLaw::lognormal, 0.1 * scene_.edge, 1.5};
    s.add(many);
  }
  if (particles && has_spheres()) s.add_random(10, {}, 0.15 * scene_.edge, {}, material());
  if (!space_ || periodic) return;
  if (has(9)) add_body(s);
  for (int i = 0; has(10) && i < (case_[Knob::meets] != 0 ? 4 : 1); ++i) add_solid(s, i);
  if (has(11)) add_catheter(s);
}

std::unique_ptr<Random> Plan::in(std::uint64_t part) const {
  return std::make_unique<Random>(random_for(case_, Use::mover, 78, part));
}

Vec3 Plan::place(Random& random) const {
  return {random.uniform(scene_.low.x, scene_.high.x), random.uniform(scene_.low.y, scene_.high.y),
          random.uniform(scene_.low.z, scene_.high.z)};
}

ForceOptions Plan::forces() const {
  ForceOptions f;
  f.terms = {has(18) ? Force::schiller_naumann : Force::stokes, Force::buoyancy, Force::saffman_mei, Force::lorentz};
  if (!has(15)) f.terms.push_back(Force::virtual_mass);
  if (has(22)) f.terms.push_back(Force::brownian);
  f.fluid = {1.2, 0.1 * scene_.edge * scene_.edge, has(19) ? 0.01 * scene_.edge : 0.0};
  f.fluid.temperature = 1e-3 * std::pow(scene_.edge, 5.0) / boltzmann_constant;  // speeds of an edge a second or so
  f.magnetic_field = {0.0, 0.0, 2.0};
  return f;
}

Material Plan::material() const { return {0.1 * scene_.edge, has(20) ? 1.0 : 1000.0, 1.5}; }

WallResponse Plan::response() const {
  const std::string_view name = case_.name(Knob::response);
  if (name == "slide") return Slide{};
  if (name == "stick") return Stick{};
  if (name == "absorb") return Absorb{};
  if (name == "stop") return Escape{};
  WallResponse reflect = Reflect{0.7, 0.1};
  if (collides()) return reflect;
  if (has(23)) reflect.stick_below = 0.2 * scene_.edge;
  if (has(24)) reflect.table = {{scene_.edge, 9.0 * scene_.edge}, {10.0, 80.0}, {1.0, 0.8, 0.9, 0.3}};
  return reflect;
}

std::vector<Vec3> Plan::field() const {
  const auto random = in(7);
  std::vector<Vec3> values;
  for (std::size_t i = 0; i < scene_.mesh.points.size(); ++i) {
    const Vec3 v = test::random_vector(*random, 5.0 * scene_.edge);
    values.push_back(space_ ? v : Vec3{v.x, v.y, 0.0});
  }
  return values;
}

DeformationStep Plan::deformation() const {
  const auto random = in(2);
  DeformationStep d;
  if (case_[Knob::periodic] != 0) {
    d.kind = DeformationKind::frames;
    for (std::uint64_t k = 0; k < 4; ++k) {
      d.times.push_back(2.0 * dt * double(k));
      d.frames.push_back(k == 0 ? scene_.mesh.points : shaken_alike(case_, scene_, k, 0.05));
    }
    return d;
  }
  d.centre = (scene_.low + scene_.high) * 0.5;
  d.period = random->uniform(0.2, 2.0);
  d.length = norm(scene_.high - scene_.low);
  const std::string_view kind = case_.name(Knob::motion);
  d.kind = DeformationKind::swing;
  d.amplitude = random->uniform(0.0, 0.5);
  if (kind == "twist" && space_) d.kind = DeformationKind::twist;
  if (kind == "frames") {
    d.kind = DeformationKind::bump;
    d.axis = {1.0, 0.0, 0.0};
    d.amplitude = random->uniform(0.0, 0.3) * scene_.edge;
  }
  const bool strong = kind == "near inversion" || kind == "inversion and back" || kind == "infinite vertices";
  if (kind == "wave" || strong) {
    d.kind = DeformationKind::pulse;
    d.axis = space_ ? Vec3{0.0, 0.0, 1.0} : Vec3{1.0, 0.0, 0.0};
    d.amplitude = strong ? 0.9 : 0.1;
    d.wavelength = strong ? 1.5 * scene_.edge : 0.5 * d.length;
  }
  return d;
}

StatisticsOptions Plan::statistics() const {
  StatisticsOptions o;
  o.hits = true;
  o.impacts = has(27);
  o.residence = true;
  o.planes = {{"middle", (scene_.low + scene_.high) * 0.5, {1.0, 0.5, 0.0}, 0.0}};
  o.pathlines_every = 3;
  o.cells = cell_quantities();
  return o;
}

std::vector<Event> Plan::events() const {
  const auto random = in(3);
  std::vector<Event> events;
  for (std::uint32_t i = 0; i < 1 + case_[Knob::edits] / 4; ++i) {
    Event e;
    e.at = dt * random->below(5);
    e.orphaned = std::array{OrphanPolicy::hold, OrphanPolicy::relocate, OrphanPolicy::absorb}[random->below(3)];
    const Vec3 at = place(*random);
    const Vec3 normal = test::random_vector(*random, 1.0);
    std::vector<std::uint32_t> cells;
    for (int k = 0; k < 4; ++k) cells.push_back(random->below(static_cast<std::uint32_t>(scene_.mesh.cell_count())));
    switch (random->below(space_ ? 5 : 1)) {
      case 0: e.what = Ligature{plane_through(at, space_ ? normal : Vec3{normal.x, normal.y, 0.0}), at}; break;
      case 1: e.what = OpenCells{cells}; break;
      case 2: e.what = CloseCells{cells}; break;
      case 3: e.what = Cut{Disc{at, normal, scene_.edge, 6}, 0.2 * scene_.edge}; break;
      default:
        e.what = Carve{capsule_tool(at, at + normal * scene_.edge, 0.3 * scene_.edge), Carving::open, false};
        break;
    }
    events.push_back(e);
  }
  return events;
}

void Plan::add_body(Simulation& s) const {
  const auto random = in(4);
  for (int tries = 0; tries < 20; ++tries) {
    const double size = scene_.edge * random->uniform(0.1, 0.5);
    const SolidMesh ball = test::moved(test::ball(size), place(*random));
    BodyOptions body;
    body.radius = 0.2 * size;
    body.velocity = test::random_vector(*random, 5.0 * scene_.edge);
    if (random->below(2) == 0) body.surface = ball;
    try {
      if (s.add_body(ball.points, body).body != 0xffffffffU) return;
    } catch (const InvalidArgument&) {  // as with substeps
      return;
    }
  }
}

void Plan::add_solid(Simulation& s, int number) const {
  const auto random = in(number == 0 ? 5U : 20U + static_cast<unsigned>(number));
  for (int tries = 0; tries < 20; ++tries) {
    SolidScene solid;
    solid.name = "tool" + (number == 0 ? "" : std::to_string(number));
    const double size = scene_.edge * random->uniform(0.05, 0.4);
    solid.shape = std::vector<Vec3>{{}, {size, 0.0, 0.0}, {size, size, 0.0}};
    solid.at = place(*random);
    solid.pivot = solid.at;
    solid.moves = {{10.0, test::random_vector(*random, 3.0 * scene_.edge), test::random_vector(*random, 3.0)}};
    solid.catch_up = random->below(2) == 0;
    try {
      return s.add(solid);
    } catch (const Error&) {  // no place there
    }
  }
}

void Plan::add_catheter(Simulation& s) const {
  const auto random = in(6);
  for (int tries = 0; tries < 20; ++tries) {
    CatheterScene catheter;
    catheter.name = "catheter";
    catheter.options.spacing = 0.2 * scene_.edge;
    catheter.options.length = 2.0 * scene_.edge;
    catheter.options.stiffness = 1e-2 * std::pow(scene_.edge, 4.0);
    catheter.options.entry = place(*random);
    catheter.options.direction = test::random_vector(*random, 1.0);
    catheter.options.edges = random->below(4) != 0;
    catheter.moves = {{10.0, 4.0 * scene_.edge, 1.0}};
    try {
      return s.add(catheter);
    } catch (const Error&) {  // no room there
    }
  }
}

}  // namespace dartcast::soak
