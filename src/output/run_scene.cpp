// Runs a scene: loads its files, makes the simulation, and steps it while output and audit observe.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <memory>
#include <utility>
#include <variant>

#include "base/are_several.hpp"
#include "base/parallel.hpp"
#include "base/reduced.hpp"
#include "dartcast/error.hpp"
#include "dartcast/replay.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "mesh/mesh_scale.hpp"
#include "output/run_files.hpp"
#include "output/run_output.hpp"
#include "output/wall_faces.hpp"
#include "scene/scene_mesh.hpp"
#include "simulation/particle_share.hpp"
#include "simulation/simulation_view.hpp"

namespace dartcast {

namespace {

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void describe(const Environment& environment, Summary& summary) {
  const CombinatorialMap& map = environment.map();
  summary.cells = map.cell_count();
  summary.free_cells = 0;
  for (const Cell c : map.cells()) summary.free_cells += map.is_free(c) ? 1 : 0;
  summary.vertices = environment.positions().size();
  summary.wall_faces = map.wall_face_count();
  summary.bytes = environment.complex().bytes();
  summary.patch_names = map.patch_names();
}

// Before the mesh moves. Where ranks have parts of it, each cell counts once.
void describe_mesh(const Scene& scene, const RunOptions& options, Summary& summary) {
  MeshScale scale;
  if (const auto* part = std::get_if<MeshPart>(&scene.environment.mesh)) {
    scale = reduced(options.ranks, mesh_scale(part->mesh, options.threads, part->owners, part->part),
                    [](MeshScale& sum, const MeshScale& other) { sum += other; });
  } else {
    scale = mesh_scale(std::get<MeshData>(scene.environment.mesh), options.threads);
  }
  if (scale.edge_count == 0) return;
  summary.low = scale.low;
  summary.high = scale.high;
  summary.smallest_edge = scale.smallest_edge;
  summary.mean_edge = scale.mean_edge();
}

// If ranks have parts of the environment: the cells of each count once, and so does what belongs to the lowest of them.
void describe_parts(const Simulation& simulation, Summary& summary) {
  const PartCells& part = view_of(simulation).part->cells();
  const CombinatorialMap& map = simulation.environment().map();
  std::array<std::uint64_t, 5> sums{};
  std::vector<Cell> lowest(simulation.environment().positions().size());
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    for (const std::uint32_t v : view.vertices()) {
      if (v < lowest.size() && !lowest[v].valid()) lowest[v] = c;
    }
    if (!part.is_own(c)) continue;
    ++sums[0];
    sums[1] += view.is_free() ? 1 : 0;
    for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) sums[2] += view.is_wall(f) ? 1 : 0;
  }
  for (const Cell c : lowest) sums[3] += c.valid() && part.is_own(c) ? 1 : 0;
  sums[4] = simulation.environment().complex().bytes();
  simulation.options().ranks->sum(sums);
  summary.cells = sums[0];
  summary.free_cells = sums[1];
  summary.wall_faces = sums[2];
  summary.vertices = sums[3];
  summary.bytes = sums[4];
  summary.patch_names.pop_back();  // behind the ghosts
}

StatisticsSummary summary_of(const Simulation& simulation) {
  const Statistics& s = simulation.statistics();
  StatisticsSummary summary;
  summary.options = simulation.statistics_options();
  summary.hit_faces = s.hits.faces().size();
  summary.hits_by_patch = s.hits.by_patch(simulation.environment());
  summary.ended_by_patch = s.hits.ended_by_patch();
  summary.ended_by_patch.resize(summary.hits_by_patch.size());
  summary.time = simulation.time();
  summary.planes = s.planes;
  summary.left = s.left;
  summary.left_by_class = s.left_by_class;
  summary.absorbed_by_edits = s.absorbed_by_edits;
  summary.seconds = s.seconds;
  return summary;
}

// The loop over a simulation's steps.
class Run {
 public:
  Run(Simulation& simulation, RunOutput& output, std::uint64_t steps, Summary& summary)
      : simulation_(simulation), output_(output), steps_(steps), summary_(summary) {
    if (!output.found()) return;
    summary_.held = output.found()->held;
    if (summary_.audit) summary_.audit->checked = output.found()->audited;
  }

