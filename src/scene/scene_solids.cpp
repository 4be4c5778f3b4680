// Reads the bodies, catheters and solids of a scene.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "dartcast/mesh_files.hpp"
#include "scene/scene_keys.hpp"

namespace dartcast {

namespace {

constexpr std::string_view name_characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";

std::string solid_name(TomlTable& t, std::string_view kind, std::size_t number) {
  std::string name = fmt::format("{}{}", kind, number);
  t.get("name", name);
  if (name.empty() || name.size() > 64 || name.find_first_not_of(name_characters) != std::string::npos)
    t.fail("name", fmt::format("name = \"{}\": it names files, and must be of 1 to 64 letters, digits, - and _", name));
  return name;
}

void body_surface(TomlTable& t, const std::filesystem::path& folder, BodyScene& scene) {
  std::string file;
  std::size_t generator = 0;
  const bool has_file = t.get("surface", file);
  if (has_file == t.get("generator", generator, {"barrel"}))
    t.fail("surface", fmt::format("give either surface = \"FILE\" ({}) or generator = \"barrel\"",
                                  fmt::join(surface_endings(), ", ")));
  if (has_file) {
    scene.surface = folder / file;
    return;
  }
  BarrelOptions barrel;
  t.get("radius", barrel.radius, Range::positive);
  t.get("bulge", barrel.bulge, Range::not_negative);
  t.get("height", barrel.height, Range::positive);
  t.get("staves", barrel.staves, 3U, 1U << 14U);
  scene.surface = barrel;
}

void body_samples(TomlTable& t, BodyScene& scene) {
  t.require("spacing", "of its particles, in metres");
  t.get("spacing", scene.sampling.spacing, Range::positive);
  t.get("sample", scene.samples,
        {{"solid", BodySamples::solid}, {"surface", BodySamples::surface}, {"volume", BodySamples::volume}});
  std::uint64_t max_count = scene.sampling.max_count;
  t.get("most_particles", max_count, 1, 0xfffffffeU);
  scene.sampling.max_count = max_count;
}

void body_matter(TomlTable& t, BodyScene& scene) {
  BodyOptions& body = scene.body;
  t.get("mass", body.mass, Range::positive);
  body.radius = 0.5 * scene.sampling.spacing;
  t.get("particle_radius", body.radius, Range::not_negative);
  t.get("stiffness", body.stiffness, Range::not_negative);
  t.get("pull", body.pull, {0.0, 1.0});
  t.get("damping", body.damping, Range::not_negative);
  t.get("linear", body.match.linear, {0.0, 1.0});
  t.get("keep_volume", body.match.keep_volume);
  t.get("cluster", scene.cluster, Range::not_negative);
  t.get("edges", scene.edges);
  t.get("velocity", body.velocity);
  t.get("spin", body.angular_velocity);
}

// The end of a move that begins then.
double move_end(TomlTable& t, double begin) {
  double until = 0.0;
  t.require("until", "the time of the scene at which it ends, in seconds");
  t.get("until", until, Range::positive);
  if (!(until > begin)) t.fail("until", fmt::format("until = {}: each move must end after the one before", until));
  return until;
}

CatheterScene::Move catheter_move(TomlTable& t, double begin) {
  CatheterScene::Move move;
  move.until = move_end(t, begin);
  t.get("push", move.push, {-Range::unlimited, Range::unlimited});
  t.get("turn", move.turn, {-Range::unlimited, Range::unlimited});
  t.finish();
  return move;
}

void solid_shape(TomlTable& t, const std::filesystem::path& folder, SolidScene& scene) {
  std::string file;
  std::vector<Vec3> points;
  const bool has_file = t.get("surface", file);
  if (has_file == t.get("points", points))
    t.fail("surface", fmt::format("give either surface = \"FILE\" ({}) or points = [[0, 0, 0], ...]",
                                  fmt::join(surface_endings(), ", ")));
  if (has_file) scene.shape = folder / file;
  if (has_file) return;
  if (points.empty()) t.fail("points", "points is an empty list; give one or more");
  scene.shape = std::move(points);
}

SolidScene::Move solid_move(TomlTable& t, double begin) {
  SolidScene::Move move;
  move.until = move_end(t, begin);
  t.get("velocity", move.velocity);
  t.get("turn", move.turn);
  t.finish();
  return move;
}

}  // namespace

BodyScene read_body(TomlTable& t, const std::filesystem::path& folder, std::size_t number, std::uint64_t seed) {
  BodyScene scene;
  scene.name = solid_name(t, "body", number);
  scene.sampling.seed = seed;
  body_surface(t, folder, scene);
  t.get("scale", scene.scale, Range::positive);
  t.get("rotate", scene.rotate);
  t.get("at", scene.at);
  body_samples(t, scene);
  body_matter(t, scene);
  t.finish();
  return scene;
}

CatheterScene read_catheter(TomlTable& t, std::size_t number) {
  CatheterScene scene;
  scene.name = solid_name(t, "catheter", number);
  CatheterOptions& o = scene.options;
  t.require("entry", "where it comes in: a point of the free cells");
  t.get("entry", o.entry);
  t.require("direction", "in which it comes in");
  t.get("direction", o.direction);
  t.get("length", o.length, Range::positive);
  t.get("spacing", o.spacing, Range::positive);
  t.get("stiffness", o.stiffness, Range::not_negative);
  t.get("tip_length", o.tip_length, Range::not_negative);
  t.get("tip_curvature", o.tip_curvature, Range::not_negative);
  t.get("friction", o.friction, Range::not_negative);
  t.get("rounds", o.rounds, 1U, 10000U);
  t.get("edges", o.edges);
  t.get("camera", scene.camera, Range::not_negative);
  for (TomlTable& move : t.tables("moves"))
    scene.moves.push_back(catheter_move(move, scene.moves.empty() ? 0.0 : scene.moves.back().until));
  t.finish();
  return scene;
}

SolidScene read_solid(TomlTable& t, const std::filesystem::path& folder, std::size_t number) {
  SolidScene scene;
  scene.name = solid_name(t, "solid", number);
  solid_shape(t, folder, scene);
  t.get("scale", scene.scale, Range::positive);
  t.get("rotate", scene.rotate);
  t.get("at", scene.at);
  scene.pivot = scene.at;
  t.get("pivot", scene.pivot);
  t.get("catch_up", scene.catch_up);
  std::vector<std::string> meets;
  if (t.get("meets", meets)) scene.meets = std::move(meets);
  for (TomlTable& move : t.tables("moves"))
    scene.moves.push_back(solid_move(move, scene.moves.empty() ? 0.0 : scene.moves.back().until));
  t.finish();
  return scene;
}

}  // namespace dartcast
