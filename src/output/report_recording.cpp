// Records particles, walls, solids, contacts and events for the report.
#include "output/report_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "base/are_several.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/events.hpp"
#include "output/particle_kinds.hpp"
#include "output/wall_faces.hpp"
#include "report/recorded.hpp"
#include "simulation/gathered_step.hpp"
#include "simulation/simulation_view.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_particles = 20'000;
constexpr const char* file_name = "report.bin";

// The middle of the vertices at the start: floats around it are precise enough for a picture.
Vec3 middle_of(const Environment& environment) {
  const std::span<const Vec3> x = environment.positions();
  if (x.empty()) return {};
  Vec3 low = x.front();
  Vec3 high = low;
  for (const Vec3& p : x) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return 0.5 * low + 0.5 * high;
}

// Ids are given in the order of coming, so the greatest one says how many there have been.
std::uint64_t ids_so_far(const Simulation& simulation) {
  const SimulationTotals& t = simulation.totals();
  return t.start + t.injected;
}

struct ReportedParticle {
  std::uint64_t id;
  RecordedPoint position;
  float speed;
  float radius;
  Kind kind;
};

// The particles of this rank.
std::vector<ReportedParticle> own_particles(const Simulation& simulation, const ReportView& view) {
  const Particles& particles = simulation.particles();
  const CellComplex& complex = simulation.environment().complex();
  std::vector<ReportedParticle> found;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::uint64_t id = simulation.ids()[i];
    if (id % view.stride != 0) continue;
    found.push_back({id, recorded(particles[i].position, view.header),
                     static_cast<float>(norm(simulation.velocities()[i])), static_cast<float>(simulation.radii()[i]),
                     kind_of(complex, particles[i])});
  }
  return found;
}

ReportView view_of_all(const ReportView& view, Ranks* ranks) {
  if (!are_several(ranks)) return view;
  ByteWriter bytes;
  bytes.put(view);
  return ByteReader(ranks->broadcast(bytes.bytes())).take<ReportView>();
}

std::vector<RecordedPoint> recorded(std::span<const Vec3> points, const RecordedHeader& header) {
  std::vector<RecordedPoint> out;
  out.reserve(points.size());
  for (const Vec3& p : points) out.push_back(recorded(p, header));
  return out;
}

// A body's skin as triangles if it has one, else its particles.
RecordedSolid recorded_body(const Simulation& simulation, std::size_t b, const RecordedHeader& header) {
  const BodiesComponent& component = view_of(simulation).bodies;
  const Bodies& bodies = *component.bodies();
  const std::size_t count = bodies.particle_count(b);
  const std::span<const Vec3> positions = bodies.positions().subspan(bodies.first_particle(b), count);
  const std::span<const double> radii = bodies.radii().subspan(bodies.first_particle(b), count);
  RecordedSolid solid{component.name(b), SolidKind::body, 0.0F, {}, {}};
  if (!radii.empty()) solid.radius = static_cast<float>(radii.front());
  if (!component.skin(b)) {
    solid.points = recorded(positions, header);
    return solid;
  }
  const BodiesComponent::Skin& skin = *component.skin(b);
  solid.points = recorded(component.surface_points(b), header);
  for (std::size_t f = 0; f + 1 < skin.mesh.offsets.size(); ++f) {
    const std::size_t first = skin.mesh.offsets[f];
    for (std::size_t k = first + 2; k < skin.mesh.offsets[f + 1]; ++k) {
      for (const std::size_t corner : {first, k - 1, k})
        solid.triangles.push_back(static_cast<std::uint32_t>(skin.mesh.connectivity[corner]));
    }
  }
  return solid;
}

std::vector<RecordedSolid> recorded_solids(const Simulation& simulation, const RecordedHeader& header) {
  std::vector<RecordedSolid> solids;
  const BodiesComponent& bodies = view_of(simulation).bodies;
  for (std::size_t b = 0; bodies.bodies() && b < bodies.bodies()->size(); ++b)
    solids.push_back(recorded_body(simulation, b, header));
  for (std::size_t i = 0; i < simulation.catheter_count(); ++i) {
    const CatheterScene& scene = view_of(simulation).catheters.scenes()[i];
    solids.push_back({scene.name, SolidKind::catheter, 0.0F, {}, recorded(simulation.catheter(i).points(), header)});
  }
  const SolidSet* tools = simulation.solids();
  for (std::size_t i = 0; tools != nullptr && i < tools->size(); ++i) {
    const SolidMesh& mesh = view_of(simulation).solids.mesh(i);
    RecordedSolid solid{view_of(simulation).solids.name(i), SolidKind::body, 0.0F, {}, {}};
    if (mesh.triangles.empty()) solid.kind = SolidKind::catheter;
    solid.points = recorded(vertices_of(*tools, i), header);
    for (const auto& t : mesh.triangles) solid.triangles.insert(solid.triangles.end(), t.begin(), t.end());
    solids.push_back(std::move(solid));
  }
  return solids;
}