  void run(const Progress& progress, const Announce& announce) {
    if (!output_.found()) output_.add_frame(simulation_, steps_ == 0);
    if (announce && ParticleShare(simulation_.options().ranks).is_first()) announce(output_.expected(simulation_));
    while (simulation_.steps() < steps_ && !summary_.cancelled) {
      const SimulationStep& step = simulation_.step();
      summary_.held = step.report.held.size();
      if (summary_.audit) *summary_.audit += simulation_.audit();
      count_far_steps();
      output_.add_step(simulation_, step);
      output_.add_frame(simulation_, simulation_.steps() == steps_);
      cancel_unless(goes_on(!progress || progress(simulation_.steps(), steps_)));
    }
    finish();
  }

 private:
  void add_areas() {
    const auto* part = view_of(simulation_).part;
    std::vector<ExactSum> areas =
        wall_areas(simulation_.environment(), [&](Cell c) { return part == nullptr || part->cells().is_own(c); });
    if (part != nullptr) areas.pop_back();  // behind the ghosts
    for (const ExactSum& area : areas) {
      ExactSum::Words words = area.words();
      if (part != nullptr) sum_over(simulation_.options().ranks, words);
      summary_.patch_areas.push_back(ExactSum::of(words).value());
    }
  }

  // If all ranks do.
  [[nodiscard]] bool goes_on(bool own) const {
    std::uint64_t stops = own ? 0 : 1;
    sum_over(simulation_.options().ranks, {&stops, 1});
    return stops == 0;
  }

  // Steps so long that the scale of the mesh may be wrong. A pass over the velocities takes time: not in each step.
  void count_far_steps() {
    if (simulation_.steps() > 1 && !output_.on_schedule(simulation_.steps())) return;
    const double far = 100.0 * summary_.mean_edge / simulation_.options().dt;
    for (const Vec3& v : simulation_.velocities()) summary_.far_steps += dot(v, v) > far * far ? 1 : 0;
  }

  void cancel_unless(bool goes_on) {
    if (goes_on || simulation_.steps() == steps_) return;
    summary_.cancelled = true;
    if (!output_.on_schedule(simulation_.steps())) output_.add_frame(simulation_, true);
  }

  void finish() {
    summary_.steps = simulation_.steps();
    summary_.totals = simulation_.totals_of_all();
    sum_over(simulation_.options().ranks, {&summary_.far_steps, 1});
    summary_.seconds_solids = simulation_.seconds_solids();
    summary_.alive = simulation_.alive();
    if (summary_.surgery) {
      summary_.surgery = simulation_.event_log();
      describe(simulation_.environment(), summary_);
    }
    add_areas();
    const SimulationTotals& t = summary_.totals;
    summary_.lost = t.start + t.injected - t.absorbed - t.escaped - summary_.alive;
    if (summary_.audit) summary_.lost += simulation_.audit().failed;
    summary_.state_hash = simulation_.state_hash().hex();
    summary_.bodies = simulation_.body_summaries();
    summary_.catheters = simulation_.catheter_summaries();
    summary_.solids = simulation_.solid_summaries();
    if (simulation_.statistics_options().any()) summary_.statistics = summary_of(simulation_);
  }

  Simulation& simulation_;
  RunOutput& output_;
  std::uint64_t steps_;
  Summary& summary_;
};

// A run much shorter than the first interval of its samples sees them hardly change: their times may be iterations, or in
// another unit.
void warn_of_short_run(const Scene& scene, std::uint64_t steps, std::vector<Finding>& warnings) {
  constexpr double small_share = 0.05;
  const double duration = static_cast<double>(steps) * scene.motion.dt;
  const auto check = [&](const std::string& owner, const std::vector<double>& times) {
    if (steps == 0 || times.size() < 2 || duration >= small_share * (times[1] - times[0])) return;
    warnings.push_back({"short_run",
                        1,
                        {},
                        fmt::format("series of samples that hardly changes in the run: {} has the times {:.6g} and "
                                    "{:.6g} s, and the run takes {:.6g} s; "
                                    "are the times in seconds, and no iterations (steady = true)?",
                                    owner, times[0], times[1], duration)});
  };
  for (const DeformationScene& s : scene.deformation) check("the deformation", s.step.times);
  check("the field", scene.motion.field.samples.times);
  check("the force", scene.motion.force.samples.times);
}

// The scene with the run's own options.
Scene scene_to_run(const Scene& scene, const RunOptions& options) {
  Scene wanted = scene;
  wanted.seed = options.seed.value_or(scene.seed);
  wanted.environment.skip_bad_cells = scene.environment.skip_bad_cells || options.skip_bad_cells;
  return wanted;
}

