#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "output/checkpoint.hpp"
#include "output/environment_record.hpp"
#include "output/recording.hpp"
#include "output/run_lock.hpp"
#include "output/solids_recording.hpp"
#include "scene/scene_mesh.hpp"
#include "scene/seed_file.hpp"
#include "simulation/solids.hpp"

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

WallResponses make_responses(const ContactScene& scene, const CombinatorialMap& map) {
  WallResponses responses(scene.general);
  for (const auto& [name, response] : scene.by_patch) responses.set(map.patch(name), response);
  return responses;
}

std::vector<Event> make_events(const Scene& scene, const CombinatorialMap& map) {
  std::vector<Event> events;
  for (const EventScene& e : scene.events) {
    events.push_back(e.event);
    auto* reconnect = std::get_if<Reconnect>(&events.back().what);
    if (reconnect != nullptr && !e.patch.empty()) reconnect->options.side = map.patch(e.patch);
  }
  return events;
}

SimulationOptions flow_options(const Scene& scene, const RunOptions& options) {
  SimulationOptions flow;
  flow.dt = scene.motion.dt;
  flow.gravity = scene.motion.gravity;
  flow.drag = scene.motion.drag;
  flow.substeps = scene.motion.substeps;
  flow.seed = options.seed.value_or(scene.seed);
  flow.collisions = scene.collisions;
  return flow;
}

void add_placed(Simulation& flow, const std::filesystem::path& file, const ParticlesScene& scene,
                const ReadOptions& read) {
  Seeds seeds = read_seeds(file, read);
  if (seeds.velocities.empty()) seeds.velocities.assign(seeds.points.size(), scene.velocity);
  if (seeds.radii.empty()) seeds.radii.assign(seeds.points.size(), scene.radius);
  const auto added = flow.add(seeds.points, seeds.velocities, seeds.radii);
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i].location.place == Place::free) continue;
    throw Error(fmt::format("{}: position {} (counted from 0) is {}; move or remove it", file.string(), i,
                            added[i].location.place == Place::blocked ? "in a blocked cell" : "outside the mesh"));
  }
}

void add_inlets(Simulation& flow, const Scene& scene) {
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* inlet = std::get_if<InletParticles>(&p.source))
      flow.add_inlet(flow.environment().map().patch(inlet->patch), inlet->rate, p.velocity, p.radius);
  }
}

void add_particles(Simulation& flow, const Scene& scene, const ReadOptions& read) {
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* random = std::get_if<RandomParticles>(&p.source))
      flow.add_random(random->count, p.velocity, p.radius);
    if (const auto* placed = std::get_if<PlacedParticles>(&p.source)) add_placed(flow, placed->positions, p, read);
  }
}

void describe(const Environment& environment, Summary& summary) {
  const CombinatorialMap& map = environment.map();
  summary.threads = environment.threads().count;
  if (summary.threads == 0) summary.threads = std::max(1U, std::thread::hardware_concurrency());
  summary.cells = map.cell_count();
  summary.free_cells = 0;
  for (const Cell c : map.cells()) summary.free_cells += map.is_free(c) ? 1 : 0;
  summary.vertices = environment.positions().size();
  summary.wall_faces = map.wall_face_count();
  summary.bytes = environment.complex().bytes();
  summary.patch_names = map.patch_names();
}

// The output folder of a run: its recording, and checkpoints beside it. Without a folder it does nothing.
class Output {
 public:
  /// `mesh`: the environment's. Takes the folder, if it exists, before anything is read from it.
  Output(const Scene& scene, const RunOptions& options, MeshData mesh, Summary& summary)
      : scene_(scene),
        recording_options_{options.folder, summary.deforms || summary.surgery, summary.surgery.has_value(),
                           scene.output.contacts},
        every_(scene.output.every),
        resume_(options.resume),
        summary_(summary) {
    if (folder().empty()) return;
    if (std::filesystem::exists(folder())) lock_.take(folder());
    identity_ = run_identity(scene.text, mesh, options.seed.value_or(scene.seed));
    record_.emplace(std::move(mesh));
  }

