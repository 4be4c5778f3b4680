#include "dartcast/io/recording.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "dartcast/base/error.hpp"
#include "dartcast/geometry/complex_mesh.hpp"
#include "dartcast/io/vtk_errors.hpp"
#include "dartcast/io/vtk_mesh.hpp"
#include "dartcast/io/write_mesh.hpp"
#include "dartcast/walk/state.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view stats_header =
    "step,time,alive,injected,absorbed,escaped,held,contacts,orientation_tests,exact_tests,forecast_kept,updated_by_"
    "deformation";
constexpr std::string_view contacts_header =
    "step,time,id,kind,patch,cell,x,y,z,normal_x,normal_y,normal_z,wall_dx,wall_dy,wall_dz";

// Whether a file is one that a run writes: by its name.
bool is_ours(const std::string& name) {
  static constexpr std::string_view fixed[] = {"summary.json",    "stats.csv",    "particles.pvd", "environment.pvd",
                                               "environment.vtu", "contacts.csv", "scene.toml",    "checkpoint.bin"};
  if (std::find(std::begin(fixed), std::end(fixed), name) != std::end(fixed)) return true;
  for (const auto& [start, end] :
       {std::pair<std::string_view, std::string_view>{"particles_", ".vtp"}, {"environment_", ".vtu"}}) {
    if (name.size() < start.size() + 6 + end.size() || name.compare(0, start.size(), start) != 0) continue;
    const std::size_t digits = name.size() - start.size() - end.size();
    if (name.substr(start.size() + digits) != end) continue;
    if (name.substr(start.size(), digits).find_first_not_of("0123456789") == std::string::npos) return true;
  }
  return false;
}

// An earlier run left a table of steps with our header.
bool holds_a_run(const fs::path& folder) {
  std::ifstream file(folder / "stats.csv");
  std::string line;
  return std::getline(file, line) && line.starts_with(stats_header);
}

std::string particles_name(std::uint64_t step) { return fmt::format("particles_{:06}.vtp", step); }
std::string environment_name(std::uint64_t step) { return fmt::format("environment_{:06}.vtu", step); }

// A collection for ParaView: a file per frame.
template <class Name>
void write_pvd(const fs::path& path, std::span<const RecordingFrame> frames, Name&& name) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n <Collection>\n";
  for (const RecordingFrame& frame : frames) {
    text += fmt::format("  <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", frame.time, name(frame.step));
  }
  write_bytes(path, text + " </Collection>\n</VTKFile>\n");
}

std::ofstream open_table(const fs::path& path, std::string_view header) {
  std::ofstream table(path, std::ios::binary);
  fmt::print(table, "{}\n", header);
  if (!table)
    throw Error(fmt::format("{}: the file cannot be written; check the folder and its permissions", path.string()));
  return table;
}

// Opens a table to write on behind its first `bytes` bytes.
std::ofstream reopen_table(const fs::path& path, std::uint64_t bytes) {
  std::error_code error;
  if (fs::file_size(path, error) < bytes || error)
    throw Error(
        fmt::format("{}: the file is shorter than when the checkpoint was made; run without --resume", path.string()));
  fs::resize_file(path, bytes, error);
  std::ofstream table(path, std::ios::binary | std::ios::app);
  if (error || !table)
    throw Error(fmt::format("{}: the file cannot be written; check the folder and its permissions", path.string()));
  return table;
}

// Sends a table to its file; its length then.
std::uint64_t written(std::ofstream& table) {
  return table.is_open() ? static_cast<std::uint64_t>(table.flush().tellp()) : 0;
}

void close_table(std::ofstream& table, const char* name, const fs::path& folder) {
  if (!table.is_open()) return;
  table.close();
  if (!table)
    throw Error(
        fmt::format("{}: the file could not be written to the end; check the disk's space", (folder / name).string()));
}

// An array of doubles with `components` per particle, filled by value(i, k).
template <class Value>
void add_array(vtkPolyData& data, const char* name, int components, std::size_t count, Value&& value) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  double* out = array->GetPointer(0);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < components; ++k) *out++ = value(i, k);
  }
  data.GetPointData()->AddArray(array);
}

double component(const Vec3& v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }

Kind kind_of(const Complex& complex, const State& s) {
  return s.held ? Kind::volume : forecast(complex.map(), s, complex.corners(s.at())).kind;
}

}  // namespace

void check_output_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw Error(fmt::format("{}: this is a file; name a folder for the output with -o", folder.string()));
  }
  if (fs::is_empty(folder) || holds_a_run(folder)) return;
  throw Error(fmt::format("{}: the folder holds other files than a run's; name another with -o", folder.string()));
}

Recording::Recording(Options options, const MeshData& mesh, const std::string& scene_text)
    : options_(std::move(options)) {
  const fs::path& folder = options_.folder;
  check_output_folder(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_ours(entry.path().filename().string())) fs::remove(entry.path());
  }
  stats_ = open_table(folder / "stats.csv", std::string(stats_header) + (options_.surgery ? ",in_opened" : ""));
  if (options_.contacts) contacts_ = open_table(folder / "contacts.csv", contacts_header);
  if (!scene_text.empty()) write_bytes(folder / "scene.toml", scene_text);
  keep_cells(mesh);
  if (!options_.changes) write_environment(mesh.points, "environment.vtu");
}