std::string text_of(const EventReport& e) {
  if (!e.refused.empty()) return fmt::format("{}: refused: {}", name_of(e.kind), e.refused);
  return fmt::format("{}: {} cells replaced by {}, {} opened, {} blocked", name_of(e.kind), e.cells_removed,
                     e.cells_added, e.cells_opened, e.cells_blocked);
}

}  // namespace

ReportRecording::ReportRecording(const RunFolder& run, std::uint64_t every, const Simulation& simulation, bool goes_on)
    : Recorder(run),
      simulation_(simulation),
      file_(run.table(file_name, recorded_line, &FilesProgress::report_bytes)),
      counts_hits_(!simulation.statistics_options().hits),
      counted_(simulation.steps()) {
  if (run.before != nullptr) {
    restore(folder_ / file_name, simulation, goes_on);
    return;
  }
  header_.dimension = simulation.environment().map().dimension();
  header_.every = every;
  header_.origin = middle_of(simulation.environment());
  file_.append(chunk_of(header_));
  add_arrivals(simulation, simulation.time());
}

// If the run goes on, a last frame off the schedule is cut off, and so are walls that came with it. Its hits count.
void ReportRecording::restore(const fs::path& path, const Simulation& simulation, bool goes_on) {
  const RecordedFile file(path);
  header_ = file.header();
  ids_ = ids_so_far(simulation);
  events_ = simulation.event_log().events.size();
  auto chunks = file.chunks();
  const auto last = [&](std::string_view tag) {
    return std::find_if(chunks.rbegin(), chunks.rend(), [&](const auto& c) { return c.tag == tag; });
  };
  if (last(RecordedFrame::tag) == chunks.rend() || last(RecordedWalls::tag) == chunks.rend()) return;
  const auto frame = file.read<RecordedFrame>(*last(RecordedFrame::tag));
  has_walls_ = true;
  if (goes_on && frame.step % std::max<std::uint64_t>(header_.every, 1) != 0) {
    chunks.pop_back();
    has_walls_ = chunks.back().tag != RecordedWalls::tag;
    if (!has_walls_) chunks.pop_back();
    file_ = RunTable(path, chunks.back().at + chunks.back().size);
  }
  if (const auto shown = last(RecordedFrame::tag); shown != chunks.rend())
    stride_ = file.read<RecordedFrame>(*shown).stride;
  WallFaceList walls = wall_face_list(simulation.environment().map());
  faces_ = std::move(walls.faces);
  wall_vertices_ = std::move(walls.vertices);
  edits_ = simulation.environment().edit_count();
  if (has_walls_) wall_points_ = file.read<RecordedWalls>(*last(RecordedWalls::tag)).points;
  if (counts_hits_) restore_hits(simulation, frame);
}

// The walls of a map are listed in one order, so that the hits of the last frame find their faces again.
void ReportRecording::restore_hits(const Simulation& simulation, const RecordedFrame& frame) {
  if (frame.hits.size() != faces_.size()) return;
  std::vector<FaceHits> hits;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (frame.hits[f] > 0) hits.push_back({faces_[f], simulation.environment().map().patch(faces_[f]), frame.hits[f]});
  }
  own_hits_.restore(simulation.environment(), hits, {});
}

const WallHits& ReportRecording::hits(const Simulation& simulation) const {
  return counts_hits_ ? own_hits_ : simulation.statistics().hits;
}

// The contacts of a step are with the walls before the edits that follow it.
void ReportRecording::count_hits() {
  if (!counts_hits_ || counted_ == simulation_.steps()) return;
  counted_ = simulation_.steps();
  own_hits_.add(simulation_.environment(), view_of(simulation_).particles.last_step().report.contacts);
}

void ReportRecording::update_after_edit(const Environment& environment) {
  count_hits();
  if (counts_hits_) own_hits_.update_after_edit(environment);
}

