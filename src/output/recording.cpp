// Frames and tables of the particles, and the folder that they stand in.
#include "output/recording.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/particle_state.hpp"
#include "formats/vtp_write.hpp"
#include "output/run_files.hpp"
#include "output/run_lock.hpp"

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

std::string particles_name(std::uint64_t step) { return frame_name("particles", step, ".vtp"); }
std::string environment_name(std::uint64_t step) { return frame_name("environment", step, ".vtu"); }

Kind kind_of(const CellComplex& complex, const ParticleState& s) {
  return s.held ? Kind::volume : forecast(complex.map(), s, complex.corners(s.at())).kind;
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw Error(fmt::format("{}: this is a file; name a folder for the output with -o", folder.string()));
  }
  const bool vacant = std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                                  [](const auto& entry) { return entry.path().filename() == run_lock_name; });
  if (vacant || holds_a_run(folder)) return;
  throw Error(fmt::format("{}: the folder holds other files than a run's; name another with -o", folder.string()));
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

Recording::Recording(Options options, EnvironmentRecord record, const std::string& scene_text)
    : options_(std::move(options)) {
  const fs::path& folder = options_.folder;
  check_output_folder(folder);
  make_output_folder(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_run_file(entry.path().filename().string())) fs::remove(entry.path());
  }
  stats_ = RunTable(folder / "stats.csv",
                    fmt::format("{}{}{}", stats_header, options_.surgery ? ",in_opened" : "", energy_header));
  if (options_.contacts) contacts_ = RunTable(folder / "contacts.csv", contacts_header);
  if (!scene_text.empty()) write_bytes(folder / "scene.toml", scene_text);
  if (!options_.changes) record.write_at_rest(folder / "environment.vtu");
  if (options_.changes) environment_ = std::move(record);
}

Recording::Recording(Options options, EnvironmentRecord record, const RecordingProgress& progress)
    : options_(std::move(options)), frames_(progress.frames) {
  stats_ = RunTable(options_.folder / "stats.csv", progress.stats_bytes);
  if (options_.contacts) contacts_ = RunTable(options_.folder / "contacts.csv", progress.contacts_bytes);
  if (options_.changes) environment_ = std::move(record);
  std::set<std::uint64_t> kept;
  for (const RecordingFrame& frame : frames_) kept.insert(frame.step);
  for (const auto& entry : fs::directory_iterator(options_.folder)) {
    const auto step = frame_step(entry.path().filename().string());
    if (step && !kept.contains(*step)) fs::remove(entry.path());
  }
}

void Recording::update_after_edit(const Environment& environment) {
  if (environment_) environment_->update_after_edit(environment);
}

void Recording::add_frame(const Simulation& simulation) {
  write_particles(simulation, options_.folder / particles_name(simulation.steps()));
  if (environment_)
    environment_->write(simulation.environment(), options_.folder / environment_name(simulation.steps()));
  if (frames_.empty() || frames_.back().step != simulation.steps())
    frames_.push_back({simulation.steps(), simulation.time()});
  write_lists();
}

void Recording::write_lists() const {
  write_pvd(options_.folder / "particles.pvd", frames_, particles_name);
  if (options_.changes) {
    write_pvd(options_.folder / "environment.pvd", frames_, environment_name);
  } else {
    const RecordingFrame at_rest;
    write_pvd(options_.folder / "environment.pvd", {&at_rest, 1}, [](std::uint64_t) { return "environment.vtu"; });
  }
}

RecordingProgress Recording::progress() { return {stats_.written(), contacts_.written(), frames_}; }

void Recording::write_particles(const Simulation& simulation, const fs::path& path) const {
  const Particles& particles = simulation.particles();
  const CellComplex& complex = simulation.environment().complex();
  VtpWriter file(particles.size(), [&](std::size_t i) { return particles[i].position; });
  file.add_vertices();
  file.add("id", [&](std::size_t i) { return static_cast<double>(simulation.ids()[i]); });
  file.add("radius", [&](std::size_t i) { return simulation.radii()[i]; });
  file.add_vectors("velocity", [&](std::size_t i) { return simulation.velocities()[i]; });
  file.add("cell", [&](std::size_t i) { return static_cast<double>(complex.map().source(particles[i].cell)); });
  file.add("kind", [&](std::size_t i) { return static_cast<double>(kind_of(complex, particles[i])); });
  file.add_flags("held", [&](std::size_t i) { return simulation.held()[i] != 0; });
  file.add("contacts", [&](std::size_t i) { return static_cast<double>(simulation.contact_counts()[i]); });
  const std::vector<std::string>& names = simulation.options().user_data;
  for (std::size_t k = 0; k < names.size(); ++k)
    file.add(names[k], [&](std::size_t i) { return simulation.user_data(i)[k]; });
  file.write(path);
}

void Recording::add_step(const Simulation& simulation, const SimulationStep& step, std::uint64_t in_opened) {
  const Counters& c = step.report.counters;
  fmt::print(stats_.stream(), "{},{},{},{},{},{},{},{},{},{},{},{}", simulation.steps(), simulation.time(),
             simulation.particles().size(), step.injected, step.absorbed, step.escaped, step.report.held.size(),
             step.report.contacts.contacts.size(), c.orientation.tests, c.orientation.exact, c.forecast_kept,
             c.updated_by_deformation);
  if (options_.surgery) fmt::print(stats_.stream(), ",{}", in_opened);
  const SimulationEnergy energy = simulation.energy();
  fmt::print(stats_.stream(), ",{},{}\n", energy.kinetic, energy.potential);
  if (options_.contacts) write_contacts(simulation, step);
  stats_.check();
}

void Recording::write_contacts(const Simulation& simulation, const SimulationStep& step) {
  static constexpr std::string_view kinds[] = {"vertex", "edge", "face", "volume"};
  const CombinatorialMap& map = simulation.environment().map();
  const double dt = step.duration;
  for (std::size_t i = 0; i < step.contact_ids.size(); ++i) {
    const Contact& c = step.report.contacts.contacts[i];
    const WallHit& wall = step.report.contacts.walls_of(c).front();
    fmt::print(contacts_.stream(), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(),
               simulation.time() - dt * (1.0 - c.time_of_impact), step.contact_ids[i],
               kinds[static_cast<std::size_t>(c.kind)], map.patch_names()[wall.patch.value], map.source(wall.face.cell),
               c.point.x, c.point.y, c.point.z, wall.normal.x, wall.normal.y, wall.normal.z, c.wall_displacement.x,
               c.wall_displacement.y, c.wall_displacement.z);
  }
}

void Recording::finish(const std::string& summary_json) {
  stats_.close();
  contacts_.close();
  write_bytes(options_.folder / "summary.json", summary_json + "\n");
}

}  // namespace dartcast
