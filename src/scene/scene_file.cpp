// Reads a scene from TOML.
#include "dartcast/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_series.hpp"
#include "scene/scene_keys.hpp"
#include "scene/toml_table.hpp"
#include "simulation/series.hpp"

namespace dartcast {

namespace {

constexpr Range any_number = {-Range::unlimited, Range::unlimited};

class SceneReader {
 public:
  explicit SceneReader(const std::filesystem::path& path) : folder_(path.parent_path()) {}

  Scene read(TomlTable root) const {
    Scene scene;
    root.get("seed", scene.seed, 0, max_seed);
    root.require("environment", "say [environment] with mesh = \"FILE\" or generator = \"box\"");
    scene.environment = read_environment(root.table("environment"), folder_);
    for (TomlTable& t : root.tables("periodic")) scene.environment.periodic.push_back(periodic_pair(t));
    for (TomlTable& t : root.tables("deformation")) scene.deformation.push_back(deformation(t));
    for (TomlTable& t : root.tables("particles")) scene.particles.push_back(read_particles(t, folder_));
    for (TomlTable& t : root.tables("body"))
      add_named(t, scene.bodies, read_body(t, folder_, scene.bodies.size() + 1, scene.seed));
    for (TomlTable& t : root.tables("catheter"))
      add_named(t, scene.catheters, read_catheter(t, scene.catheters.size() + 1));
    for (TomlTable& t : root.tables("solid"))
      add_named(t, scene.solids, read_solid(t, folder_, scene.solids.size() + 1));
    scene.motion = motion(root.table("motion"));
    check_field_of_particles(root, scene);
    fluid(root.table("fluid"), scene.motion.forces.fluid);
    scene.contact = contact(root.table("contact"));
    if (root.has("collisions")) collisions(root.table("collisions"), scene);
    for (TomlTable& t : root.tables("event")) scene.events.push_back(read_event(t));
    std::stable_sort(scene.events.begin(), scene.events.end(),
                     [](const EventScene& a, const EventScene& b) { return a.event.at < b.event.at; });
    scene.remesh = remesh(root.table("remesh"));
    // Scenes of version 0.1 have the older name.
    const char* const name = root.has("crowding") ? "crowding" : "adaptive_subdivision";
    scene.adaptive_subdivision = adaptive_subdivision(root.table(name));
    scene.statistics = read_statistics(root.table("statistics"));
    scene.output = output(root.table("output"));
    root.finish();
    return scene;
  }

 private:
  static PeriodicPair periodic_pair(TomlTable& t) {
    PeriodicPair pair;
    t.require("a", "a patch");
    t.require("b", "the patch that a particle enters by if it leaves through a");
    t.get("a", pair.a);
    t.get("b", pair.b);
    t.get("translate", pair.translate);
    t.get("axis", pair.axis);
    t.get("centre", pair.centre);
    t.get("angle", pair.angle, {-360.0, 360.0});
    t.get("tolerance", pair.tolerance, {0.0, 0.1});
    if (!t.has("translate") && !t.has("angle"))
      t.fail("", "say how a comes to b: translate = [x, y, z], or axis, centre and angle (degrees)");
    if (t.has("angle") && pair.axis == Vec3{}) t.fail("axis", "an angle needs an axis that is not zero");
    t.finish();
    return pair;
  }

  DeformationScene deformation(TomlTable& t) const {
    DeformationScene scene;
    DeformationStep& step = scene.step;
    std::string kind;
    t.require("kind", "rotate, swing, bend, twist, stretch, pulse, bump or frames");
    t.get("kind", kind);
    const auto found = deformation_kind(kind);
    if (!found)
      t.fail("kind", fmt::format("kind = \"{}\": it must be one of {}", kind,
                                 "rotate, swing, bend, twist, stretch, pulse, bump, frames"));
    step.kind = *found;
    deformation_keys(t, scene);
    t.finish();
    return scene;
  }