// With the output's record of the environment following the edits that a checkpoint repeats.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, RunOutput& output, const RunOptions& options) {
  const auto follow = [&output](const Environment& environment) { output.update_after_edit(environment); };
  if (!output.found()) {
    auto simulation = std::make_unique<Simulation>(scene, options.threads, options.ranks, options.partition);
    simulation->set_after_edit(follow);
    return simulation;
  }
  const SimulationCheckpoint saved(output.found()->simulation);
  return std::make_unique<Simulation>(scene, saved, options.threads, follow, options.ranks, options.partition);
}

// If a program makes a mesh around surfaces, the first rank has it made, and the others find it in the folder.
LoadedScene loaded_scene(Scene scene, const ReadOptions& read, const RunOptions& options) {
  if (options.partition == Partition::cells && are_several(options.ranks))
    return load_scene_part(std::move(scene), *options.ranks, read, options.threads);
  const bool waits = std::holds_alternative<SurfaceScene>(scene.environment.mesh) && !read.kept_mesh.empty();
  std::uint64_t nothing = 0;
  if (waits && !ParticleShare(options.ranks).is_first()) sum_over(options.ranks, {&nothing, 1});
  LoadedScene loaded = load_scene_files(std::move(scene), read, options.threads);
  if (waits && ParticleShare(options.ranks).is_first()) sum_over(options.ranks, {&nothing, 1});
  return loaded;
}

// Writes the first step that went wrong.
void keep_first(const StepReplay& step, const std::filesystem::path& folder, Summary& summary) {
  if (!summary.replay.empty()) return;
  const std::filesystem::path file = folder / replay_name;
  write_replay(step, file);
  summary.replay = file;
}

[[noreturn]] void throw_with_file(const InternalError& e, const std::filesystem::path& folder, Summary& summary) {
  if (folder.empty() || !e.replay()) throw e;
  keep_first(*e.replay(), folder, summary);
  throw InternalError(fmt::format("{} ({}: take it again by dartcast replay)", e.what(), summary.replay.string()),
                      e.replay());
}

}  // namespace

Summary run_scene(const Scene& scene, const RunOptions& options, const Progress& progress, const Announce& announce) {
  if (!options.folder.empty() && ParticleShare(options.ranks).is_first()) check_output_folder(options.folder);
  if (options.steps.value_or(0) > max_steps)
    throw InvalidArgument(fmt::format("run: {} steps; give at most {}", *options.steps, max_steps));
  Summary summary;
  summary.scene = scene.name;
  summary.threads = thread_count(options.threads);
  summary.ranks = options.ranks != nullptr ? options.ranks->size() : 1;
  summary.deforms = !scene.deformation.empty();
  summary.has_masses = scene.collisions.has_value();
  if (!scene.events.empty() || scene.remesh.every > 0 || scene.adaptive_subdivision.every > 0)
    summary.surgery.emplace();
  if (options.audit) summary.audit.emplace();
  const Stopwatch load;
  ReadOptions read{{}, options.max_memory, false, {}, options.on_stage};
  if (!options.folder.empty()) read.kept_mesh = options.folder / kept_mesh_name;
  Scene wanted = scene_to_run(scene, options);
  LoadedScene loaded = loaded_scene(std::move(wanted), read, options);
  summary.skipped = std::move(loaded.skipped);
  summary.warnings = std::move(loaded.warnings);
  const std::uint64_t steps = options.steps.value_or(scene.motion.steps);
  warn_of_short_run(loaded.scene, steps, summary.warnings);
  RunOutput output(loaded.scene, options, summary);
  output.find_checkpoint();
  enter_stage(read, "building the map, placing particles");
  describe_mesh(loaded.scene, options, summary);
  summary.seconds_load = load.seconds();
  const Stopwatch locate;
  const std::unique_ptr<Simulation> simulation =
      with_mesh_name(scene.environment.mesh, [&] { return make_simulation(loaded.scene, output, options); });
  describe(simulation->environment(), summary);
  if (view_of(*simulation).part) describe_parts(*simulation, summary);
  summary.seconds_locate = locate.seconds();
  output.open(std::move(loaded.scene.environment.mesh), *simulation);
  if (options.audit && !options.folder.empty())
    simulation->set_replay_hook([&](const StepReplay& step) { keep_first(step, options.folder, summary); });
  try {
    Run(*simulation, output, steps, summary).run(progress, announce);
  } catch (const InternalError& e) {
    throw_with_file(e, options.folder, summary);
  }
  output.finish(*simulation);
  return summary;
}

}  // namespace dartcast