  /// The checkpoint to go on from to so many steps; none: start.
  const std::optional<Checkpoint>& read(std::uint64_t steps) {
    if (folder().empty() || !resume_) return found_;
    found_ = read_checkpoint(file(), identity_);
    if (!found_) return found_;
    const std::uint64_t done = found_->flow.steps;
    if (done > steps)
      throw Error(
          fmt::format("{}: {} steps are done already; ask for as many or more with --steps", folder().string(), done));
    if (done < steps) std::erase_if(found_->recording.frames, [&](const auto& f) { return !on_schedule(f.step); });
    return found_;
  }

  /// To be called after each edit of the environment.
  void update_after_edit(const Environment& environment) {
    if (recording_) return recording_->update_after_edit(environment);
    if (record_) record_->update_after_edit(environment);
  }

  void open() {
    timed([&] {
      make_output_folder(folder());
      lock_.take(folder());
      recording_ = found_ ? std::make_unique<Recording>(recording_options_, std::move(*record_), found_->recording)
                          : std::make_unique<Recording>(recording_options_, std::move(*record_), scene_.text);
      solids_ = found_ ? std::make_unique<SolidsRecording>(folder(), scene_, found_->solids_recording)
                       : std::make_unique<SolidsRecording>(folder(), scene_);
    });
  }

  [[nodiscard]] const std::optional<Checkpoint>& found() const { return found_; }

  void add_step(const Simulation& flow, const SimulationStep& step, const EventLog& surgery, const Solids& solids) {
    timed([&] {
      recording_->add_step(flow, step, surgery.in_opened);
      solids_->add_step(solids, flow.steps(), flow.time());
    });
  }

  /// To be called before the first step and after each: a frame and a checkpoint where the scene wants one, and at the
  /// end.
  void add_frame(const Simulation& flow, const EventLog& surgery, const Solids& solids, bool last) {
    if (!last && !on_schedule(flow.steps())) return;
    timed([&] {
      if (every_ > 0) {
        recording_->add_frame(flow);
        solids_->add_frame(solids, recording_->frames());
      }
      const std::uint64_t audited = summary_.audit ? summary_.audit->checked : 0;
      write_checkpoint(file(), {identity_, flow.checkpoint(), recording_->progress(), surgery, summary_.held, audited,
                                solids.checkpoint(), solids_->progress()});
    });
  }

  void finish() {
    if (solids_) solids_->finish();
    if (recording_) recording_->finish(summary_json(summary_));
  }

 private:
  [[nodiscard]] const std::filesystem::path& folder() const { return recording_options_.folder; }
  [[nodiscard]] std::filesystem::path file() const { return folder() / "checkpoint.bin"; }
  [[nodiscard]] bool on_schedule(std::uint64_t step) const { return every_ > 0 && step % every_ == 0; }

  template <class Write>
  void timed(Write&& write) {
    if (folder().empty()) return;
    const Stopwatch watch;
    write();
    summary_.seconds_write += watch.seconds();
  }

  const Scene& scene_;
  Recording::Options recording_options_;
  std::uint64_t every_;
  bool resume_;
  Summary& summary_;
  RunIdentity identity_;
  RunLock lock_;
  std::optional<EnvironmentRecord> record_;  // until the recording has it
  std::optional<Checkpoint> found_;
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<SolidsRecording> solids_;
};

// The steps of a run, with their output and audit.
class Run {
 public:
  Run(Simulation& flow, EventScheduler& surgery, Solids& solids, Output& output, std::uint64_t steps, bool audit,
      Summary& summary)
      : flow_(flow),
        surgery_(surgery),
        solids_(solids),
        output_(output),
        steps_(steps),
        audit_(audit),
        summary_(summary) {
    if (audit_) summary_.audit.emplace();
    if (const auto& found = output.found()) {
      summary_.held = found->held;
      if (audit_) summary_.audit->checked = found->audited;
    }
  }

  void run(const Progress& progress) {
    if (flow_.steps() == 0) output_.add_frame(flow_, surgery_.log(), solids_, steps_ == 0);
    while (flow_.steps() < steps_) {
      surgery_.before_step();
      const double begin = flow_.time();
      const SimulationStep& step = flow_.step();
      step_solids(begin);
      surgery_.after_step();
      summary_.held = step.report.held.size();
      if (audit_) *summary_.audit += check();
      output_.add_step(flow_, step, surgery_.log(), solids_);
      output_.add_frame(flow_, surgery_.log(), solids_, flow_.steps() == steps_);
      if (progress) progress(flow_.steps(), steps_);
    }
    finish();
  }