  // The keys that this kind of deformation has.
  void deformation_keys(TomlTable& t, DeformationScene& scene) const {
    DeformationStep& step = scene.step;
    switch (step.kind) {
      case DeformationKind::rotate: return periodic(t, step);
      case DeformationKind::swing:
      case DeformationKind::stretch: return oscillation(t, step);
      case DeformationKind::bend:
        oscillation(t, step);
        t.get("direction", step.direction);
        return deformation_length(t, step);
      case DeformationKind::twist:
      case DeformationKind::bump: oscillation(t, step); return deformation_length(t, step);
      case DeformationKind::pulse:
        oscillation(t, step);
        t.get("wavelength", step.wavelength, Range::not_negative);
        t.get("field", scene.field);
        t.get("path", scene.path);
        return;
      case DeformationKind::frames: return frames(t, scene);
    }
  }

  static void periodic(TomlTable& t, DeformationStep& step) {
    t.get("period", step.period, Range::positive);
    t.get("axis", step.axis);
    t.get("centre", step.centre);
  }

  static void oscillation(TomlTable& t, DeformationStep& step) {
    periodic(t, step);
    t.require("amplitude", "how much: an angle (swing, bend, twist), a length (bump) or a share (stretch, pulse)");
    t.get("amplitude", step.amplitude, any_number);
  }

  static void deformation_length(TomlTable& t, DeformationStep& step) {
    t.require("length", "the length over which it acts");
    t.get("length", step.length, Range::positive);
  }

  void frames(TomlTable& t, DeformationScene& scene) const {
    std::vector<std::string> files;
    t.require("files", "mesh files with the same points, one per time; or a .pvd file or case of OpenFOAM");
    t.get("files", files);
    if (files.empty()) t.fail("files", "files must not be empty");
    if (t.get("displacement", scene.displacement) && scene.displacement.empty())
      t.fail("displacement", "displacement must be the name of a point array of three components");
    const bool times = t.get("times", scene.step.times);
    if (t.get("spacing", scene.spacing, Range::positive) && times) t.fail("spacing", "give times or spacing, not both");
    t.get("interpolation", scene.step.interpolation,
          {{"linear", Interpolation::linear}, {"cubic", Interpolation::cubic}});
    t.get("period", scene.step.cycle, Range::positive);
    const bool series = files.size() == 1 && (names_series(folder_ / files.front()) || is_pattern(scene.displacement));
    if (!series && scene.spacing == 0.0 && files.size() != scene.step.times.size())
      t.fail(times ? "times" : "files",
             fmt::format("there are {} times for {} files", scene.step.times.size(), files.size()));
    for (const std::string& file : files) scene.frames.push_back(folder_ / file);
  }

  // [motion] is read after them.
  static void check_field_of_particles(TomlTable& root, const Scene& scene) {
    if (scene.motion.field.given()) return;
    const std::vector<TomlTable> tables = root.tables("particles");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const auto* inlet = std::get_if<InletParticles>(&scene.particles[i].source);
      const bool by_flux = inlet != nullptr && inlet->profile == InletProfile::flux;
      if (scene.particles[i].with_field || by_flux)
        tables[i].fail(by_flux ? "profile" : "velocity", "it needs a field: give [motion] field");
    }
  }

  // Names are those of files.
  template <class Item>
  static void add_named(TomlTable& t, std::vector<Item>& all, Item&& item) {
    if (std::any_of(all.begin(), all.end(), [&](const Item& other) { return other.name == item.name; }))
      t.fail("name", fmt::format("name = \"{}\": another has this name; give it one of its own", item.name));
    all.push_back(std::forward<Item>(item));
  }

