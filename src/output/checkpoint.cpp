// The layout of checkpoint.bin and of the parts of other ranks, and their digests.
#include "output/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "base/digest.hpp"
#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast {

namespace {

constexpr std::uint64_t magic = 0x38706b6374726164U;       // "dartckp8" on a machine of this byte order
constexpr std::uint64_t part_magic = 0x31747270746b6364U;  // "dcktprt1"

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// A file is a sequence of plain values. Writer and CheckpointReader go through the same list of them, below.
class CheckpointWriter {
 public:
  template <class T>
  void value(T& v) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    text_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void count(std::uint64_t& n) { value(n); }
  template <class T, class Each>
  void list(std::vector<T>& values, Each&& each) {
    std::uint64_t size = values.size();
    count(size);
    for (T& v : values) each(v);
  }
  void characters(std::string& s) {
    std::uint64_t size = s.size();
    count(size);
    text_ += s;
  }
  // Whether there is a last part, which is left out if nothing is in it.
  static bool has_more(bool filled) { return filled; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

class CheckpointReader {
 public:
  explicit CheckpointReader(std::string_view text) : text_(text) {}

  template <class T>
  void value(T& v) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    need(sizeof v);
    std::memcpy(&v, text_.data(), sizeof v);
    text_.remove_prefix(sizeof v);
  }
  void count(std::uint64_t& n) {
    value(n);
    need(n);  // every entry takes a byte at least
  }
  template <class T, class Each>
  void list(std::vector<T>& values, Each&& each) {
    std::uint64_t size = 0;
    count(size);
    values.assign(size, T{});
    for (T& v : values) each(v);
  }
  void characters(std::string& s) {
    std::uint64_t size = 0;
    count(size);
    s = text_.substr(0, size);
    text_.remove_prefix(size);
  }
  [[nodiscard]] bool has_more(bool /*filled*/) const { return !at_end(); }
  [[nodiscard]] bool at_end() const { return text_.empty(); }

 private:
  void need(std::uint64_t bytes) const {
    if (bytes > text_.size()) throw Error("it ends too early");
  }

  std::string_view text_;
};

template <class Archive, class... Values>
void values(Archive& a, Values&... v) {
  (a.value(v), ...);
}

// A value that is kept as another type.
template <class As, class Archive, class T>
void value_as(Archive& a, T& v) {
  As as = static_cast<As>(v);
  a.value(as);
  v = static_cast<T>(as);
}

template <class Archive>
void fields(Archive& a, RunIdentity& r) {
  a.characters(r.version);
  values(a, r.scene, r.mesh, r.seed);
}

template <class Archive>
void fields(Archive& a, Vec3& v) {
  values(a, v.x, v.y, v.z);
}

template <class Archive>
void fields(Archive& a, ParticleState& s) {
  fields(a, s.position);
  values(a, s.cell.value, s.simplex, s.touching_count);
  value_as<std::uint8_t>(a, s.held);
  for (CellFace& f : s.touching) values(a, f.cell.value, f.face);
}

template <class Archive>
void fields(Archive& a, Weights& weights) {
  for (double& w : weights) a.value(w);
}

// All but the user data.
template <class Archive>
void fields(Archive& a, SavedParticles& p) {
  std::uint64_t rows = p.rows();
  a.count(rows);
  p.append_zeros(rows - p.rows());
  for (std::size_t i = 0; i < rows; ++i) {
    a.value(p[p.id][i]);
    fields(a, p[p.state][i]);
    fields(a, p[p.held_weights][i]);
    fields(a, p[p.velocity][i]);
    value_as<std::uint8_t>(a, p[p.fate][i]);
    values(a, p[p.contact_count][i], p[p.radius][i], p[p.diameter][i], p[p.density][i], p[p.charge_per_mass][i]);
    if (p[p.fate][i] > ParticleStatus::escaped) throw Error("a particle has an unknown status");
  }
}

// How much a particle has is seen from all of it.
template <class Archive>
void user_data(Archive& a, SavedParticles& p) {
  std::vector<double> numbers(p[p.user_data].begin(), p[p.user_data].end());
  a.list(numbers, [&](double& d) { a.value(d); });
  if (p.rows() > 0) p.set_width(p.user_data, numbers.size() / p.rows());
  if (p[p.user_data].size() != numbers.size()) throw Error("its particles do not have the same amount of user data");
  std::copy(numbers.begin(), numbers.end(), p[p.user_data].begin());
}

template <class Archive>
void fields(Archive& a, Counters& c) {
  values(a, c.particle_steps, c.orientation.tests, c.orientation.exact);
  for (std::uint64_t& n : c.histogram) a.value(n);
  values(a, c.forecast_kept, c.updated_by_deformation, c.steps_split);
  for (std::uint64_t& n : c.contacts) a.value(n);
  a.value(c.unfinished);
}

template <class Archive>
void fields(Archive& a, CollisionCounts& c) {
  values(a, c.pairs_tested, c.pairs_near, c.pairs_touching, c.walls_touching, c.overlaps, c.deepest);
}

template <class Archive>
void fields(Archive& a, CachedImpulse& k) {
  values(a, k.a, k.b);
  fields(a, k.normal);
  a.value(k.normal_impulse);
  fields(a, k.tangent_impulse);
}

template <class Archive>
void fields(Archive& a, SimulationTotals& t) {
  values(a, t.start, t.injected, t.absorbed, t.escaped);
  fields(a, t.counters);
  fields(a, t.collisions);
  values(a, t.wall_overlaps, t.deepest_in_wall);
  for (auto* counts : {&t.contacts_by_patch, &t.deposited_by_patch, &t.escaped_by_patch})
    a.list(*counts, [&](std::uint64_t& n) { a.value(n); });
  values(a, t.seconds_detect, t.seconds_deform, t.seconds_collide, t.seconds_respond);
}

template <class Archive>
void fields(Archive& a, EventReport& e) {
  value_as<std::uint32_t>(a, e.kind);
  values(a, e.step, e.time, e.cells_removed, e.cells_added, e.cells_opened, e.cells_blocked, e.cells_whole,
         e.particles_in_opened, e.particles_touched, e.particles_located, e.particles_moved, e.particles_held,
         e.particles_absorbed, e.boundary_shift, e.seconds);
  a.characters(e.refused);
  if (name_of(e.kind).empty()) throw Error("an event has an unknown kind");
}

template <class Archive>
void fields(Archive& a, EventLog& log) {
  a.list(log.changes, [&](EventLog::Change& c) { values(a, c.step, c.event, c.what); });
  a.list(log.events, [&](EventReport& e) { fields(a, e); });
  values(a, log.mended, log.left, log.subdivided, log.merged, log.refused, log.in_opened);
}

template <class Archive>
void fields(Archive& a, Fit& f) {
  a.value(f.rotation.w);
  for (Vec3* v : {&f.rotation.v, &f.centre, &f.transform.x, &f.transform.y, &f.transform.z}) fields(a, *v);
  a.value(f.strain);
}

template <class Archive>
void fields(Archive& a, Bodies::Checkpoint::Particle& p) {
  fields(a, p.state);
  fields(a, p.held_weights);
  fields(a, p.velocity);
  value_as<std::uint8_t>(a, p.fate);
  for (CellFace& f : p.on.face) values(a, f.cell.value, f.face);
  a.value(p.on.count);
  if (p.fate > ParticleStatus::escaped || p.on.count > p.on.face.size())
    throw Error("a body's particle has an unknown state");
}

template <class Archive>
void fields(Archive& a, SolidCheckpoint& c) {
  a.list(c.states, [&](ParticleState& p) { fields(a, p); });
  a.list(c.held_weights, [&](Weights& w) { fields(a, w); });
}

template <class Archive>
void fields(Archive& a, Bodies::Checkpoint& c) {
  a.value(c.steps);
  fields(a, c.counters);
  a.list(c.ids, [&](std::uint32_t& id) { a.value(id); });
  a.list(c.fits, [&](Fit& f) { fields(a, f); });
  a.list(c.particles, [&](Bodies::Checkpoint::Particle& p) { fields(a, p); });
  fields(a, c.surfaces);
}

template <class Archive>
void fields(Archive& a, CathetersState& c) {
  a.list(c.catheters, [&](CatheterCheckpoint& k) {
    a.list(k.states, [&](ParticleState& s) { fields(a, s); });
    a.list(k.held_weights, [&](Weights& w) { fields(a, w); });
    values(a, k.inserted, k.turned);
    fields(a, k.direction);
    fields(a, k.reference);
  });
  a.list(c.totals, [&](CatheterTotals& t) { values(a, t.worst_segment, t.refused); });
}

template <class Archive>
void fields(Archive& a, ParticleSystemState& s) {
  StateHash::Words gone = s.gone.words();
  values(a, s.steps, s.next_id, gone[0], gone[1]);
  s.gone = StateHash(gone);
  fields(a, s.table);
  fields(a, s.totals);
  a.list(s.impulses, [&](CachedImpulse& k) { fields(a, k); });
}

template <class Archive>
void fields(Archive& a, ResidenceTimes& t) {
  values(a, t.count, t.sum, t.least, t.most, t.bin);
  for (std::uint64_t& n : t.bins) a.value(n);
}

bool has_statistics(const StatisticsState& s) { return s.has_hits || s.observes_motion || !s.cells.empty(); }

// Nothing if there are no statistics.
template <class Archive>
void fields(Archive& a, StatisticsState& s) {
  if (!a.has_more(has_statistics(s))) return;
  auto kept = static_cast<std::uint8_t>((s.has_hits ? 1 : 0) | (s.cells.empty() ? 0 : 2) | (s.has_impacts ? 4 : 0) |
                                        (s.left_by_class.empty() ? 0 : 8));
  a.value(kept);
  s.has_hits = (kept & 1) != 0;
  s.has_impacts = (kept & 4) != 0;
  a.list(s.hits, [&](FaceHits& f) {
    values(a, f.face.cell.value, f.face.face, f.patch.value, f.hits);
    if (!s.has_impacts) return;
    values(a, f.mass, f.energy);
    for (std::uint64_t& n : f.angles) a.value(n);
  });
  a.list(s.ended_hits, [&](std::uint64_t& n) { a.value(n); });
  value_as<std::uint8_t>(a, s.observes_motion);
  a.list(s.planes, [&](PlaneTotals& p) {
    fields(a, p.forward);
    fields(a, p.backward);
  });
  const auto leave = [&](LeaveTotals& l) {
    fields(a, l.escaped);
    fields(a, l.absorbed);
  };
  a.list(s.left, leave);
  if ((kept & 8) != 0) a.list(s.left_by_class, leave);
  fields(a, s.absorbed_by_edits);
  a.list(s.starts, [&](StartTimes::Start& start) { values(a, start.first_id, start.time); });
  a.value(s.next_id);
  if ((kept & 2) != 0) a.list(s.cells, [&](std::uint64_t& word) { a.value(word); });
}

template <class Archive>
void statistics_fields(Archive& a, FilesProgress& p) {
  values(a, p.planes_bytes, p.crossings_bytes, p.pathlines_bytes, p.interval_begin);
  a.list(p.at_begin, [&](FilesProgress::Plane& plane) { values(a, plane.forward, plane.backward, plane.ages); });
}

template <class Archive>
void fields(Archive& a, RigidPose& p) {
  fields(a, p.displacement);
  a.value(p.rotation.w);
  fields(a, p.rotation.v);
}

template <class Archive>
void fields(Archive& a, SolidsState& s) {
  fields(a, s.set);
  a.list(s.tools, [&](SolidsState::Tool& t) {
    fields(a, t.pose);
    fields(a, t.wanted);
    values(a, t.contacts, t.stopped);
  });
  values(a, s.walls_before, s.walls_now);
  a.list(s.places, [&](VertexPlaces& p) {
    a.value(p.steps);
    a.list(p.before, [&](Vec3& x) { fields(a, x); });
    a.list(p.now, [&](Vec3& x) { fields(a, x); });
  });
}

// The fields that version 0.1 did not write.
template <class Archive>
void later_fields(Archive& a, SimulationState& s) {
  std::vector<CatheterCheckpoint>& catheters = s.catheters.catheters;
  const bool walls = std::any_of(catheters.begin(), catheters.end(), [](const auto& c) { return !c.walls.empty(); });
  const bool statistics = has_statistics(s.statistics);
  if (!a.has_more(statistics || walls || !s.bodies.impulses.empty() ||
                  !s.particles.table[s.particles.table.user_data].empty()))
    return;
  user_data(a, s.particles.table);
  a.list(s.bodies.impulses, [&](CachedImpulse& k) { fields(a, k); });
  for (CatheterCheckpoint& c : catheters) {
    a.list(c.walls, [&](ChainWall& w) {
      a.value(w.index);
      fields(a, w.normal);
      fields(a, w.point);
      values(a, w.weight, w.pressure, w.idle);
    });
  }
  fields(a, s.statistics);
}

template <class Archive>
void fields(Archive& a, Checkpoint& c) {
  fields(a, c.run);
  a.value(c.every);
  fields(a, c.simulation.particles);
  values(a, c.files.stats_bytes, c.files.contacts_bytes);
  a.list(c.files.frames, [&](RecordingFrame& f) { values(a, f.step, f.time, f.pieces, f.environment_pieces); });
  fields(a, c.simulation.events);
  values(a, c.held, c.audited);
  a.list(c.parts, [&](std::uint64_t& sum) { a.value(sum); });
  fields(a, c.simulation.bodies);
  fields(a, c.simulation.catheters);
  values(a, c.files.bodies_bytes, c.files.catheters_bytes, c.files.report_bytes);
  fields(a, c.simulation.solids);
  values(a, c.files.solids_bytes, c.files.solid_contacts_bytes);
  later_fields(a, c.simulation);
  if (has_statistics(c.simulation.statistics)) statistics_fields(a, c.files);
}

void check_same(const RunIdentity& saved, const RunIdentity& run) {
  const auto differs = [](const std::string& what) {
    throw Error(what + "; undo the change, or run without --resume");
  };
  if (saved.version != run.version) differs(fmt::format("it is of version {}, this is {}", saved.version, run.version));
  if (saved.scene != run.scene) differs("the scene has changed since (for more steps use --steps)");
  if (saved.mesh != run.mesh) differs("the mesh has changed since");
  if (saved.seed != run.seed) differs(fmt::format("it was run with seed {}, not {}", saved.seed, run.seed));
}

// The bytes behind the mark and the digest at the start of a file.
struct CheckedBody {
  std::string_view bytes;
  std::uint64_t digest = 0;
};

CheckedBody checked_body(const std::string& text, std::uint64_t expected_mark) {
  std::uint64_t mark = 0;
  std::uint64_t sum = 0;
  CheckpointReader head(text);
  values(head, mark, sum);
  if (mark != expected_mark) throw Error("this is no checkpoint of this machine's kind");
  const std::string_view body = std::string_view(text).substr(16);
  if (digest(body) != sum) throw Error("it is damaged");
  return {body, sum};
}

Checkpoint parse(const std::string& text, const RunIdentity& run) {
  const std::string_view body = checked_body(text, magic).bytes;
  CheckpointReader reader(body);
  RunIdentity saved;  // checked first: what follows may be of another version
  fields(reader, saved);
  check_same(saved, run);
  Checkpoint checkpoint;
  CheckpointReader whole(body);
  fields(whole, checkpoint);
  if (!whole.at_end()) throw Error("it is longer than it says");
  return checkpoint;
}

// One list of fields for reading and writing.
template <class Archive>
void part_fields(Archive& a, ParticleSystemState& part) {
  fields(a, part);
  user_data(a, part.table);
}

ParticleSystemState parse_part(const std::string& text, std::uint64_t expected) {
  const CheckedBody body = checked_body(text, part_magic);
  if (body.digest != expected) throw Error("it is of another checkpoint");
  CheckpointReader reader(body.bytes);
  ParticleSystemState part;
  part_fields(reader, part);
  if (!reader.at_end()) throw Error("it is longer than it says");
  return part;
}

std::uint64_t write_checked(const std::filesystem::path& path, std::uint64_t mark, const CheckpointWriter& body) {
  CheckpointWriter head;
  std::uint64_t sum = digest(body.text());
  values(head, mark, sum);
  const std::array<std::string_view, 2> pieces = {head.text(), body.text()};
  replace_file(path, pieces);
  return sum;
}

// The sum of these over cells does not depend on which rank has which.
class CellDigests {
 public:
  explicit CellDigests(const MeshData& mesh) : mesh_(mesh) {
    for (const Vec3& x : mesh.points) points_.push_back(digest({reinterpret_cast<const char*>(&x), sizeof x}));
  }

