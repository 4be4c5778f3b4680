// Reads the keys of a scene's fields.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/scene_keys.hpp"
#include "simulation/series.hpp"

namespace dartcast {

namespace {

void read_table(TomlTable t, const std::filesystem::path& folder, FieldScene& field) {
  t.require("array", "the name of an array of three components");
  t.get("array", field.array);
  if (field.array.empty()) t.fail("array", "array must not be empty");
  FieldPlace at = FieldPlace::points;
  if (t.get("at", at, {{"points", FieldPlace::points}, {"cells", FieldPlace::cells}})) field.at = at;
  t.get("frame", field.frame, {{"space", FieldFrame::space}, {"mesh", FieldFrame::mesh}});
  std::vector<std::string> files;
  if (t.get("files", files) && files.empty()) t.fail("files", "files must not be empty");
  for (const std::string& file : files) field.files.push_back(folder / file);
  const bool times = t.get("times", field.times);
  const bool spacing = t.get("spacing", field.spacing, Range::positive);
  if (times && spacing) t.fail("spacing", "give times or spacing, not both");
  bool steady = false;
  if (t.get("steady", steady)) {
    field.steady = steady;
    if (files.empty()) t.fail("steady", "steady belongs to files: an array of the mesh alone is steady");
  }
  t.get("period", field.period, Range::positive);
  t.get("interpolation", field.interpolation, {{"linear", Interpolation::linear}, {"cubic", Interpolation::cubic}});
  t.finish();
}

// A name, or a table.
void read_field(TomlTable& motion, const char* key, const std::filesystem::path& folder, FieldScene& field) {
  if (motion.is_table(key)) {
    read_table(motion.table(key), folder, field);
  } else {
    motion.get(key, field.array);
    if (is_pattern(field.array))
      motion.fail(key, fmt::format("{0} = \"{1}\": arrays at several times need their times: {0} = {{ array = \"{1}\", "
                                   "spacing = 0.01 }}",
                                   key, field.array));
  }
}

// The arrays are sampled.
void read_turbulence(TomlTable t, MotionScene& scene) {
  TurbulenceOptions& turbulence = scene.turbulence;
  t.require("k", "the name of an array of k, m^2/s^2");
  t.get("k", turbulence.k);
  const bool by_epsilon = t.get("epsilon", turbulence.epsilon);
  if (t.get("omega", turbulence.omega) == by_epsilon) t.fail("", "give the name of an array as epsilon or as omega");
  t.get("lagrangian", turbulence.lagrangian, Range::positive);
  const bool damps = t.get("wall_distance", turbulence.wall_distance);
  std::vector<std::string> names = {turbulence.k, by_epsilon ? turbulence.epsilon : turbulence.omega};
  if (damps) names.push_back(turbulence.wall_distance);
  for (const std::string& name : names) {
    if (name.empty()) t.fail("", "names of arrays must not be empty");
    if (std::count(scene.sample.begin(), scene.sample.end(), name) == 0) scene.sample.push_back(name);
  }
  t.finish();
}

}  // namespace

void read_fields(TomlTable& motion, const std::filesystem::path& folder, MotionScene& scene) {
  read_field(motion, "field", folder, scene.field);
  read_field(motion, "force", folder, scene.force);
  if (motion.get("sample", scene.sample) && std::count(scene.sample.begin(), scene.sample.end(), "") != 0)
    motion.fail("sample", "sample must be names of arrays");
  const std::string& diffusivity = scene.diffusivity;
  if (!diffusivity.empty() && std::count(scene.sample.begin(), scene.sample.end(), diffusivity) == 0)
    scene.sample.push_back(diffusivity);
  if (motion.has("integrate")) {
    TomlTable t = motion.table("integrate");
    for (const std::string& name : t.keys()) t.get(name, scene.integrate[name]);
    t.finish();
    if (scene.sample.empty()) motion.fail("integrate", "integrate needs sample: values that particles take");
  }
  if (motion.has("turbulence")) read_turbulence(motion.table("turbulence"), scene);
  const bool has_field = scene.field.given();
  if (!has_field && motion.has("turbulence")) motion.fail("turbulence", "turbulence needs a field: give field");
  if (motion.is_table("field") && motion.has("field_frame"))
    motion.fail("field_frame", "field_frame belongs to a field that is a name: say frame in the field's table");
  if (motion.get("field_frame", scene.field.frame, {{"space", FieldFrame::space}, {"mesh", FieldFrame::mesh}}) &&
      !has_field) {
    motion.fail("field_frame", "field_frame needs a field");
  }
  motion.get("integrator", scene.integrator, {{"euler", Integrator::euler}, {"rk4", Integrator::rk4}});
  if (scene.integrator == Integrator::rk4) {
    if (!has_field) motion.fail("integrator", "integrator = \"rk4\" needs a field, which the particles follow");
    if (scene.drag != 0.0)
      motion.fail("integrator", "integrator = \"rk4\" is for particles without mass: leave drag out");
    if (scene.substeps != 1)
      motion.fail("integrator", "integrator = \"rk4\" takes a step as one segment: leave substeps out");
  }
  if (scene.force.given() && has_field && scene.drag == 0.0 && scene.forces.terms.empty())
    motion.fail("force", "a force has no effect on particles that follow a field without drag: give drag or forces");
}

}  // namespace dartcast
