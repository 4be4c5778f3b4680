// Writes the series and tables of bodies, catheters and solids.
#include "output/solids_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include "dartcast/catheter.hpp"
#include "dartcast/trajectory.hpp"
#include "formats/vtp_write.hpp"
#include "output/camera_path_file.hpp"
#include "output/frame_files.hpp"
#include "simulation/simulation_view.hpp"

namespace dartcast {

namespace {

constexpr std::string_view bodies_header = "step,time,name,x,y,z,kinetic,potential,matching,contacts";
constexpr std::string_view catheters_header =
    "step,time,name,inserted,turned,pushed,worst_segment,contacts,at_walls,held,tip_x,tip_y,tip_z";

constexpr std::string_view solids_header = "step,time,name,made,walls_made,contacts,pivot_x,pivot_y,pivot_z";
constexpr std::string_view solid_contacts_header =
    "step,time,name,kind,wall_kind,patch,cell,time_of_impact,gap,x,y,z,wall_x,wall_y,wall_z,normal_x,normal_y,normal_z";

const char* name_of(SolidContactKind kind) {
  switch (kind) {
    case SolidContactKind::vertex_face: return "vertex_face";
    case SolidContactKind::edge_edge: return "edge_edge";
    case SolidContactKind::face_vertex: return "face_vertex";
  }
  return "";
}

std::string series(std::string_view kind, const std::string& name) { return fmt::format("{}_{}", kind, name); }

// Whether contacts of edges and faces have a table.
bool lists_contacts(const Scene& scene) {
  const auto has_edges = [](const BodyScene& body) { return body.edges; };
  return scene.output.contacts && (!scene.solids.empty() || !scene.catheters.empty() ||
                                   std::any_of(scene.bodies.begin(), scene.bodies.end(), has_edges));
}

}  // namespace

SolidsRecording::SolidsRecording(const RunFolder& run, const Scene& scene)
    : Recorder(run), compression_(scene.output.compression.value_or(Compression::none)) {
  if (!scene.bodies.empty()) bodies_ = run.table("bodies.csv", bodies_header, &FilesProgress::bodies_bytes);
  if (!scene.catheters.empty())
    catheters_ = run.table("catheters.csv", catheters_header, &FilesProgress::catheters_bytes);
  if (!scene.solids.empty()) solids_ = run.table("solids.csv", solids_header, &FilesProgress::solids_bytes);
  if (lists_contacts(scene))
    solid_contacts_ = run.table("solid_contacts.csv", solid_contacts_header, &FilesProgress::solid_contacts_bytes);
}

void SolidsRecording::add_step(const Simulation& simulation, const SimulationStep& /*step*/, const StepSums& /*sums*/) {
  if (bodies_.is_open()) add_bodies(simulation);
  if (catheters_.is_open()) add_catheters(simulation);
  if (solids_.is_open()) add_solids(simulation);
  if (solid_contacts_.is_open()) add_solid_contacts(simulation);
}

void SolidsRecording::add_bodies(const Simulation& simulation) {
  const BodiesComponent& component = view_of(simulation).bodies;
  const Bodies& bodies = *component.bodies();
  const BodiesStep& last = simulation.bodies_step();
  std::vector<std::uint64_t> contacts(bodies.size());
  if (last.gone.empty()) {  // else its contacts' particles have other numbers now
    for (const Contact& c : last.motion.contacts.contacts) ++contacts[bodies.body_of()[c.particle]];
    for (const SolidContact& c : last.edges) ++contacts[c.solid];
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyEnergy energy = bodies.energy(b);
    const Vec3 centre = bodies.rigid_motion_of(b).centre;
    bodies_.print("{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(), simulation.time(), component.name(b), centre.x,
                  centre.y, centre.z, energy.kinetic, energy.potential, energy.matching, contacts[b]);
  }
  bodies_.send_many(writing_);
}

void SolidsRecording::add_catheters(const Simulation& simulation) {
  const CathetersComponent& component = view_of(simulation).catheters;
  for (std::size_t i = 0; i < component.catheters().size(); ++i) {
    const Catheter& c = component.catheters()[i];
    const CatheterStep& s = simulation.catheter_step(i);
    const Vec3 tip = c.particles()[0].position;
    catheters_.print("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(), simulation.time(),
                     component.scenes()[i].name, c.inserted(), c.turned(), s.pushed, s.worst_segment, s.contacts,
                     s.at_walls, s.held, tip.x, tip.y, tip.z);
  }
  catheters_.send_many(writing_);
}

void SolidsRecording::add_solids(const Simulation& simulation) {
  const SolidStep& last = simulation.solids_step();
  const std::vector<SolidSummary> now = simulation.solid_summaries();
  std::vector<std::uint64_t> contacts(now.size());
  for (const SolidContact& c : last.contacts) ++contacts[c.solid];
  for (const SolidMeeting& m : last.meetings) {
    ++contacts[m.solid];
    ++contacts[m.other];
  }
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3& p = now[i].pivot;
    solids_.print("{},{},{},{},{},{},{},{},{}\n", simulation.steps(), simulation.time(), now[i].name, last.made[i],
                  last.walls_made, contacts[i], p.x, p.y, p.z);
  }
  solids_.send_many(writing_);
}