  MotionScene motion(TomlTable t) const {
    MotionScene scene;
    t.get("dt", scene.dt, Range::positive);
    t.get("steps", scene.steps, 0, max_steps);
    t.get("gravity", scene.gravity);
    t.get("drag", scene.drag, Range::not_negative);
    if (t.is_text("diffusion"))
      t.get("diffusion", scene.diffusivity);
    else
      t.get("diffusion", scene.diffusion, Range::not_negative);
    if (t.get("brownian_bridge", scene.brownian_bridge) && !t.has("diffusion"))
      t.fail("brownian_bridge", "brownian_bridge belongs to diffusion: give that, or leave it out");
    t.get("substeps", scene.substeps, 1U, 1000U);
    t.get("wall_motion", scene.wall_motion,
          {{"carried", WallMotion::carried}, {"simultaneous", WallMotion::simultaneous}});
    if (scene.wall_motion == WallMotion::simultaneous && scene.substeps != 1)
      t.fail("wall_motion", "wall_motion = \"simultaneous\" takes a step as one segment: leave substeps out");
    read_forces(t, scene);
    read_fields(t, folder_, scene);
    t.finish();
    return scene;
  }

  static void fluid(TomlTable t, Fluid& fluid) {
    t.get("density", fluid.density, Range::positive);
    t.get("viscosity", fluid.viscosity, Range::positive);
    t.get("mean_free_path", fluid.mean_free_path, Range::not_negative);
    t.get("temperature", fluid.temperature, Range::positive);
    t.get("surface_tension", fluid.surface_tension, Range::positive);
    t.finish();
  }

