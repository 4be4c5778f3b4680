// Writes the series and tables of bodies and catheters.
#include "output/solids_recording.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <string>
#include <string_view>
#include <utility>

#include "dartcast/catheter.hpp"
#include "formats/vtp_write.hpp"
#include "output/camera_path_file.hpp"
#include "simulation/simulation_parts.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view bodies_header = "step,time,name,x,y,z,kinetic,potential,matching,contacts";
constexpr std::string_view catheters_header =
    "step,time,name,inserted,turned,pushed,worst_segment,contacts,at_walls,held,tip_x,tip_y,tip_z";

std::string series(std::string_view kind, const std::string& name) { return fmt::format("{}_{}", kind, name); }

void write_series(const fs::path& folder, const std::string& series, std::span<const RecordingFrame> frames) {
  write_pvd(folder / (series + ".pvd"), frames, [&](std::uint64_t step) { return frame_name(series, step, ".vtp"); });
}

// Where nothing is inserted: the list names a file for each frame.
void write_no_camera(const fs::path& path) {
  VtpWriter none(0, [](std::size_t) { return Vec3(); });
  none.add_line();
  none.write(path);
}

}  // namespace

SolidsRecording::SolidsRecording(fs::path folder, const Scene& scene) : folder_(std::move(folder)) {
  if (!scene.bodies.empty()) bodies_ = RunTable(folder_ / "bodies.csv", bodies_header);
  if (!scene.catheters.empty()) catheters_ = RunTable(folder_ / "catheters.csv", catheters_header);
}

SolidsRecording::SolidsRecording(fs::path folder, const Scene& scene, const SolidsProgress& progress)
    : folder_(std::move(folder)) {
  if (!scene.bodies.empty()) bodies_ = RunTable(folder_ / "bodies.csv", progress.bodies_bytes);
  if (!scene.catheters.empty()) catheters_ = RunTable(folder_ / "catheters.csv", progress.catheters_bytes);
}

void SolidsRecording::add_step(const Simulation& simulation) {
  if (bodies_.is_open()) add_bodies(simulation);
  if (catheters_.is_open()) add_catheters(simulation);
}

void SolidsRecording::add_bodies(const Simulation& simulation) {
  const BodiesComponent& component = simulation.parts().bodies;
  const Bodies& bodies = *component.bodies();
  const BodiesStep& last = simulation.bodies_step();
  std::vector<std::uint64_t> contacts(bodies.size());
  if (last.gone.empty()) {  // else its contacts' particles have other numbers now
    for (const Contact& c : last.motion.contacts.contacts) ++contacts[bodies.body_of()[c.particle]];
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyEnergy energy = bodies.energy(b);
    const Vec3 centre = bodies.rigid_motion_of(b).centre;
    fmt::print(bodies_.stream(), "{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(), simulation.time(),
               component.name(b), centre.x, centre.y, centre.z, energy.kinetic, energy.potential, energy.matching,
               contacts[b]);
  }
  bodies_.check();
}

void SolidsRecording::add_catheters(const Simulation& simulation) {
  const CathetersComponent& component = simulation.parts().catheters;
  for (std::size_t i = 0; i < component.catheters().size(); ++i) {
    const Catheter& c = component.catheters()[i];
    const CatheterStep& s = simulation.catheter_step(i);
    const Vec3 tip = c.particles()[0].position;
    fmt::print(catheters_.stream(), "{},{},{},{},{},{},{},{},{},{},{},{},{}\n", simulation.steps(), simulation.time(),
               component.scenes()[i].name, c.inserted(), c.turned(), s.pushed, s.worst_segment, s.contacts, s.at_walls,
               s.held, tip.x, tip.y, tip.z);
  }
  catheters_.check();
}

void SolidsRecording::add_frame(const Simulation& simulation, std::span<const RecordingFrame> frames) {
  const std::uint64_t step = frames.back().step;
  const BodiesComponent& bodies = simulation.parts().bodies;
  for (std::size_t b = 0; bodies.bodies() && b < bodies.bodies()->size(); ++b) {
    write_body(simulation, b, step);
    write_series(folder_, series("body", bodies.name(b)), frames);
    if (bodies.skin(b)) write_series(folder_, series("surface", bodies.name(b)), frames);
  }
  for (std::size_t i = 0; i < simulation.catheter_count(); ++i) {
    const CatheterScene& scene = simulation.parts().catheters.scenes()[i];
    write_catheter(simulation, i, step);
    write_series(folder_, series("catheter", scene.name), frames);
    if (scene.camera > 0.0) write_series(folder_, series("camera", scene.name), frames);
  }
}

void SolidsRecording::write_body(const Simulation& simulation, std::size_t body, std::uint64_t step) const {
  const BodiesComponent& component = simulation.parts().bodies;
  const Bodies& bodies = *component.bodies();
  const std::size_t first = bodies.first_particle(body);
  const std::span<const Vec3> positions = bodies.positions().subspan(first, bodies.particle_count(body));
  VtpWriter points(positions.size(), [&](std::size_t i) { return positions[i]; });
  points.add_vertices();
  points.add("id", [](std::size_t i) { return static_cast<double>(i); });
  points.add_vectors("velocity", [&](std::size_t i) { return bodies.velocities()[first + i]; });
  const CombinatorialMap& map = simulation.environment().map();
  points.add("cell",
             [&](std::size_t i) { return static_cast<double>(map.source(bodies.particles()[first + i].cell)); });
  points.add("radius", [&](std::size_t i) { return bodies.radii()[first + i]; });
  points.write(folder_ / frame_name(series("body", component.name(body)), step, ".vtp"));

  if (!component.skin(body)) return;
  const BodiesComponent::Skin& skin = *component.skin(body);
  std::vector<Vec3> vertices(skin.mesh.points.size());
  skin.carried.positions(positions, vertices, simulation.environment().threads());
  VtpWriter surface(vertices.size(), [&](std::size_t i) { return vertices[i]; });
  surface.add_polygons(skin.mesh.offsets, skin.mesh.connectivity);
  surface.write(folder_ / frame_name(series("surface", component.name(body)), step, ".vtp"));
}

void SolidsRecording::write_catheter(const Simulation& simulation, std::size_t i, std::uint64_t step) const {
  const CatheterScene& scene = simulation.parts().catheters.scenes()[i];
  const std::vector<Vec3> points = simulation.catheter(i).points();
  const std::vector<CatheterFrame> frames = simulation.catheter(i).frames();
  VtpWriter file(points.size(), [&](std::size_t k) { return points[k]; });
  file.add_line();
  file.add_vectors("tangent", [&](std::size_t k) { return frames[k].tangent; });
  file.add_vectors("normal", [&](std::size_t k) { return frames[k].normal; });
  file.write(folder_ / frame_name(series("catheter", scene.name), step, ".vtp"));
  if (scene.camera == 0.0) return;
  const fs::path camera = folder_ / frame_name(series("camera", scene.name), step, ".vtp");
  if (points.size() < 2) return write_no_camera(camera);
  const std::vector<Vec3> inwards(points.rbegin(), points.rend());
  write_camera_path(camera_path(simulation.parts().environment, inwards, {.spacing = scene.camera}), camera);
}

void SolidsRecording::finish() {
  bodies_.close();
  catheters_.close();
}

}  // namespace dartcast