Recording::Recording(Options options, const MeshData& mesh, const RecordingProgress& progress)
    : options_(std::move(options)), frames_(progress.frames) {
  stats_ = reopen_table(options_.folder / "stats.csv", progress.stats_bytes);
  if (options_.contacts) contacts_ = reopen_table(options_.folder / "contacts.csv", progress.contacts_bytes);
  keep_cells(mesh);
  std::set<std::string> kept = {"environment.vtu"};
  for (const RecordingFrame& frame : frames_) kept.insert({particles_name(frame.step), environment_name(frame.step)});
  for (const auto& entry : fs::directory_iterator(options_.folder)) {
    const std::string name = entry.path().filename().string();
    const bool frame = entry.path().extension() == ".vtp" || entry.path().extension() == ".vtu";
    if (frame && is_ours(name) && !kept.contains(name)) fs::remove(entry.path());
  }
}

void Recording::keep_cells(const MeshData& mesh) {
  mesh_.types = mesh.types;
  mesh_.offsets = mesh.offsets;
  mesh_.connectivity = mesh.connectivity;
  mesh_.regions = mesh.regions;
  mesh_.region_names = mesh.region_names;
  mesh_.free = mesh.free;
}

void Recording::write_environment(std::span<const Vec3> points, const std::string& name) {
  mesh_.points.assign(points.begin(), points.end());
  write_vtu(mesh_, options_.folder / name);
}

// Cells are others than in the file: they keep its regions.
void Recording::write_edited(const Complex& complex, const std::string& name) const {
  MeshData mesh = to_mesh(complex);
  mesh.region_names = mesh_.region_names;
  if (!mesh_.regions.empty()) {
    for (const std::uint32_t source : mesh.source) mesh.regions.push_back(mesh_.regions[source]);
  }
  write_vtu(mesh, options_.folder / name);
}

void Recording::add_frame(const Flow& flow) {
  write_particles(flow, options_.folder / particles_name(flow.steps()));
  if (options_.changes) {
    const std::string name = environment_name(flow.steps());
    if (flow.environment().edit_count() > 0) {
      write_edited(flow.environment().complex(), name);
    } else {
      write_environment(flow.environment().positions(), name);
    }
  }
  if (frames_.empty() || frames_.back().step != flow.steps()) frames_.push_back({flow.steps(), flow.time()});
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

RecordingProgress Recording::progress() { return {written(stats_), written(contacts_), frames_}; }

void Recording::write_particles(const Flow& flow, const fs::path& path) const {
  const Particles& particles = flow.particles();
  const Complex& complex = flow.environment().complex();
  const std::size_t count = particles.size();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(count));
  vtkNew<vtkCellArray> vertices;
  for (std::size_t i = 0; i < count; ++i) {
    const auto id = static_cast<vtkIdType>(i);
    points->SetPoint(id, particles[i].position.x, particles[i].position.y, particles[i].position.z);
    vertices->InsertNextCell(1, &id);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(vertices);
  add_array(*data, "id", 1, count, [&](std::size_t i, int) { return static_cast<double>(flow.ids()[i]); });
  add_array(*data, "velocity", 3, count, [&](std::size_t i, int k) { return component(flow.velocities()[i], k); });
  add_array(*data, "cell", 1, count,
            [&](std::size_t i, int) { return static_cast<double>(complex.map().source(particles[i].cell)); });
  add_array(*data, "kind", 1, count,
            [&](std::size_t i, int) { return static_cast<double>(kind_of(complex, particles[i])); });
  add_array(*data, "contacts", 1, count,
            [&](std::size_t i, int) { return static_cast<double>(flow.contact_counts()[i]); });
  const VtkErrors errors;
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(data);
  writer->EncodeAppendedDataOff();
  if (writer->Write() != 1 || writer->GetErrorCode() != 0 || !errors.first().empty()) {
    throw Error(fmt::format("{}: the file cannot be written; check the folder and the disk's space", path.string()));
  }
}

void Recording::add_step(const Flow& flow, const FlowStep& step, std::uint64_t in_opened) {
  const Counters& c = step.report.counters;
  fmt::print(stats_, "{},{},{},{},{},{},{},{},{},{},{},{}", flow.steps(), flow.time(), flow.particles().size(),
             step.injected, step.absorbed, step.escaped, step.report.held.size(), step.report.contacts.contacts.size(),
             c.orientation.tests, c.orientation.exact, c.forecast_kept, c.updated_by_deformation);
  if (options_.surgery) fmt::print(stats_, ",{}", in_opened);
  fmt::print(stats_, "\n");
  if (options_.contacts) write_contacts(flow, step);
  if (!stats_)
    throw Error(fmt::format("{}: the table cannot be written; check the disk's space",
                            (options_.folder / "stats.csv").string()));
}

void Recording::write_contacts(const Flow& flow, const FlowStep& step) {
  static constexpr std::string_view kinds[] = {"vertex", "edge", "face", "volume"};
  const Map& map = flow.environment().map();
  const double dt = step.duration;
  for (std::size_t i = 0; i < step.contact_ids.size(); ++i) {
    const Contact& c = step.report.contacts.contacts[i];
    const WallHit& wall = step.report.contacts.walls_of(c).front();
    fmt::print(contacts_, "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", flow.steps(),
               flow.time() - dt * (1.0 - c.time_of_impact), step.contact_ids[i],
               kinds[static_cast<std::size_t>(c.kind)], map.patch_names()[wall.patch.value], map.source(wall.face.cell),
               c.point.x, c.point.y, c.point.z, wall.normal.x, wall.normal.y, wall.normal.z, c.wall_displacement.x,
               c.wall_displacement.y, c.wall_displacement.z);
  }
}

void Recording::finish(const std::string& summary_json) {
  close_table(stats_, "stats.csv", options_.folder);
  close_table(contacts_, "contacts.csv", options_.folder);
  write_bytes(options_.folder / "summary.json", summary_json + "\n");
}

}  // namespace dartcast