  static void read_forces(TomlTable& t, MotionScene& scene) {
    static const std::vector<std::pair<std::string, Force>> all = {{"stokes", Force::stokes},
                                                                   {"schiller-naumann", Force::schiller_naumann},
                                                                   {"putnam", Force::putnam},
                                                                   {"buoyancy", Force::buoyancy},
                                                                   {"pressure-gradient", Force::pressure_gradient},
                                                                   {"virtual-mass", Force::virtual_mass},
                                                                   {"saffman-mei", Force::saffman_mei},
                                                                   {"lorentz", Force::lorentz},
                                                                   {"brownian", Force::brownian}};
    std::vector<std::string> names;
    t.get("forces", names);
    for (const std::string& name : names) {
      const auto found = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.first == name; });
      if (found == all.end())
        t.fail("forces", fmt::format("forces: \"{}\" is unknown; there are {}", name, fmt::join(all_names(all), ", ")));
      scene.forces.terms.push_back(found->second);
    }
    t.get("electric_field", scene.forces.electric_field);
    t.get("magnetic_field", scene.forces.magnetic_field);
    if (!names.empty() && t.has("drag"))
      t.fail("drag", "drag is a law of its own, without size and mass: leave drag out, or leave forces out");
  }

  static std::vector<std::string> all_names(const std::vector<std::pair<std::string, Force>>& all) {
    std::vector<std::string> names;
    for (const auto& f : all) names.push_back(f.first);
    return names;
  }

  static RestitutionTable restitution_table(TomlTable t) {
    RestitutionTable table;
    t.require("speeds", "speeds of impact in m/s, increasing");
    t.require("angles", "angles of impact in degrees from the wall, increasing");
    t.require("values", "a restitution for each speed and angle: all angles of the first speed, then of the next");
    t.get("speeds", table.speeds);
    t.get("angles", table.angles);
    t.get("values", table.values);
    if (table.speeds.empty() || table.values.size() != table.speeds.size() * table.angles.size())
      t.fail("values", fmt::format("there are {} values for {} speeds and {} angles", table.values.size(),
                                   table.speeds.size(), table.angles.size()));
    t.finish();
    return table;
  }

  static void response(TomlTable& t, WallResponse& r) {
    t.get("response", r.kind,
          {{"reflect", WallResponseKind::reflect},
           {"slide", WallResponseKind::slide},
           {"stick", WallResponseKind::stick},
           {"absorb", WallResponseKind::absorb},
           {"escape", WallResponseKind::escape}});
    if (t.is_table("restitution")) {
      r.table = restitution_table(t.table("restitution"));
    } else if (t.get("restitution", r.restitution, {0.0, 1.0})) {
      r.table = {};
    }
    t.get("friction", r.friction, Range::not_negative);
    t.get("stick_below", r.stick_below, Range::not_negative);
    t.get("stick_below_weber", r.stick_below_weber, Range::not_negative);
  }

  static ContactScene contact(TomlTable t) {
    ContactScene scene;
    response(t, scene.general);
    TomlTable patches = t.table("patch");
    for (const std::string& name : patches.keys()) {
      TomlTable patch = patches.table(name);
      WallResponse& r = scene.by_patch[name] = scene.general;
      response(patch, r);
      patch.finish();
    }
    t.finish();
    return scene;
  }

  static void collisions(TomlTable t, Scene& scene) {
    CollisionOptions& options = scene.collisions.emplace();
    t.get("restitution", options.restitution, {0.0, 1.0});
    t.get("friction", options.friction, Range::not_negative);
    t.get("density", options.density, Range::positive);
    t.get("iterations", options.iterations, 1U, 100000U);
    t.get("push_iterations", options.position_iterations, 0U, 100000U);
    double between_bodies = 0.0;
    if (t.get("body_restitution", between_bodies, {0.0, 1.0})) scene.body_collisions.restitution = between_bodies;
    t.get("body_friction", scene.body_collisions.friction, Range::not_negative);
    t.finish();
  }

  static AdaptiveSubdivisionScene adaptive_subdivision(TomlTable t) {
    AdaptiveSubdivisionScene scene;
    t.get("every", scene.every, 0, max_steps);
    t.get("most", scene.options.max_particles, 1U, 0xfffffffeU);
    t.get("least", scene.options.min_particles, 0U, 0xfffffffdU);
    t.get("smallest", scene.options.smallest, Range::not_negative);
    t.get("edits", scene.options.edits, 1U, 0xfffffffeU);
    if (scene.options.min_particles >= scene.options.max_particles)
      t.fail("least", fmt::format("least = {}: it must be less than most, {}", scene.options.min_particles,
                                  scene.options.max_particles));
    t.finish();
    return scene;
  }

  static RemeshScene remesh(TomlTable t) {
    RemeshScene scene;
    t.get("every", scene.every, 0, max_steps);
    std::uint64_t max_particles = scene.options.max_cells;
    t.get("most_cells", max_particles, 1, 1U << 20U);
    scene.options.max_cells = max_particles;
    t.finish();
    return scene;
  }

  static OutputScene output(TomlTable t) {
    OutputScene scene;
    std::uint64_t every = 0;
    if (t.get("every", every, 0, max_steps)) scene.every = every;
    t.get("contacts", scene.contacts);
    t.get("report", scene.report);
    auto compression = Compression::none;
    if (t.get("compression", compression,
              {{"none", Compression::none}, {"fast", Compression::fast}, {"small", Compression::small}}))
      scene.compression = compression;
    t.finish();
    return scene;
  }

  std::filesystem::path folder_;
};

}  // namespace

Scene parse_scene(const std::string& text, const std::filesystem::path& path) {
  toml::table root;
  try {
    root = toml::parse(text, path.string());
  } catch (const toml::parse_error& e) {
    throw Error(fmt::format("{}:{}: this is not TOML: {}", path.string(), e.source().begin.line, e.description()));
  }
  Scene scene = SceneReader(path).read(TomlTable(root, path.string(), ""));
  scene.name = path.stem().string();
  scene.file = path;
  scene.text = text;
  return scene;
}

Scene read_scene(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  const bool readable = file && !std::filesystem::is_directory(path);
  const bool empty = readable && file.peek() == std::ifstream::traits_type::eof();  // nothing: << would fail
  if (!readable || (!empty && !(text << file.rdbuf())))
    throw Error(fmt::format("{}: the scene cannot be read; check the path", path.string()));
  return parse_scene(text.str(), path);
}

}  // namespace dartcast