void ReportRecording::add_arrivals(const Simulation& simulation, double time) {
  if (ids_so_far(simulation) == ids_) return;
  ids_ = ids_so_far(simulation);
  file_.append(chunk_of(RecordedArrivals{time, ids_}));
}

void ReportRecording::add_step(const Simulation& simulation, const SimulationStep& step, const StepSums& /*sums*/) {
  add_arrivals(simulation, simulation.time() - step.duration);
  const EventLog& log = simulation.event_log();
  for (; events_ < log.events.size(); ++events_) {
    const EventReport& e = log.events[events_];
    file_.append(chunk_of(RecordedEvent{e.step, e.time, text_of(e)}));
  }
  const ContactList& list = step.report.contacts;
  count_hits();
  RecordedContacts kept;
  for (std::size_t i = 0; i < step.contact_ids.size(); ++i) {
    if (step.contact_ids[i] % stride_ != 0) continue;
    const Contact& c = list.contacts[i];
    kept.contacts.push_back({step.contact_ids[i], simulation.time() - step.duration * (1.0 - c.time_of_impact),
                             recorded(c.point, header_), list.walls_of(c).front().patch.value,
                             static_cast<std::uint8_t>(c.kind), 0});
  }
  if (!kept.contacts.empty()) file_.append(chunk_of(kept));
  file_.send_many(writing_);
}

void ReportRecording::add_walls(const Simulation& simulation) {
  const CombinatorialMap& map = simulation.environment().map();
  WallFaceList walls = wall_face_list(map);
  wall_vertices_ = std::move(walls.vertices);
  wall_points_ = wall_points(simulation.environment());
  RecordedWalls chunk;
  chunk.points = wall_points_;
  chunk.corners = std::move(walls.corners);
  chunk.offsets.assign(walls.offsets.begin(), walls.offsets.end());
  for (const CellFace f : walls.faces) chunk.patches.push_back(map.patch(f).value);
  chunk.patch_names = map.patch_names();
  file_.append(chunk_of(chunk));
  faces_ = std::move(walls.faces);
  edits_ = simulation.environment().edit_count();
  has_walls_ = true;
}

std::vector<RecordedPoint> ReportRecording::wall_points(const Environment& environment) const {
  std::vector<RecordedPoint> points;
  points.reserve(wall_vertices_.size());
  for (const Vertex v : wall_vertices_) points.push_back(recorded(environment.positions()[v.value], header_));
  return points;
}

ReportView ReportRecording::next_view(const Simulation& simulation) {
  while (ids_so_far(simulation) / stride_ > most_particles) stride_ *= 2;
  return {header_, stride_};
}

void ReportRecording::add_frame(const Simulation& simulation, std::span<const RecordingFrame> /*frames*/) {
  RecordedFrame frame = reported_particles(simulation, next_view(simulation));
  const Environment& environment = simulation.environment();
  if (!has_walls_ || edits_ != environment.edit_count()) add_walls(simulation);
  frame.stride = stride_;
  frame.all = ids_so_far(simulation);
  frame.step = simulation.steps();
  frame.time = simulation.time();
  frame.wall_points = wall_points(environment);
  if (frame.wall_points == wall_points_) frame.wall_points.clear();
  for (const CellFace f : faces_)
    frame.hits.push_back(static_cast<std::uint32_t>(std::min<std::uint64_t>(hits(simulation).of(f), UINT32_MAX)));
  frame.solids = recorded_solids(simulation, header_);
  file_.append(chunk_of(frame));
}

RecordedFrame reported_particles(const Simulation& simulation, const ReportView& view) {
  Ranks* const ranks = simulation.options().ranks;
  RecordedFrame frame;
  const auto particles = gathered_by_id(ranks, own_particles(simulation, view_of_all(view, ranks)));
  const bool has_radii =
      std::any_of(particles.begin(), particles.end(), [](const ReportedParticle& p) { return p.radius > 0.0F; });
  for (const ReportedParticle& p : particles) {
    frame.ids.push_back(p.id);
    frame.positions.push_back(p.position);
    frame.speeds.push_back(p.speed);
    frame.kinds.push_back(static_cast<std::uint8_t>(p.kind));
    if (has_radii) frame.radii.push_back(p.radius);
  }
  return frame;
}

void ReportRecording::save(FilesProgress& progress) { progress.report_bytes = file_.send(writing_); }

}  // namespace dartcast
