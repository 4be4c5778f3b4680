// The engine behind index.d.ts: one simulation, by a C interface. Scenes, edits and additions come as the text of scene
// files. A call that fails returns the error's text, else an empty one. Arrays and texts that are returned stay until
// the next call. The tests that are built natively call the same functions.
#include "engine.hpp"

#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/walls.hpp"
#include "simulation/simulation_view.hpp"

namespace {

using namespace dartcast;
using Json = nlohmann::ordered_json;

constexpr const char* scene_name = "scene.toml";

struct Engine {
  std::unique_ptr<Simulation> simulation;
  const SimulationStep* last = nullptr;  // none before the first step
  std::vector<std::string> warnings;
  WallTriangles walls;
  std::uint64_t walls_version = ~std::uint64_t{0};
  std::string text;
  std::vector<double> numbers;
  std::vector<std::uint32_t> indices;
  std::size_t length = 0;
};

Engine& engine() {
  static Engine own;
  return own;
}

Simulation& simulation() { return *engine().simulation; }

template <class Work>
const char* guarded(Work&& work) {
  engine().text.clear();
  try {
    work();
  } catch (const std::exception& e) {
    engine().text = e.what();
  }
  return engine().text.c_str();
}

// Particles, bodies, catheters, solids and events without the rest of a scene. The box is never made.
LoadedScene parts_of(const std::string& text) {
  return load_scene_files(parse_scene(
      "environment = { generator = \"box\", cells = [1, 1, 1] }\nmotion = { dt = 1.0 }\n" + text, scene_name));
}

const WallTriangles& walls() {
  Engine& own = engine();
  const std::uint64_t version = simulation().environment().edit_count();
  if (own.walls_version != version) own.walls = wall_triangles(simulation().environment().complex());
  own.walls_version = version;
  return own.walls;
}

void put(std::span<const Vec3> points) {
  for (const Vec3& p : points) engine().numbers.insert(engine().numbers.end(), {p.x, p.y, p.z});
}

void put_contacts() {
  if (engine().last == nullptr) return;
  const SimulationStep& step = *engine().last;
  for (std::size_t i = 0; i < step.contacts().size(); ++i) {
    const Contact& c = step.contacts()[i];
    const WallHit& wall = step.report.contacts.walls_of(c).front();
    engine().numbers.insert(engine().numbers.end(), {static_cast<double>(step.contact_ids[i]),
                                                     static_cast<double>(wall.patch.value), c.time_of_impact});
    put(std::array{c.point, wall.normal});
  }
}

// Solids are bodies, then tools, then catheters.
struct SolidKinds {
  std::size_t bodies = 0, tools = 0, catheters = 0;
  SolidKinds()
      : bodies(simulation().bodies() == nullptr ? 0 : simulation().bodies()->size()),
        tools(simulation().solids() == nullptr ? 0 : simulation().solids()->size()),
        catheters(simulation().catheter_count()) {}
};

void put_solid_points(std::size_t i) {
  const SolidKinds count;
  const SimulationView view = view_of(simulation());
  if (i >= count.bodies + count.tools) return put(simulation().catheter(i - count.bodies - count.tools).points());
  if (i >= count.bodies) return put(vertices_of(*simulation().solids(), i - count.bodies));
  if (view.bodies.skin(i)) return put(view.bodies.surface_points(i));
  const Bodies& bodies = *simulation().bodies();
  put(bodies.positions().subspan(bodies.first_particle(i), bodies.particle_count(i)));
}

void put_solid_triangles(std::size_t i) {
  const SolidKinds count;
  const SimulationView view = view_of(simulation());
  std::vector<std::uint32_t>& out = engine().indices;
  if (i < count.bodies && view.bodies.skin(i)) {
    const MeshData& mesh = view.bodies.skin(i)->mesh;
    for (std::size_t f = 0; f < mesh.cell_count(); ++f) {
      for (auto corner = mesh.offsets[f] + 2; corner < mesh.offsets[f + 1]; ++corner) {
        for (const auto c : {mesh.offsets[f], corner - 1, corner})
          out.push_back(static_cast<std::uint32_t>(mesh.connectivity[c]));
      }
    }
  } else if (i >= count.bodies && i < count.bodies + count.tools) {
    for (const auto& t : view.solids.mesh(i - count.bodies).triangles) out.insert(out.end(), t.begin(), t.end());
  }
}

void read(EngineArray what, std::uint32_t index) {
  const Simulation& s = simulation();
  std::vector<double>& out = engine().numbers;
  switch (what) {
    case EngineArray::positions:
      for (const ParticleState& p : s.particles().states()) put({&p.position, 1});
      return;
    case EngineArray::velocities: return put(s.velocities());
    case EngineArray::radii: out.assign(s.radii().begin(), s.radii().end()); return;
    case EngineArray::ids: out.assign(s.ids().begin(), s.ids().end()); return;
    case EngineArray::vertices: return put(s.environment().positions());
    case EngineArray::wall_points: return put(walls().points(s.environment().positions()));
    case EngineArray::solid_points: return put_solid_points(index);
    case EngineArray::catheter_frames:
      for (const CatheterFrame& f : s.catheter(index).frames()) put(std::array{f.tangent, f.normal, f.binormal});
      return;
    case EngineArray::contacts: return put_contacts();
    case EngineArray::wall_triangles:
      for (const auto& t : walls().triangles) engine().indices.insert(engine().indices.end(), t.begin(), t.end());
      return;
    case EngineArray::wall_patches:
      for (const CellFace f : walls().faces) engine().indices.push_back(s.environment().map().patch(f).value);
      return;
    case EngineArray::wall_vertices:
      for (const Vertex v : walls().vertices) engine().indices.push_back(v.value);
      return;
    case EngineArray::solid_triangles: return put_solid_triangles(index);
  }
}

const char* as_text(const Json& json) {
  engine().text = json.dump();
  return engine().text.c_str();
}

}  // namespace

