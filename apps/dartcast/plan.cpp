// The verb plan: what a run by cells would take on many processes.
#include "dartcast/plan.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>

#include "commands.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "limits.hpp"
#include "max_memory.hpp"
#include "output/plan_text.hpp"
#include "scene/scene_mesh.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

constexpr std::uint64_t max_ranks = 65536;

struct PlanArguments {
  std::string path;
  PlanOptions options;
  bool json = false;
  ReadOptions read;
};

// Particles of the scene at its start.
double particles_of(const Scene& scene) {
  double count = 0.0;
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* random = std::get_if<RandomParticles>(&p.source)) count += static_cast<double>(random->count);
    const auto* placed = std::get_if<PlacedParticles>(&p.source);
    const auto* seeds = placed != nullptr ? std::get_if<ParticleSeeds>(&placed->positions) : nullptr;
    if (seeds != nullptr) count += static_cast<double>(seeds->points.size());
  }
  return count;
}

int plan(PlanArguments a, bool has_particles) {
  WaitingLine waiting("planning for " + a.path, !a.json);
  MeshData mesh;
  if (std::filesystem::path(a.path).extension() == ".toml") {
    Scene scene = load_scene_files(read_scene(a.path), a.read).scene;
    a.options.deforms = a.options.deforms || !scene.deformation.empty();
    if (!has_particles) a.options.particles = particles_of(scene) / a.options.ranks;
    mesh = std::move(std::get<MeshData>(scene.environment.mesh));
  } else {
    mesh = read_valid_mesh(a.path, a.read).mesh;
  }
  const RunPlan result = plan_run(mesh, a.options);
  waiting.end();
  fmt::print("{}", a.json ? plan_json(result) + "\n" : plan_text(result));
  return done;
}

}  // namespace

void add_plan(CLI::App& app, int& status) {
  const auto a = std::make_shared<PlanArguments>();
  PlanOptions& o = a->options;
  CLI::App* verb = app.add_subcommand("plan", "Say what a run with --partition cells would take on many processes.");
  verb->add_option("MESH_OR_SCENE", a->path, "a mesh file, or a scene (.toml)")->required()->type_name("FILE");
  verb->add_option("--ranks", o.ranks, "the number of processes, 1 to 65536")
      ->required()
      ->type_name("N")
      ->transform(whole_number(1, max_ranks));
  CLI::Option* particles =
      verb->add_option("--particles", o.particles, "of each process, in the mean (100000; a scene's own)")
          ->type_name("N")
          ->check(number(0.0, 1e12));
  verb->add_option("--cells", o.cells,
                   "of each process, in the mean: as in a larger mesh of this form (as the mesh has)")
      ->type_name("N")
      ->check(number(0.0, 1e12));
  verb->add_option("--step", o.step, "the way of a particle in a step, in edges of a cell")
      ->type_name("N")
      ->check(number(0.0, 1.0))
      ->capture_default_str();
  verb->add_flag("--moving", o.deforms, "the points of the mesh move in every step");
  verb->add_option("--latency", o.latency, "of the network, in seconds")
      ->type_name("N")
      ->check(number(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--bandwidth", o.bandwidth, "of the network, in bytes a second")
      ->type_name("N")
      ->check(number(1.0, 1e15))
      ->capture_default_str();
  verb->add_flag("--json", a->json, "print one JSON object, and nothing else");
  add_max_memory(*verb, a->read.max_memory);
  verb->callback([a, particles, &status] { status = plan(*a, particles->count() > 0); });
}

}  // namespace dartcast::app
