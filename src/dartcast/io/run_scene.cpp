#include "dartcast/io/run_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "dartcast/base/error.hpp"
#include "dartcast/io/point_file.hpp"
#include "dartcast/io/recording.hpp"
#include "dartcast/io/scene_mesh.hpp"

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

Responses make_responses(const ContactScene& scene, const Map& map) {
  Responses responses(scene.general);
  for (const auto& [name, response] : scene.by_patch) responses.set(map.patch(name), response);
  return responses;
}

FlowOptions flow_options(const Scene& scene, const RunOptions& options) {
  FlowOptions flow;
  flow.dt = scene.motion.dt;
  flow.gravity = scene.motion.gravity;
  flow.drag = scene.motion.drag;
  flow.substeps = scene.motion.substeps;
  flow.seed = options.seed.value_or(scene.seed);
  return flow;
}

void add_placed(Flow& flow, const std::filesystem::path& file, const Vec3& velocity) {
  const auto added = flow.add(read_points(file).points, velocity);
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i].location.place == Place::free) continue;
    throw Error(fmt::format("{}: position {} (counted from 0) is {}; move or remove it", file.string(), i,
                            added[i].location.place == Place::blocked ? "in a blocked cell" : "outside the mesh"));
  }
}

void add_particles(Flow& flow, const Scene& scene) {
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* random = std::get_if<RandomParticles>(&p.source)) flow.add_random(random->count, p.velocity);
    if (const auto* placed = std::get_if<PlacedParticles>(&p.source)) add_placed(flow, placed->positions, p.velocity);
    if (const auto* inlet = std::get_if<InletParticles>(&p.source)) {
      flow.add_inlet(flow.environment().map().patch(inlet->patch), inlet->rate, p.velocity);
    }
  }
}

void describe(const Environment& environment, Summary& summary) {
  const Map& map = environment.map();
  summary.threads = environment.threads().count;
  if (summary.threads == 0) summary.threads = std::max(1U, std::thread::hardware_concurrency());
  summary.cells = map.cell_count();
  for (const Cell c : map.cells()) summary.free_cells += map.is_free(c) ? 1 : 0;
  summary.vertices = environment.positions().size();
  summary.wall_faces = map.wall_face_count();
  summary.bytes = environment.complex().bytes();
  summary.patch_names = map.patch_names();
}

// The steps of a run, with their output and audit.
class Run {
 public:
  Run(Flow& flow, Recording* recording, const Scene& scene, const RunOptions& options, Summary& summary)
      : flow_(flow),
        recording_(recording),
        every_(scene.output.every),
        steps_(options.steps.value_or(scene.motion.steps)),
        audit_(options.audit),
        summary_(summary) {}

  void run(const Progress& progress) {
    if (audit_) summary_.audit.emplace();
    write([&] { add_frame(); });
    for (std::uint64_t i = 0; i < steps_; ++i) {
      const FlowStep& step = flow_.step();
      summary_.held = step.report.held.size();
      if (audit_) *summary_.audit += check();
      write([&] {
        recording_->add_step(flow_, step);
        if ((i + 1) % std::max<std::uint64_t>(every_, 1) == 0 || i + 1 == steps_) add_frame();
      });
      if (progress) progress(i + 1, steps_);
    }
    finish();
  }

 private:
  void add_frame() {
    if (every_ > 0) recording_->add_frame(flow_);
  }

  template <class Write>
  void write(Write&& action) {
    if (recording_ == nullptr) return;
    const Stopwatch watch;
    action();
    summary_.seconds_write += watch.seconds();
  }

  [[nodiscard]] Audit check() const {
    return audit(flow_.environment().complex(), flow_.particles(), flow_.environment().threads());
  }

  void finish() {
    summary_.steps = steps_;
    summary_.totals = flow_.totals();
    summary_.alive = flow_.particles().size();
    const FlowTotals& t = summary_.totals;
    summary_.lost = t.start + t.injected - t.absorbed - t.escaped - summary_.alive;
    if (audit_) summary_.lost += check().failed;
    summary_.state_hash = flow_.state_hash().hex();
  }

  Flow& flow_;
  Recording* recording_;
  std::uint64_t every_;
  std::uint64_t steps_;
  bool audit_;
  Summary& summary_;
};

}  // namespace

Summary run_scene(const Scene& scene, const RunOptions& options, const Progress& progress) {
  if (!options.folder.empty()) check_output_folder(options.folder);
  Summary summary;
  summary.scene = scene.name;
  summary.deforms = !scene.deformation.empty();
  const Stopwatch load;
  const MeshData mesh = load_scene_mesh(scene.environment).mesh;
  Environment environment(mesh, options.threads);
  Flow flow(environment, flow_options(scene, options), make_responses(scene.contact, environment.map()));
  if (!scene.motion.field.empty()) {
    flow.set_field(VelocityField(environment.complex(), point_vectors(mesh, scene.motion.field), scene.motion.frame));
  }
  if (summary.deforms) flow.set_deformation(Deformation(load_deformation(scene.deformation, mesh), mesh.points));
  describe(environment, summary);
  summary.seconds_load = load.seconds();
  const Stopwatch locate;
  add_particles(flow, scene);
  summary.seconds_locate = locate.seconds();
  std::unique_ptr<Recording> recording;
  if (!options.folder.empty()) {
    const Stopwatch write;
    recording = std::make_unique<Recording>(Recording::Options{options.folder, summary.deforms, scene.output.contacts},
                                            mesh, scene.text);
    summary.seconds_write = write.seconds();
  }
  Run(flow, recording.get(), scene, options, summary).run(progress);
  if (recording) recording->finish(summary_json(summary));
  return summary;
}

}  // namespace dartcast
