// The verb trace: lists or draws the cells that a particle passes.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/trajectory.hpp"
#include "max_memory.hpp"
#include "scene/scene_mesh.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

struct TraceArguments {
  std::string input;
  std::string from;
  std::vector<std::string> to;
  std::string output;
  std::uint64_t max_memory = 0;
};

bool all_in_range(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return in_exact_range(Vec3{x, 0.0, 0.0}); });
}

// x,y or x,y,z.
std::vector<double> numbers_of(const std::string& text, const char* option) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    const auto [next, error] = std::from_chars(at, end, numbers.emplace_back());
    const bool more = error == std::errc() && next != end && *next == ',';
    if (error != std::errc() || (next != end && !more)) break;
    if (!more && numbers.size() >= 2 && numbers.size() <= 3 && all_in_range(numbers)) return numbers;
    if (!more) break;
    at = next + 1;
  }
  throw CLI::ValidationError(option,
                             fmt::format("'{}' is no point: give x,y in the plane, x,y,z in space; each finite, "
                                         "and at most 2^300 in magnitude",
                                         text));
}

Vec3 point_of(const std::string& text, const char* option, unsigned dimension) {
  const std::vector<double> x = numbers_of(text, option);
  if (dimension == 3 && x.size() == 2)
    throw InvalidArgument(fmt::format("{} {}: the mesh is in space, give x,y,z", option, text));
  return {x[0], x[1], x.size() == 3 ? x[2] : 0.0};
}

Environment load_environment(const std::string& path, const ReadOptions& options) {
  EnvironmentScene scene;
  scene.mesh = std::filesystem::path(path);
  if (std::filesystem::path(path).extension() == ".toml") scene = read_scene(path).environment;
  return with_mesh_name(scene.mesh, [&] { return Environment(load_scene_mesh(scene, options).mesh); });
}

void add_particle(Environment& environment, Particles& particles, const Vec3& x) {
  const AddResult added = environment.add(particles, {&x, 1}).front();
  if (added.location.place == Place::free) return;
  throw InvalidArgument(fmt::format("--from ({}, {}, {}) is {}: give a point in a free cell", x.x, x.y, x.z,
                                    added.location.place == Place::blocked ? "in a blocked cell" : "in no cell"));
}

int trace(const TraceArguments& arguments) {
  for (const std::string& text : arguments.to) numbers_of(text, "--to");
  numbers_of(arguments.from, "--from");
  const std::string ending = std::filesystem::path(arguments.output).extension().string();
  if (!arguments.output.empty() && ending != ".svg" && ending != ".csv")
    throw CLI::ValidationError("-o", fmt::format("'{}' ends in neither .svg nor .csv", arguments.output));
  Environment environment =
      while_waiting("loading " + arguments.input, true, {{}, arguments.max_memory},
                    [&](const ReadOptions& read) { return load_environment(arguments.input, read); });
  const unsigned dimension = environment.map().dimension();
  Particles particles;
  add_particle(environment, particles, point_of(arguments.from, "--from", dimension));
  std::vector<Vec3> targets;
  for (const std::string& text : arguments.to) targets.push_back(point_of(text, "--to", dimension));
  const std::vector<Trace> traces = environment.trace(particles, 0, targets);
  const std::string text =
      ending == ".svg" ? trajectory_svg(environment.complex(), traces) : trajectory_csv(environment.map(), traces);
  if (arguments.output.empty()) {
    fmt::print("{}", text);
    return done;
  }
  write_bytes(arguments.output, text);
  std::size_t crossings = 0;
  for (const Trace& t : traces) crossings += t.crossings.size();
  fmt::print("{}: {} crossings, {}\n", arguments.output, crossings,
             traces.back().result.stopped ? "stopped at a wall" : "arrived");
  return done;
}

}  // namespace

void add_trace(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<TraceArguments>();
  CLI::App* verb = app.add_subcommand("trace", "List or draw the cells that a particle passes on its way.");
  verb->add_option("MESH_OR_SCENE", arguments->input, "a mesh file, or a scene (.toml), as it stands at the start")
      ->type_name("FILE")
      ->required();
  verb->add_option("--from", arguments->from, "where it starts: x,y or x,y,z")->required()->type_name("POINT");
  verb->add_option("--to", arguments->to, "where it goes, as far as the first wall; several make a path")
      ->type_name("POINT")
      ->required()
      ->allow_extra_args(false);
  verb->add_option("-o", arguments->output, "a drawing (.svg, in the plane) or a table (.csv); else a table is printed")
      ->type_name("FILE");
  add_max_memory(*verb, arguments->max_memory);
  verb->callback([arguments, &status] { status = trace(*arguments); });
}

}  // namespace dartcast::app
