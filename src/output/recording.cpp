// Frames and tables of the particles, and the folder that they stand in.
#include "output/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/file_write.hpp"
#include "output/frame_files.hpp"
#include "output/particle_frame.hpp"
#include "output/run_files.hpp"
#include "output/run_lock.hpp"
#include "output/summary.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view stats_header =
    "step,time,alive,injected,absorbed,escaped,held,contacts,orientation_tests,exact_tests,forecast_kept,updated_by_"
    "deformation";
constexpr std::string_view energy_header = ",kinetic_energy,potential_energy";
constexpr std::string_view contacts_header =
    "step,time,id,kind,patch,cell,x,y,z,normal_x,normal_y,normal_z,wall_dx,wall_dy,wall_dz";

// An earlier run left a table of steps with our header.
bool holds_a_run(const fs::path& folder) {
  std::ifstream file(folder / "stats.csv");
  std::string line;
  return std::getline(file, line) && line.starts_with(stats_header);
}

std::string environment_name(const RecordingFrame& frame) {
  return frame_name("environment", frame.step, frame.environment_pieces > 1 ? ".pvtu" : ".vtu");
}

// A copy of the names: the folder changes while they are used.
std::vector<std::string> run_files(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (entry.is_regular_file() && is_run_file(name)) names.push_back(name);
  }
  return names;
}

// The checkpoint goes first: no run goes on without its files. Then the lists go, before the frames that they name. The
// table stays until the new one takes its place: by it the folder is known as a run's.
void remove_earlier_run(const fs::path& folder) {
  fs::remove(folder / "checkpoint.bin");
  const std::vector<std::string> names = run_files(folder);
  for (const std::string& name : names) {
    if (name.ends_with(".pvd")) fs::remove(folder / name);
  }
  for (const std::string& name : names) {
    if (name != "stats.csv" && name != kept_mesh_name) fs::remove(folder / name);
  }
}

void remove_later_frames(const fs::path& folder, std::span<const RecordingFrame> frames) {
  std::set<std::uint64_t> kept;
  for (const RecordingFrame& frame : frames) kept.insert(frame.step);
  const std::vector<std::string> names = run_files(folder);
  for (const std::string& name : names) {
    if (name.ends_with(".pvd")) keep_in_pvd(folder / name, kept);
  }
  for (const std::string& name : names) {
    const auto step = frame_step(name);
    if (is_part_of_run_file(name) || (step && !kept.contains(*step))) fs::remove(folder / name);
  }
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw Error(fmt::format("{}: this is a file; name a folder for the output with -o", folder.string()));
  }
  const bool vacant = std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const auto& entry) {
    const std::string name = entry.path().filename();
    return name == run_lock_name || name == kept_mesh_name || is_part_of_run_file(name);
  });
  if (vacant || holds_a_run(folder)) return;
  throw Error(fmt::format("{}: the folder holds other files than a run's; name another with -o", folder.string()));
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

Recording::Recording(const RunFolder& run, Options options, std::optional<EnvironmentRecord>& environment,
                     const std::string& scene_text)
    : Recorder(run), options_(options), environment_(environment) {
  if (run.before == nullptr) {
    check_output_folder(folder_);
    make_output_folder(folder_);
    remove_earlier_run(folder_);
  }
  stats_ =
      run.table("stats.csv", fmt::format("{}{}{}", stats_header, options_.surgery ? ",in_opened" : "", energy_header),
                &FilesProgress::stats_bytes);
  if (options_.contacts) contacts_ = run.table("contacts.csv", contacts_header, &FilesProgress::contacts_bytes);
  const bool in_frames = options_.changes || options_.environment_pieces > 1;
  if (run.before != nullptr) {
    remove_later_frames(folder_, run.before->frames);
  } else {
    if (!scene_text.empty()) write_bytes(folder_ / "scene.toml", scene_text);
    if (!in_frames)
      write_frame_file(writing_, folder_ / "environment.vtu", environment_->at_rest(), options_.of_environment());
  }
  if (!in_frames) environment_.reset();
}

