// Opens, fills and closes the output folder of a run.
//
// If ranks share the particles, all make the same calls. The first writes all files but the pieces and parts that hold
// the others' particles. Each of these writes its own, and the first names them once they are whole.
#include "output/run_output.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "base/are_several.hpp"
#include "base/bytes.hpp"
#include "dartcast/error.hpp"
#include "dartcast/report.hpp"
#include "formats/file_write.hpp"
#include "output/particle_frame.hpp"
#include "output/report_recording.hpp"
#include "output/solids_recording.hpp"
#include "output/statistics_recording.hpp"
#include "output/summary.hpp"
#include "simulation/simulation_view.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

namespace {

bool is_spread(const RunOptions& options) {
  return options.partition == Partition::cells && are_several(options.ranks);
}

std::uint64_t steps_of(const Scene& scene, const RunOptions& options) {
  return options.steps.value_or(scene.motion.steps);
}

// The parts of checkpoints that this one replaces. Those of later ones may be on their way.
void remove_earlier_parts(const std::filesystem::path& folder, std::uint64_t step) {
  std::vector<std::filesystem::path> earlier;
  std::error_code gone;  // a folder that goes away is an error of what is written next
  for (const auto& entry : std::filesystem::directory_iterator(folder, gone)) {
    const auto of = checkpoint_part_step(entry.path().filename().string());
    if (of && *of < step) earlier.push_back(entry.path());
  }
  for (const std::filesystem::path& path : earlier) std::filesystem::remove(path, gone);
}

}  // namespace

RunOutput::RunOutput(const Scene& scene, const RunOptions& options, Summary& summary)
    : scene_(scene),
      folder_(options.folder),
      recording_options_{summary.deforms || summary.surgery || !scene.statistics.options.cells.empty(),
                         summary.surgery.has_value(),
                         scene.output.contacts,
                         scene.output.compression,
                         options.ranks != nullptr ? options.ranks->size() : 1,
                         is_spread(options) ? options.ranks->size() : 1},
      every_(scene.output.every.value_or(default_every(steps_of(scene, options)))),
      steps_(steps_of(scene, options)),
      resume_(options.resume),
      threads_(options.threads),
      ranks_(options.ranks),
      share_(options.ranks),
      summary_(summary) {
  if (folder().empty()) return;
  if (share_.is_first() && std::filesystem::exists(folder())) lock_.take(folder());
  const auto* part = std::get_if<MeshPart>(&scene.environment.mesh);
  identity_ = part != nullptr ? run_identity(scene.text, *part, *ranks_, scene.seed)
                              : run_identity(scene.text, std::get<MeshData>(scene.environment.mesh), scene.seed);
}

void RunOutput::find_checkpoint() {
  if (folder().empty() || !resume_) return;
  found_ = read_checkpoint(file(), identity_);
  if (!found_) return;
  every_ = found_->every;
  add_parts(*found_);
  if (const auto* mesh = std::get_if<MeshData>(&scene_.environment.mesh))
    record_.emplace(*mesh);  // it follows the edits that are made again
  const std::uint64_t done = found_->simulation.particles.steps;
  if (done > steps_)
    throw Error(
        fmt::format("{}: {} steps are done already; ask for as many or more with --steps", folder().string(), done));
  goes_on_ = done < steps_;
  if (goes_on_) std::erase_if(found_->files.frames, [&](const auto& f) { return !on_schedule(f.step); });
}

// Only those particles stay that are now this rank's: the others need not fit into its memory.
void RunOutput::add_parts(Checkpoint& checkpoint) const {
  if (checkpoint.parts.empty() && share_.has_all()) return;
  std::vector<SimulationState> states;
  states.push_back(std::move(checkpoint.simulation));
  keep_own(states.front().particles);
  for (unsigned rank = 1; rank <= checkpoint.parts.size(); ++rank) {
    SimulationState& state = states.emplace_back();
    const std::filesystem::path name = checkpoint_part_name(states.front().particles.steps, rank);
    state.particles = read_checkpoint_part(folder() / name, checkpoint.parts[rank - 1]);
    keep_own(state.particles);
  }
  std::vector<SimulationCheckpoint> parts;
  for (SimulationState& state : states) parts.emplace_back(std::move(state));
  checkpoint.simulation = joined(parts).state();
}

void RunOutput::keep_own(ParticleSystemState& state) const {
  if (recording_options_.environment_pieces > 1) return;  // whose they are is seen in the environment
  std::vector<std::uint8_t> gone;
  for (const std::uint64_t id : state.table[state.table.id]) gone.push_back(share_.holds(id) ? 0 : 1);
  state.table.remove(gone);
}

