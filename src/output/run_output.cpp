// Opens, fills and closes the output folder of a run.
#include "output/run_output.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "dartcast/error.hpp"
#include "dartcast/report.hpp"
#include "formats/file_write.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

RunOutput::RunOutput(const Scene& scene, const RunOptions& options, Summary& summary)
    : scene_(scene),
      recording_options_{options.folder, summary.deforms || summary.surgery, summary.surgery.has_value(),
                         scene.output.contacts, scene.output.compression},
      every_(scene.output.every),
      resume_(options.resume),
      threads_(options.threads),
      summary_(summary) {
  if (folder().empty()) return;
  if (std::filesystem::exists(folder())) lock_.take(folder());
  identity_ = run_identity(scene.text, std::get<MeshData>(scene.environment.mesh), scene.seed);
}

void RunOutput::find_checkpoint(std::uint64_t steps) {
  if (folder().empty() || !resume_) return;
  found_ = read_checkpoint(file(), identity_);
  if (!found_) return;
  record_.emplace(std::get<MeshData>(scene_.environment.mesh));  // it follows the edits that are made again
  const std::uint64_t done = found_->simulation.particles.steps;
  if (done > steps)
    throw Error(
        fmt::format("{}: {} steps are done already; ask for as many or more with --steps", folder().string(), done));
  if (done < steps) std::erase_if(found_->recording.frames, [&](const auto& f) { return !on_schedule(f.step); });
}

void RunOutput::update_after_edit(const Environment& environment) {
  if (report_) report_->update_after_edit(environment);
  if (recording_) return recording_->update_after_edit(environment);
  if (record_) record_->update_after_edit(environment);
}

void RunOutput::open(MeshData mesh, const Simulation& simulation) {
  if (folder().empty()) return;
  const ScopeTimer timer(summary_.seconds_write);
  if (!record_) record_.emplace(std::move(mesh));
  make_output_folder(folder());
  lock_.take(folder());
  writing_ = std::make_unique<WritingThread>();
  recording_ = found_
                   ? std::make_unique<Recording>(*writing_, recording_options_, std::move(*record_), found_->recording)
                   : std::make_unique<Recording>(*writing_, recording_options_, std::move(*record_), scene_.text);
  solids_ = found_ ? std::make_unique<SolidsRecording>(*writing_, folder(), scene_, found_->solids_recording)
                   : std::make_unique<SolidsRecording>(*writing_, folder(), scene_);
  statistics_ = found_
                    ? std::make_unique<StatisticsRecording>(*writing_, folder(), scene_, found_->statistics_recording)
                    : std::make_unique<StatisticsRecording>(*writing_, folder(), scene_);
  if (scene_.output.report && every_ > 0) open_report(simulation);
}

void RunOutput::open_report(const Simulation& simulation) {
  const ScopeTimer timer(summary_.seconds_report);
  report_ = found_ ? std::make_unique<ReportRecording>(*writing_, folder(), simulation, found_->report_recording)
                   : std::make_unique<ReportRecording>(*writing_, folder(), scene_, simulation);
}

void RunOutput::add_step(const Simulation& simulation, const SimulationStep& step) {
  if (folder().empty()) return;
  {
    const ScopeTimer timer(summary_.seconds_write);
    writing_->check();
    recording_->add_step(simulation, step, simulation.event_log().in_opened);
    solids_->add_step(simulation);
    statistics_->add_step(simulation);
  }
  if (!report_) return;
  const ScopeTimer timer(summary_.seconds_report);
  report_->add_step(simulation, step);
}

void RunOutput::add_frame(const Simulation& simulation, bool last) {
  if (folder().empty() || (!last && !on_schedule(simulation.steps()))) return;
  if (report_) {
    const ScopeTimer timer(summary_.seconds_report);
    report_->add_frame(simulation);
  }
  const ScopeTimer timer(summary_.seconds_write);
  write_frame(simulation);
}

void RunOutput::write_frame(const Simulation& simulation) {
  if (every_ > 0) {
    recording_->add_frame(simulation);
    solids_->add_frame(simulation, recording_->frames());
    statistics_->add_frame(simulation, recording_->frames());
  }
  if (on_schedule(simulation.steps())) statistics_->end_interval(simulation);
  const std::uint64_t audited = summary_.audit ? summary_.audit->checked : 0;
  auto checkpoint = std::make_shared<Checkpoint>(
      Checkpoint{identity_, simulation.checkpoint().state(), recording_->progress(), summary_.held, audited,
                 solids_->progress(), statistics_->progress(), report_ ? report_->progress() : ReportProgress{}});
  const ParticleSystemState& particles = checkpoint->simulation.particles;
  writing_->add(particles.particles.size() * sizeof(ParticleSystemState::Particle),
                [checkpoint, path = file()] { write_checkpoint(path, *checkpoint); });
}

void RunOutput::finish(const Simulation& simulation) {
  if (!writing_) return;
  {
    const ScopeTimer timer(summary_.seconds_write);
    recording_->progress();
    solids_->progress();
    statistics_->finish(simulation);
    if (report_) report_->progress();
    writing_->finish();
  }
  summary_.seconds_writing_thread = writing_->seconds();
  write_summary();
  if (report_) write_report_of_run();
}

void RunOutput::write_summary() const {
  const std::string text = summary_json(summary_) + "\n";
  const std::string_view whole = text;
  replace_file(folder() / "summary.json", {&whole, 1});
}

// The report shows the summary, whose time of the report is that of recording. The file has the whole time at last.
void RunOutput::write_report_of_run() {
  {
    const ScopeTimer timer(summary_.seconds_report);
    summary_.report = write_report(folder(), {.threads = threads_});
  }
  write_summary();
}

}  // namespace dartcast