void Recording::add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) {
  const RecordingFrame& frame = frames.back();
  const XmlDataSet particles = write_particles(writing_, folder_, simulation, frame, 0, options_.of_particles());
  if (frame.pieces > 1) write_index(writing_, folder_, frame, "particles", ".vtp", frame.pieces, particles);
  if (shows_environment(options_, frame)) {
    const XmlDataSet data =
        write_environment(writing_, folder_, simulation, *environment_, frame, 0, options_.of_environment());
    if (frame.environment_pieces > 1)
      write_index(writing_, folder_, frame, "environment", ".vtu", frame.environment_pieces, data);
  }
  write_lists(frames);
}

bool shows_environment(const Recording::Options& options, const RecordingFrame& frame) {
  return options.changes || (frame.environment_pieces > 1 && frame.step == 0);
}

XmlDataSet write_environment(WritingThread& writing, const fs::path& folder, const Simulation& simulation,
                             EnvironmentRecord& record, const RecordingFrame& frame, unsigned piece,
                             Compression compression) {
  const std::string name =
      frame.environment_pieces > 1 ? piece_name("environment", frame.step, piece, ".vtu") : environment_name(frame);
  XmlDataSet data = record.data_set(simulation.environment());
  write_frame_file(writing, folder / name, data, compression);
  return data;
}

void Recording::write_lists(std::span<const RecordingFrame> frames) const {
  write_list(writing_, folder_ / "particles.pvd", frames, particle_frame_name);
  if (options_.changes) return write_list(writing_, folder_ / "environment.pvd", frames, environment_name);
  write_list(writing_, folder_ / "environment.pvd", frames.first(1), [](const RecordingFrame& f) {
    return f.environment_pieces > 1 ? environment_name(f) : std::string("environment.vtu");
  });
}

void Recording::save(FilesProgress& progress) {
  progress.stats_bytes = stats_.send(writing_);
  progress.contacts_bytes = contacts_.send(writing_);
}

void Recording::add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& sums) {
  const Counters& c = step.report.counters;
  stats_.print("{},{},{},{},{},{},{},{}", simulation.steps(), simulation.time(), sums.alive, step.injected,
               step.absorbed, step.escaped, step.report.held.size(), c.contacts[0] + c.contacts[1] + c.contacts[2]);
  if (counts_tests(c) && counts_tests(simulation.totals().counters))
    stats_.print(",{},{},{},{}", c.orientation.tests, c.orientation.exact, c.forecast_kept, c.updated_by_deformation);
  else
    stats_.print(",,,,");
  if (options_.surgery) stats_.print(",{}", simulation.event_log().in_opened);
  stats_.print(",{},{}\n", sums.energy.kinetic, sums.energy.potential);
  if (options_.contacts) write_contacts(simulation, step);
  stats_.send_many(writing_);
  contacts_.send_many(writing_);
}

void Recording::write_contacts(const Simulation& simulation, const SimulationStep& step) {
  static constexpr std::string_view kinds[] = {"vertex", "edge", "face", "volume"};
  const CombinatorialMap& map = simulation.environment().map();
  const double dt = step.duration;
  for (std::size_t i = 0; i < step.contact_ids.size(); ++i) {
    const Contact& c = step.report.contacts.contacts[i];
    const WallHit& wall = step.report.contacts.walls_of(c).front();
    contacts_.print("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(),
                    simulation.time() - dt * (1.0 - c.time_of_impact), step.contact_ids[i],
                    kinds[static_cast<std::size_t>(c.kind)], map.patch_names()[wall.patch.value],
                    step.contact_sources[i], c.point.x, c.point.y, c.point.z, wall.normal.x, wall.normal.y,
                    wall.normal.z, c.wall_displacement.x, c.wall_displacement.y, c.wall_displacement.z);
  }
}

}  // namespace dartcast