// Those of tools with walls and with each other, then those of the surfaces of bodies, then those of catheters.
void SolidsRecording::add_solid_contacts(const Simulation& simulation) {
  for (const SolidContact& c : simulation.solids_step().contacts)
    add_solid_contact(simulation, view_of(simulation).solids.name(c.solid), c);
  for (const SolidMeeting& m : simulation.solids_step().meetings) add_meeting(simulation, m);
  const BodiesComponent& bodies = view_of(simulation).bodies;
  if (bodies.bodies() && bodies.last_step().gone.empty()) {
    for (const SolidContact& c : bodies.last_step().edges) add_solid_contact(simulation, bodies.name(c.solid), c);
  }
  for (std::size_t i = 0; i < simulation.catheter_count(); ++i) {
    for (const SolidContact& c : simulation.catheter(i).contacts())
      add_solid_contact(simulation, view_of(simulation).catheters.scenes()[i].name, c);
  }
  solid_contacts_.send_many(writing_);
}

void SolidsRecording::add_solid_contact(const Simulation& simulation, const std::string& name, const SolidContact& c) {
  const CombinatorialMap& map = simulation.environment().map();
  solid_contacts_.print("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(),
                        simulation.time(), name, name_of(c.kind), name_of(c.wall_kind),
                        map.patch_names()[c.patch.value], map.source(c.face.cell), c.time_of_impact, c.gap, c.point.x,
                        c.point.y, c.point.z, c.wall_point.x, c.wall_point.y, c.wall_point.z, c.normal.x, c.normal.y,
                        c.normal.z);
}

// In the place of the wall is the other tool, without a cell.
void SolidsRecording::add_meeting(const Simulation& simulation, const SolidMeeting& m) {
  const SolidsComponent& tools = view_of(simulation).solids;
  solid_contacts_.print("{},{},{},{},solid,{},,{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(),
                        simulation.time(), tools.name(m.solid), name_of(m.kind), tools.name(m.other), m.time_of_impact,
                        m.gap, m.point.x, m.point.y, m.point.z, m.other_point.x, m.other_point.y, m.other_point.z,
                        m.normal.x, m.normal.y, m.normal.z);
}

void SolidsRecording::add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) {
  const std::uint64_t step = frames.back().step;
  const BodiesComponent& bodies = view_of(simulation).bodies;
  for (std::size_t b = 0; bodies.bodies() && b < bodies.bodies()->size(); ++b) {
    write_body(simulation, b, step);
    write_series(series("body", bodies.name(b)), frames);
    if (bodies.skin(b)) write_series(series("surface", bodies.name(b)), frames);
  }
  for (std::size_t i = 0; i < simulation.catheter_count(); ++i) {
    const CatheterScene& scene = view_of(simulation).catheters.scenes()[i];
    write_catheter(simulation, i, step);
    write_series(series("catheter", scene.name), frames);
    if (scene.camera > 0.0) write_series(series("camera", scene.name), frames);
  }
  for (std::size_t i = 0; simulation.solids() != nullptr && i < simulation.solids()->size(); ++i) {
    write_solid(simulation, i, step);
    write_series(series("solid", view_of(simulation).solids.name(i)), frames);
  }
}