  /// `number`: of the cell in the whole mesh.
  [[nodiscard]] std::uint64_t operator()(std::size_t c, std::uint64_t number) {
    const bool is_free = mesh_.free.empty() || mesh_.free[c] != 0;
    words_ = {number, static_cast<std::uint64_t>(mesh_.types[c]), is_free ? 1U : 0U};
    for_each_entry(
        mesh_, c, [&](std::uint32_t p) { words_.push_back(points_[p]); },
        [&](std::uint32_t n) { words_.push_back(n); });
    return digest(bytes_of(words_));
  }

 private:
  const MeshData& mesh_;
  std::vector<std::uint64_t> points_;
  std::vector<std::uint64_t> words_;  // keeps its memory
};

}  // namespace

RunIdentity run_identity(const std::string& scene_text, const MeshData& mesh, std::uint64_t seed) {
  CellDigests digests(mesh);
  std::uint64_t sum = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) sum += digests(c, c);
  return {version(), digest(scene_text), sum, seed};
}

RunIdentity run_identity(const std::string& scene_text, const MeshPart& part, Ranks& ranks, std::uint64_t seed) {
  CellDigests digests(part.mesh);
  std::uint64_t sum = 0;
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    if (part.owners[c] == part.part) sum += digests(c, part.cells[c]);
  }
  ranks.sum({&sum, 1});
  return {version(), digest(scene_text), sum, seed};
}

void write_checkpoint(const std::filesystem::path& path, Checkpoint& checkpoint) {
  CheckpointWriter body;
  fields(body, checkpoint);
  write_checked(path, magic, body);
}

std::uint64_t write_checkpoint_part(const std::filesystem::path& path, ParticleSystemState& part) {
  CheckpointWriter body;
  part_fields(body, part);
  return write_checked(path, part_magic, body);
}

std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path, const RunIdentity& run) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    return parse(read_bytes(path), run);
  } catch (const Error& e) {
    throw Error(fmt::format("{}: the run cannot be resumed: {}", path.string(), e.what()));
  }
}

ParticleSystemState read_checkpoint_part(const std::filesystem::path& path, std::uint64_t digest) {
  try {
    if (!std::filesystem::exists(path)) throw Error("a part of the checkpoint is missing");
    return parse_part(read_bytes(path), digest);
  } catch (const Error& e) {
    throw Error(fmt::format("{}: the run cannot be resumed: {}; run without --resume", path.string(), e.what()));
  }
}

}  // namespace dartcast