// Waits for the other ranks, or throws what one of them has failed of.
void RunOutput::meet() const {
  std::uint64_t nothing = 0;
  sum_over(ranks_, {&nothing, 1});
}

void RunOutput::update_after_edit(const Environment& environment) {
  if (record_) record_->update_after_edit(environment);
  for (const Clocked& c : recorders_) c.recorder->update_after_edit(environment);
}

void RunOutput::open(MeshSource mesh, const Simulation& simulation) {
  if (folder().empty()) return;
  const ScopeTimer timer(summary_.seconds_write);
  if (recording_options_.environment_pieces > 1)
    record_.emplace(own_mesh(*view_of(simulation).part_mesh));
  else if (!record_ && share_.is_first())
    record_.emplace(std::move(std::get<MeshData>(mesh)));
  if (share_.is_first()) open_files(simulation);
  meet();
  if (!share_.is_first()) writing_ = std::make_unique<WritingThread>();
}

void RunOutput::open_files(const Simulation& simulation) {
  make_output_folder(folder());
  lock_.take(folder());
  writing_ = std::make_unique<WritingThread>();
  const RunFolder run{*writing_, folder(), found_ ? &found_->files : nullptr};
  if (found_) frames_ = found_->files.frames;
  double* const write = &summary_.seconds_write;
  recorders_.push_back({write, std::make_unique<Recording>(run, recording_options_, record_, scene_.text)});
  recorders_.push_back({write, std::make_unique<SolidsRecording>(run, scene_)});
  recorders_.push_back({write, std::make_unique<StatisticsRecording>(run, scene_, every_)});
  if (!wants_report()) return;
  const ScopeTimer timer(summary_.seconds_report);
  recorders_.push_back(
      {&summary_.seconds_report, std::make_unique<ReportRecording>(run, every_, simulation, goes_on_)});
}

void RunOutput::add_step(const Simulation& simulation, const SimulationStep& step) {
  if (folder().empty()) return;
  StepSums sums;
  {
    const ScopeTimer timer(summary_.seconds_write);
    sums = {simulation.alive(), simulation.energy()};
    writing_->check();
  }
  for (const Clocked& c : recorders_) {
    const ScopeTimer timer(*c.seconds);
    c.recorder->add_step(simulation, step, sums);
  }
}

void RunOutput::add_frame(const Simulation& simulation, bool last) {
  if (folder().empty() || (!last && !on_schedule(simulation.steps()))) return;
  follow_balance(simulation);
  cells_ = simulation.cell_tally();
  if (cells_ && record_) record_->set_cell_arrays(simulation.cell_arrays(*cells_));
  if (share_.is_first()) return write_frame(simulation);
  write_part(simulation);
  if (!wants_report()) return;
  const ScopeTimer timer(summary_.seconds_report);
  reported_particles(simulation, {});  // the first rank's recorder gathers them
}

// The record is of the cells that the rank has now.
void RunOutput::follow_balance(const Simulation& simulation) {
  if (recording_options_.environment_pieces == 1 || balanced_ == view_of(simulation).balanced) return;
  balanced_ = view_of(simulation).balanced;
  record_.emplace(own_mesh(*view_of(simulation).part_mesh));
}

RecordingFrame RunOutput::frame_of(const Simulation& simulation) const {
  return {simulation.steps(), simulation.time(), recording_options_.pieces, recording_options_.environment_pieces};
}

// A rank but the first: it goes on when its files are whole.
void RunOutput::write_part(const Simulation& simulation) {
  const ScopeTimer timer(summary_.seconds_write);
  const Recording::Options& o = recording_options_;
  const RecordingFrame frame = frame_of(simulation);
  if (every_ > 0) {
    write_particles(*writing_, folder(), simulation, frame, ranks_->rank(), o.of_particles());
    if (frame.environment_pieces > 1 && shows_environment(o, frame))
      write_environment(*writing_, folder(), simulation, *record_, frame, ranks_->rank(), o.of_environment());
  }
  ParticleSystemState part = simulation.checkpoint().state().particles;
  part.totals.seconds_detect = part.totals.seconds_deform = 0.0;
  part.totals.seconds_collide = part.totals.seconds_respond = 0.0;
  const std::uint64_t digest = write_checkpoint_part(folder() / checkpoint_part_name(frame.step, ranks_->rank()), part);
  writing_->finish();
  ByteWriter bytes;
  bytes.put(digest);
  ranks_->gather(bytes.bytes());
}