void SolidsRecording::write(const std::string& series, std::uint64_t step, const XmlDataSet& data) const {
  write_frame_file(writing_, folder_ / frame_name(series, step, ".vtp"), data, compression_);
}

void SolidsRecording::write_series(const std::string& series, std::span<const RecordingFrame> frames) const {
  write_list(writing_, folder_ / (series + ".pvd"), frames,
             [series](const RecordingFrame& frame) { return frame_name(series, frame.step, ".vtp"); });
}

void SolidsRecording::write_body(const Simulation& simulation, std::size_t body, std::uint64_t step) const {
  const BodiesComponent& component = view_of(simulation).bodies;
  const Bodies& bodies = *component.bodies();
  const std::size_t first = bodies.first_particle(body);
  const std::size_t count = bodies.particle_count(body);
  const std::span<const Vec3> positions = bodies.positions().subspan(first, count);
  const std::span<const Vec3> velocities = bodies.velocities().subspan(first, count);
  const std::span<const double> radii = bodies.radii().subspan(first, count);
  const CombinatorialMap& map = simulation.environment().map();
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0U);
  std::vector<std::uint32_t> cells;
  for (std::size_t i = 0; i < count; ++i) cells.push_back(map.source(bodies.particles()[first + i].cell));
  VtpFile points({positions.begin(), positions.end()});
  points.add_vertices();
  points.add("id", std::move(ids));
  points.add("velocity", std::vector<Vec3>(velocities.begin(), velocities.end()));
  points.add("cell", std::move(cells));
  points.add("radius", std::vector<double>(radii.begin(), radii.end()));
  write(series("body", component.name(body)), step, points.data());

  if (!component.skin(body)) return;
  const BodiesComponent::Skin& skin = *component.skin(body);
  VtpFile surface(component.surface_points(body));
  surface.add_polygons(skin.mesh.offsets, skin.mesh.connectivity);
  write(series("surface", component.name(body)), step, surface.data());
}

void SolidsRecording::write_catheter(const Simulation& simulation, std::size_t i, std::uint64_t step) const {
  const CatheterScene& scene = view_of(simulation).catheters.scenes()[i];
  const std::vector<Vec3> points = simulation.catheter(i).points();
  std::vector<Vec3> tangents;
  std::vector<Vec3> normals;
  for (const CatheterFrame& frame : simulation.catheter(i).frames()) {
    tangents.push_back(frame.tangent);
    normals.push_back(frame.normal);
  }
  VtpFile file(points);
  file.add_line();
  file.add("tangent", std::move(tangents));
  file.add("normal", std::move(normals));
  write(series("catheter", scene.name), step, file.data());
  if (scene.camera == 0.0) return;
  write(series("camera", scene.name), step, camera_path_data(view_of(simulation).catheters.camera_path(i)));
}

void SolidsRecording::write_solid(const Simulation& simulation, std::size_t i, std::uint64_t step) const {
  const SolidMesh& mesh = view_of(simulation).solids.mesh(i);
  VtpFile file(vertices_of(*simulation.solids(), i));
  if (mesh.triangles.empty()) {
    file.add_line();
  } else {
    std::vector<std::size_t> offsets = {0};
    std::vector<std::uint32_t> corners;
    for (const auto& t : mesh.triangles) {
      corners.insert(corners.end(), t.begin(), t.end());
      offsets.push_back(corners.size());
    }
    file.add_polygons(offsets, corners);
  }
  write(series("solid", view_of(simulation).solids.name(i)), step, file.data());
}

void SolidsRecording::save(FilesProgress& progress) {
  progress.bodies_bytes = bodies_.send(writing_);
  progress.catheters_bytes = catheters_.send(writing_);
  progress.solids_bytes = solids_.send(writing_);
  progress.solid_contacts_bytes = solid_contacts_.send(writing_);
}

}  // namespace dartcast