extern "C" {

const char* dartcast_make(const char* text) {
  return guarded([&] {
    LoadedScene loaded = load_scene_files(parse_scene(text, scene_name), {}, Threads{1});
    engine().simulation = std::make_unique<Simulation>(loaded.scene, Threads{1});
    for (const Finding& warning : loaded.warnings) engine().warnings.push_back(warning.message);
  });
}

const char* dartcast_add(const char* text) {
  return guarded([&] {
    const Scene scene = parts_of(text).scene;
    for (const ParticlesScene& group : scene.particles) simulation().add(group);
    for (const BodyScene& body : scene.bodies) simulation().add(body);
    for (const CatheterScene& catheter : scene.catheters) simulation().add(catheter);
    for (const SolidScene& solid : scene.solids) simulation().add(solid);
  });
}

const char* dartcast_edit(const char* text) {
  return guarded([&] {
    for (const EventScene& event : parts_of(text).scene.events) apply(simulation(), event.event);
  });
}

const char* dartcast_step(std::uint32_t count) {
  return guarded([&] {
    for (; count > 0; --count) engine().last = &simulation().step();
  });
}

const char* dartcast_steer(std::uint32_t catheter, double push, double turn) {
  return guarded([&] { simulation().steer(catheter, {push, turn, {}}); });
}

const char* dartcast_steer_solid(std::uint32_t solid, double vx, double vy, double vz, double tx, double ty,
                                 double tz) {
  return guarded([&] { simulation().steer_solid(solid, {vx, vy, vz}, {tx, ty, tz}); });
}

const char* dartcast_pull(double x, double y, double z, double dx, double dy, double dz, double reach,
                          double duration) {
  return guarded([&] {
    simulation().pull(pull_around(simulation().environment().positions(), {x, y, z}, {dx, dy, dz}, reach), duration);
  });
}

const char* dartcast_pull_all(const double* displacement, std::uint32_t numbers, double duration) {
  return guarded([&] {
    std::vector<Vec3> all(numbers / 3);
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = {displacement[3 * i], displacement[3 * i + 1], displacement[3 * i + 2]};
    simulation().pull(all, duration);
  });
}

const void* dartcast_read(EngineArray what, std::uint32_t index) {
  engine().numbers.clear();
  engine().indices.clear();
  read(what, index);
  const bool whole = what >= EngineArray::wall_triangles;
  engine().length = whole ? engine().indices.size() : engine().numbers.size();
  return whole ? static_cast<const void*>(engine().indices.data()) : engine().numbers.data();
}
std::uint32_t dartcast_length() { return static_cast<std::uint32_t>(engine().length); }

const char* dartcast_info() {
  const Simulation& s = simulation();
  const SolidKinds count;
  const SimulationView view = view_of(s);
  Json solids = Json::array();
  for (std::size_t i = 0; i < count.bodies; ++i) solids.push_back({{"kind", "body"}, {"name", view.bodies.name(i)}});
  for (std::size_t i = 0; i < count.tools; ++i) solids.push_back({{"kind", "solid"}, {"name", view.solids.name(i)}});
  for (const CatheterScene& c : view.catheters.scenes()) solids.push_back({{"kind", "catheter"}, {"name", c.name}});
  const SimulationTotals& t = s.totals();
  return as_text({{"steps", s.steps()},
                  {"time", s.time()},
                  {"dt", s.options().dt},
                  {"dimension", s.environment().map().dimension()},
                  {"particles", s.particles().size()},
                  {"edits", s.environment().edit_count()},
                  {"deforms", s.deforms()},
                  {"patches", s.environment().map().patch_names()},
                  {"solids", std::move(solids)},
                  {"totals",
                   {{"start", t.start},
                    {"injected", t.injected},
                    {"absorbed", t.absorbed},
                    {"escaped", t.escaped},
                    {"contacts_by_patch", t.contacts_by_patch}}},
                  {"warnings", engine().warnings}});
}

const char* dartcast_audit() {
  const char* failed = guarded([&] {
    const Audit audit = simulation().audit();
    as_text({{"checked", audit.checked}, {"failed", audit.failed}, {"first", audit.first}});
  });
  return failed;
}

const char* dartcast_hash() {
  engine().text = simulation().state_hash().hex();
  return engine().text.c_str();
}

std::uint32_t dartcast_memory() { return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(sbrk(0))); }
}