// The digests of the other ranks' parts, which are then whole.
std::vector<std::uint64_t> RunOutput::written_parts() const {
  if (share_.has_all()) return {};
  const ScopeTimer timer(summary_.seconds_write);
  std::vector<std::uint64_t> digests;
  for (const std::string& bytes : ranks_->gather(std::string(sizeof(std::uint64_t), '\0')))
    digests.push_back(ByteReader(bytes).take<std::uint64_t>());
  digests.erase(digests.begin());
  return digests;
}

void RunOutput::write_frame(const Simulation& simulation) {
  std::vector<std::uint64_t> parts = written_parts();
  if (every_ > 0) record_frame(simulation);
  const ScopeTimer timer(summary_.seconds_write);
  FilesProgress files;
  files.frames = frames_;
  for (const Clocked& c : recorders_) c.recorder->save(files);
  const std::uint64_t audited = summary_.audit ? summary_.audit->checked : 0;
  SimulationState state = simulation.checkpoint().state();
  if (cells_) state.statistics.cells = cells_->words();
  auto checkpoint = std::make_shared<Checkpoint>(
      Checkpoint{identity_, every_, std::move(state), std::move(files), summary_.held, audited, std::move(parts)});
  writing_->add(checkpoint->simulation.particles.table.bytes(), [checkpoint, path = file()] {
    write_checkpoint(path, *checkpoint);
    remove_earlier_parts(path.parent_path(), checkpoint->simulation.particles.steps);
  });
}

void RunOutput::record_frame(const Simulation& simulation) {
  frames_.push_back(frame_of(simulation));
  for (const Clocked& c : recorders_) {
    const ScopeTimer timer(*c.seconds);
    c.recorder->add_frame(simulation, frames_);
  }
}

// It measures the frame of the start, or the last one of the run that goes on.
ExpectedOutput RunOutput::expected(const Simulation& simulation) const {
  ExpectedOutput all;
  if (!writing_) return all;
  const std::uint64_t done = simulation.steps();
  all.every = every_;
  all.frames = every_ == 0 ? 0 : steps_ / every_ - done / every_ + (steps_ % every_ != 0 && done < steps_ ? 1 : 0);
  if (!found_ && every_ > 0) ++all.frames;
  writing_->finish();
  std::uint64_t of_frame = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    if (!frames_.empty() && frame_step(entry.path().filename().string()) == frames_.back().step)
      of_frame += entry.file_size();
  }
  static constexpr std::uint64_t row_of_table = 120;
  all.bytes = all.frames * of_frame + (steps_ - done) * row_of_table;
  return all;
}

void RunOutput::finish(const Simulation& simulation) {
  if (!writing_) return;
  if (share_.is_first()) finish_files(simulation);
  meet();
}

void RunOutput::finish_files(const Simulation& simulation) {
  {
    const ScopeTimer timer(summary_.seconds_write);
    for (const Clocked& c : recorders_) c.recorder->finish(simulation);
    writing_->finish();
  }
  summary_.seconds_writing_thread = writing_->seconds();
  if (summary_.totals.start + summary_.totals.injected > 0) {
    const std::string table = deposition_csv(summary_);
    const std::string_view whole = table;
    replace_file(folder() / "deposition.csv", {&whole, 1});
  }
  if (cells_) write_cells(simulation);
  write_summary();
  if (wants_report()) write_report_of_run();
}

// By the order of cells. Centres are means of corners.
void RunOutput::write_cells(const Simulation& simulation) const {
  const CombinatorialMap& map = simulation.environment().map();
  const std::vector<DataArray> arrays = simulation.cell_arrays(*cells_);
  const std::vector<Cell> cells = map.cells();
  std::string table = "cell,x,y,z";
  for (const DataArray& a : arrays) {
    for (std::size_t k = 0; k < a.components; ++k) table += "," + component_name(a.name, a.components, k);
  }
  table += "\n";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::span<const std::uint32_t> corners = map.view(cells[i]).vertices();
    Vec3 centre;
    for (const std::uint32_t v : corners) centre += simulation.environment().complex().positions()[v];
    centre = centre * (1.0 / static_cast<double>(corners.size()));
    table += fmt::format("{},{},{},{}", map.source(cells[i]), centre.x, centre.y, centre.z);
    for (const DataArray& a : arrays) {
      for (std::size_t k = 0; k < a.components; ++k) table += fmt::format(",{}", a.values[i * a.components + k]);
    }
    table += "\n";
  }
  const std::string_view whole = table;
  replace_file(folder() / "cells.csv", {&whole, 1});
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