 private:
  void step_solids(double begin) {
    const Stopwatch watch;
    solids_.step(begin);
    summary_.seconds_solids += watch.seconds();
  }

  [[nodiscard]] Audit check() const {
    Audit all = audit(flow_.environment().complex(), flow_.particles(), flow_.environment().threads());
    return all += solids_.audit();
  }

  void finish() {
    summary_.steps = steps_;
    summary_.totals = flow_.totals();
    summary_.alive = flow_.particles().size();
    if (summary_.surgery) {
      summary_.surgery = surgery_.log();
      describe(flow_.environment(), summary_);
    }
    const SimulationTotals& t = summary_.totals;
    summary_.lost = t.start + t.injected - t.absorbed - t.escaped - summary_.alive;
    if (audit_) summary_.lost += check().failed;
    StateHash hash = flow_.state_hash();
    summary_.state_hash = (hash += solids_.state_hash()).hex();
    summary_.bodies = solids_.body_summaries();
    summary_.catheters = solids_.catheter_summaries();
  }

  Simulation& flow_;
  EventScheduler& surgery_;
  Solids& solids_;
  Output& output_;
  std::uint64_t steps_;
  bool audit_;
  Summary& summary_;
};

// Particles at the start, or as a checkpoint has them.
void start(Simulation& flow, EventScheduler& surgery, Solids& solids, Output& output, const Scene& scene,
           const std::optional<Checkpoint>& checkpoint, const ReadOptions& read) {
  add_inlets(flow, scene);
  flow.set_after_edit([&](OrphanPolicy) {
    surgery.after_edit();
    output.update_after_edit(flow.environment());
  });
  if (checkpoint) {
    surgery.replay(checkpoint->surgery);
    flow.restore(checkpoint->flow);
    solids.restore(checkpoint->solids);
  } else {
    add_particles(flow, scene, read);
  }
  flow.set_after_edit([&](OrphanPolicy orphaned) {
    surgery.after_edit();
    solids.update_after_edit(orphaned);
    output.update_after_edit(flow.environment());
  });
}

}  // namespace

Summary run_scene(const Scene& scene, const RunOptions& options, const Progress& progress) {
  if (!options.folder.empty()) check_output_folder(options.folder);
  if (options.steps.value_or(0) > max_steps)
    throw InvalidArgument(fmt::format("run: {} steps; give at most {}", *options.steps, max_steps));
  Summary summary;
  summary.scene = scene.name;
  summary.deforms = !scene.deformation.empty();
  const Stopwatch load;
  const ReadOptions read = {{}, options.max_memory};
  EnvironmentScene wanted = scene.environment;
  wanted.skip_bad_cells = wanted.skip_bad_cells || options.skip_bad_cells;
  SceneMesh loaded = load_scene_mesh(wanted, read, options.threads);
  MeshData& mesh = loaded.mesh;
  summary.skipped = loaded.skipped;
  Environment environment = with_mesh_name(wanted.mesh, [&] { return Environment(mesh, options.threads); });
  const WallResponses responses = make_responses(scene.contact, environment.map());
  Simulation flow(environment, flow_options(scene, options), responses);
  if (!scene.motion.field.empty()) {
    flow.set_field(VelocityField(environment.complex(), point_vectors(mesh, scene.motion.field), scene.motion.frame));
  }
  if (summary.deforms)
    flow.set_deformation(Deformation(load_deformation(scene.deformation, mesh, wanted, read), mesh.points));
  describe(environment, summary);
  const std::vector<Event> events = make_events(scene, environment.map());
  EventScheduler surgery(events, scene.remesh, scene.adaptive_subdivision, scene.motion.dt, flow);
  if (!events.empty() || scene.remesh.every > 0 || scene.adaptive_subdivision.every > 0) summary.surgery.emplace();
  Solids solids(scene, environment, responses, read);
  if (scene.collisions && solids.bodies()) flow.set_bodies(*solids.bodies());
  summary.seconds_load = load.seconds();
  const std::uint64_t steps = options.steps.value_or(scene.motion.steps);
  Output output(scene, options, std::move(mesh), summary);
  const Stopwatch locate;
  start(flow, surgery, solids, output, scene, output.read(steps), read);
  summary.seconds_locate = locate.seconds();
  output.open();
  Run(flow, surgery, solids, output, steps, options.audit, summary).run(progress);
  output.finish();
  return summary;
}

}  // namespace dartcast
