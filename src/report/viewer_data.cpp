// Makes the viewer's data from a recording.
//
// Phases: Choose frames and particles. Read the chosen frames, and put each particle's values into its slot. Find the
// box of all positions. Code series of values in groups of frames. Sort the contacts by slot. Describe all in JSON.
#include "report/viewer_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "report/encode.hpp"
#include "report/grouped.hpp"
#include "report/picture.hpp"
#include "report/selection.hpp"
#include "simulation/start_times.hpp"

namespace dartcast {

namespace {

using ViewerJson = nlohmann::ordered_json;

constexpr std::size_t group_size = 16;          // frames
constexpr std::size_t most_contacts = 250'000;  // beyond it, those of some slots are left out
constexpr double usual_share = 0.98;  // of speeds that the colours distinguish: a few are far above all others

// A number that names a patch: 0 is none. If a map has as many patches as it can, the last two share one.
std::uint16_t patch_or_none(std::uint16_t patch) {
  return static_cast<std::uint16_t>(std::min<unsigned>(patch + 1U, UINT16_MAX));
}

// A list of solids changes over time: each is known by its kind and name.
struct SolidSeries {
  RecordedSolid first;
  std::vector<std::uint32_t> present;
  std::vector<RecordedPoint> points;  // the items of each frame
  std::size_t items = 0;
};

class Builder {
 public:
  Builder(const RecordedFile& file, const ReportOptions& options, const Vec3& gravity)
      : file_(file),
        gravity_(gravity),
        chosen_(select(file, options)),
        slots_(chosen_.ids.size()),
        threads_(options.threads),
        frames_(std::move(chosen_.recorded)) {}

  ViewerData build() {
    read_frames();
    describe_scene();
    describe_events();
    opening_ = opening_frame();
    json_["opening"] = opening_;
    json_["gravity"] = {gravity_.x, gravity_.y, gravity_.z};
    describe_particles();
    describe_contacts();
    describe_walls();
    describe_solids();
    parallel_for(data_.blocks.size(), 1, threads_, [this](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) data_.blocks[i] = base64(gzipped(data_.blocks[i]));
    });
    data_.description = json_.dump(-1, ' ', false, ViewerJson::error_handler_t::replace);
    data_.picture = picture_of(frames_[opening_], walls_.at(chosen_.frames[opening_].walls), file_.header().dimension);
    return std::move(data_);
  }

 private:
  // The block is compressed later, together with all others.
  std::size_t block(std::string bytes) {
    data_.blocks.push_back(std::move(bytes));
    return data_.blocks.size() - 1;
  }
  template <class T>
  std::size_t block(const std::vector<T>& values) {
    return block(std::string(bytes_of(std::span<const T>(values))));
  }

  // The frame to open on stands alone, so that it can be drawn before the others are decoded. `begin`: the first frame.
  template <class T, class Code>
  ViewerJson series(const std::vector<T>& values, std::size_t each, std::size_t begin, Code&& code) {
    ViewerJson groups = ViewerJson::array();
    const std::size_t frames = each == 0 ? 0 : values.size() / each;
    for (std::size_t first = 0; first < frames;) {
      const std::size_t at = begin + first;
      std::size_t count = at == opening_ ? 1 : std::min(group_size, frames - first);
      if (at < opening_) count = std::min(count, opening_ - at);
      const std::span<const T> part(values.data() + first * each, count * each);
      groups.push_back({{"first", first}, {"count", count}, {"block", block(code(part, each))}});
      first += count;
    }
    return {{"groups", groups}};
  }
  ViewerJson position_series(const std::vector<RecordedPoint>& points, std::size_t each, std::size_t begin = 0) {
    std::vector<std::uint16_t> values;
    values.reserve(points.size() * 3);
    for (const RecordedPoint& p : points) {
      for (const std::uint16_t q : box_.quantised(p)) values.push_back(q);
    }
    return series(values, each * 3, begin, second_differences);
  }

  const std::vector<RecordedPoint>& wall_points(std::size_t frame) const {
    const RecordedFrame& f = frames_[frame];
    return f.wall_points.empty() ? walls_.at(chosen_.frames[frame].walls).points : f.wall_points;
  }

  void read_frames() {
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const ReportSelection::Frame& f = chosen_.frames[k];
      const RecordedFrame& frame = frames_[k];
      if (!walls_.contains(f.walls)) walls_.emplace(f.walls, file_.read<RecordedWalls>(file_.chunks()[f.walls]));
      const RecordedWalls& walls = walls_.at(f.walls);
      const bool fits = (frame.wall_points.empty() || frame.wall_points.size() == walls.points.size()) &&
                        (frame.hits.empty() || frame.hits.size() == walls.patches.size());
      if (!fits)
        throw Error(fmt::format("report.bin is damaged: the walls of step {} are others than those recorded", f.step));
      for (const RecordedPoint& p : frame.positions) box_.add(p);
      for (const RecordedPoint& p : wall_points(k)) box_.add(p);
      for (const RecordedSolid& s : frame.solids) {
        for (const RecordedPoint& p : s.points) box_.add(p);
      }
    }
  }

  void describe_scene() {
    const Vec3& o = file_.header().origin;
    json_ = {{"version", DARTCAST_VERSION}, {"dimension", file_.header().dimension}};
    json_["box"] = {{box_.low[0] + o.x, box_.low[1] + o.y, box_.low[2] + o.z},
                    {box_.high[0] + o.x, box_.high[1] + o.y, box_.high[2] + o.z}};
    json_["frames"] = ViewerJson::array();
    for (const ReportSelection::Frame& f : chosen_.frames)
      json_["frames"].push_back({{"step", f.step}, {"time", f.time}});
    json_["patches"] = walls_.at(chosen_.frames.back().walls).patch_names;
    data_.taken.particles = slots_;
    data_.taken.particles_recorded = chosen_.recorded_ids;
    data_.taken.particles_of_run = chosen_.all_ids;
    data_.taken.frames = chosen_.frames.size();
    data_.taken.frames_recorded = chosen_.recorded_frames;
  }

  // Calls f(frame, slot, place in the frame) for each particle that has a slot.
  template <class F>
  void for_each_particle(F&& f) const {
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const RecordedFrame& frame = frames_[k];
      for (std::size_t i = 0; i < frame.ids.size(); ++i) {
        const auto found = chosen_.slot.find(frame.ids[i]);
        if (found != chosen_.slot.end()) f(k, std::size_t{found->second}, i);
      }
    }
  }

  void find_life() {
    first_.assign(slots_, 0xffff);
    last_.assign(slots_, 0);
    for_each_particle([&](std::size_t k, std::size_t slot, std::size_t) {
      first_[slot] = std::min(first_[slot], static_cast<std::uint16_t>(k));
      last_[slot] = std::max(last_[slot], static_cast<std::uint16_t>(k));
    });
  }

  // If a particle is not there it keeps the last values, or has its first ones already: no difference costs nothing.
  template <class T>
  std::vector<T> values_of(const std::vector<T>& sparse) const {
    std::vector<T> values = sparse;
    for (std::size_t slot = 0; slot < slots_; ++slot) {
      for (std::size_t k = 0; k < frames_.size(); ++k) {
        const std::size_t from = std::clamp<std::size_t>(k, first_[slot], last_[slot]);
        if (from != k) values[k * slots_ + slot] = values[from * slots_ + slot];
      }
    }
    return values;
  }

  // When each slot's particle came into the scene.
  std::vector<float> start_times() const {
    StartTimes times;
    for (const RecordedFile::Chunk& chunk : file_.chunks()) {
      if (chunk.tag != RecordedArrivals::tag) continue;
      const auto arrivals = file_.read<RecordedArrivals>(chunk);
      times.add(arrivals.all, arrivals.time);
    }
    std::vector<float> start(slots_);
    for (std::size_t slot = 0; slot < slots_; ++slot) {
      const bool known = chosen_.ids[slot] < times.next_id();
      start[slot] = static_cast<float>(known ? times.of(chosen_.ids[slot]) : frames_[first_[slot]].time);
    }
    return start;
  }

  void describe_particles() {
    if (slots_ == 0) return;
    find_life();
    const std::size_t n = frames_.size() * slots_;
    std::vector<RecordedPoint> positions(n);
    std::vector<float> speeds(n);
    std::vector<std::uint8_t> kinds(n);
    std::vector<float> start = start_times();
    std::vector<float> radii(slots_);
    float fastest = 0.0F;
    for_each_particle([&](std::size_t k, std::size_t slot, std::size_t i) {
      positions[k * slots_ + slot] = frames_[k].positions[i];
      speeds[k * slots_ + slot] = frames_[k].speeds[i];
      kinds[k * slots_ + slot] = frames_[k].kinds[i];
      fastest = std::max(fastest, frames_[k].speeds[i]);
      if (!frames_[k].radii.empty()) radii[slot] = frames_[k].radii[i];
    });
    std::vector<std::uint8_t> speed_bytes(n);
    std::transform(speeds.begin(), speeds.end(), speed_bytes.begin(), [&](float v) {
      return static_cast<std::uint8_t>(fastest > 0.0F ? std::lround(255.0 * static_cast<double>(v) / fastest) : 0);
    });
    std::vector<std::uint32_t> ids(chosen_.ids.begin(), chosen_.ids.end());
    const bool has_radii = std::any_of(radii.begin(), radii.end(), [](float r) { return r > 0.0F; });
    ViewerJson speed = series(values_of(speed_bytes), slots_, 0, first_differences);
    speed["max"] = fastest;
    speed["usual"] = usual_speed();
    json_["particles"] = {{"count", slots_}, {"of", chosen_.all_ids}};
    ViewerJson& out = json_["particles"];
    out["id"] = block(ids);
    out["first"] = block(first_);
    out["last"] = block(last_);
    out["start"] = block(start);
    out["radius"] = has_radii ? ViewerJson(block(radii)) : ViewerJson();
    out["position"] = position_series(values_of(positions), slots_);
    out["speed"] = std::move(speed);
    out["kind"] = series(values_of(kinds), slots_, 0, first_differences);
  }

  // The speed that few particles pass.
  float usual_speed() const {
    std::vector<float> all;
    for (const RecordedFrame& frame : frames_) all.insert(all.end(), frame.speeds.begin(), frame.speeds.end());
    if (all.empty()) return 0.0F;
    const auto place = static_cast<std::ptrdiff_t>(usual_share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), all.begin() + place, all.end());
    return all[static_cast<std::size_t>(place)];
  }

  // The frame to open on. Among those after the last change of the scene it is the one with most different places and
  // speeds of particles. Without particles it is the last one.
  std::size_t opening_frame() const {
    double changed = -std::numeric_limits<double>::infinity();
    for (const ViewerJson& e : json_["events"]) changed = std::max(changed, e["time"].get<double>());
    const double usual = std::max<double>(usual_speed(), 1e-300);
    std::size_t best = frames_.size() - 1;
    std::size_t most = 0;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const RecordedFrame& frame = frames_[k];
      if (frame.time < changed) continue;
      std::set<std::array<int, 4>> seen;
      for (std::size_t i = 0; i < frame.ids.size(); ++i) {
        const auto q = box_.quantised(frame.positions[i]);
        const int speed = static_cast<int>(8.0 * std::min(frame.speeds[i] / usual, 1.0));
        seen.insert({q[0] >> 11, q[1] >> 11, q[2] >> 11, speed});  // 32 places on each axis
      }
      if (seen.size() > most) std::tie(most, best) = std::pair(seen.size(), k);
    }
    return best;
  }

  // The contacts of the slots, by slot, then by time.
  std::vector<std::vector<RecordedContact>> contacts_by_slot() const {
    std::vector<std::vector<RecordedContact>> by_slot(slots_);
    for (const RecordedFile::Chunk& chunk : file_.chunks()) {
      if (chunk.tag != RecordedContacts::tag) continue;
      for (const RecordedContact& c : file_.read<RecordedContacts>(chunk).contacts) {
        const auto found = chosen_.slot.find(c.id);
        if (found != chosen_.slot.end()) by_slot[found->second].push_back(c);
      }
    }
    for (auto& list : by_slot)
      std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    return by_slot;
  }

  // The patch that each particle met last, frame by frame.
  ViewerJson patch_series(const std::vector<std::vector<RecordedContact>>& by_slot) {
    std::vector<std::uint16_t> met(frames_.size() * slots_);
    for (std::size_t slot = 0; slot < slots_; ++slot) {
      std::size_t next = 0;
      std::uint16_t last = 0;
      for (std::size_t k = 0; k < frames_.size(); ++k) {
        for (; next < by_slot[slot].size() && by_slot[slot][next].time <= frames_[k].time; ++next)
          last = patch_or_none(by_slot[slot][next].patch);
        met[k * slots_ + slot] = last;
      }
    }
    return series(met, slots_, 0, second_differences);
  }

  void describe_contacts() {
    if (slots_ == 0) return;
    const std::vector<std::vector<RecordedContact>> by_slot = contacts_by_slot();
    json_["particles"]["patch"] = patch_series(by_slot);
    std::size_t all = 0;
    for (const auto& list : by_slot) all += list.size();
    const std::size_t kept_every = std::max<std::size_t>((all + most_contacts - 1) / most_contacts, 1);
    std::vector<std::uint32_t> offset = {0};
    std::vector<float> time;
    std::vector<std::uint16_t> patch;
    std::vector<std::uint8_t> kind;
    std::vector<std::uint16_t> point;
    for (std::size_t slot = 0; slot < slots_; ++slot) {
      for (const RecordedContact& c : by_slot[slot]) {
        if (slot % kept_every != 0) break;
        time.push_back(static_cast<float>(c.time));
        patch.push_back(patch_or_none(c.patch));
        kind.push_back(c.kind);
        for (const std::uint16_t q : box_.quantised(c.point)) point.push_back(q);
      }
      offset.push_back(static_cast<std::uint32_t>(time.size()));
    }
    ViewerJson& out = json_["contacts"];
    out = {{"count", time.size()}, {"kept_every", kept_every}, {"of", all}};
    out["offset"] = block(offset);
    out["time"] = block(time);
    out["patch"] = block(patch);
    out["kind"] = block(kind);
    out["point"] = block(point);
    if (kept_every > 1)
      data_.taken.notes.push_back(fmt::format("Of {} contacts, the report has those of one particle in {}.",
                                              grouped(all), grouped(kept_every)));
  }

  struct Faces {
    std::vector<std::uint32_t> corners;  // triangles, or segments in the plane
    std::vector<std::uint16_t> patches;
    std::vector<std::uint32_t> polygons;  // the wall face of each
    std::vector<std::uint32_t> edges;
  };

  // Polygons as fans of triangles; their own edges for a drawing of wires, each once.
  Faces faces_of(const RecordedWalls& walls) const {
    Faces out;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    const auto add = [&](std::size_t face, std::initializer_list<std::uint32_t> corners) {
      out.corners.insert(out.corners.end(), corners);
      out.patches.push_back(walls.patches[face]);
      out.polygons.push_back(static_cast<std::uint32_t>(face));
    };
    for (std::size_t f = 0; f < walls.patches.size(); ++f) {
      const std::uint32_t* c = walls.corners.data() + walls.offsets[f];
      const std::size_t n = walls.offsets[f + 1] - walls.offsets[f];
      if (file_.header().dimension == 2) {
        if (n >= 2) add(f, {c[0], c[1]});
        continue;
      }
      for (std::size_t k = 0; k < n; ++k) edges.emplace_back(std::minmax(c[k], c[(k + 1) % n]));
      for (std::size_t k = 2; k < n; ++k) add(f, {c[0], c[k - 1], c[k]});
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& [a, b] : edges) out.edges.insert(out.edges.end(), {a, b});
    return out;
  }

  // Hits of the wall faces up to each frame, in units that fit into 16 bits.
  ViewerJson hits_series(std::size_t begin, std::size_t end, std::size_t faces) {
    std::uint32_t most = 0;
    for (std::size_t k = begin; k < end; ++k) {
      for (const std::uint32_t h : frames_[k].hits) most = std::max(most, h);
    }
    const std::uint32_t per = most / 65536 + 1;
    std::vector<std::uint16_t> values;
    for (std::size_t k = begin; k < (most > 0 ? end : begin + 1); ++k) {
      const std::vector<std::uint32_t>& hits = frames_[k].hits;
      for (std::size_t f = 0; f < faces; ++f)
        values.push_back(static_cast<std::uint16_t>(hits.empty() ? 0 : hits[f] / per));
    }
    ViewerJson out = series(values, faces, begin, second_differences);
    out["per"] = per;
    out["max"] = most;
    return out;
  }

  // One entry for the frames that have the same walls.
  void describe_walls() {
    json_["walls"] = ViewerJson::array();
    for (std::size_t begin = 0; begin < frames_.size();) {
      std::size_t end = begin + 1;
      while (end < frames_.size() && chosen_.frames[end].walls == chosen_.frames[begin].walls) ++end;
      const RecordedWalls& walls = walls_.at(chosen_.frames[begin].walls);
      const Faces faces = faces_of(walls);
      bool moves = false;
      for (std::size_t k = begin + 1; k < end && !moves; ++k) moves = wall_points(k) != wall_points(begin);
      std::vector<RecordedPoint> points;
      for (std::size_t k = begin; k < (moves ? end : begin + 1); ++k)
        points.insert(points.end(), wall_points(k).begin(), wall_points(k).end());
      ViewerJson entry = {{"first", begin},
                          {"points", walls.points.size()},
                          {"polygons", walls.patches.size()},
                          {"faces", faces.patches.size()}};
      entry["corners"] = block(faces.corners);
      entry["face_patch"] = block(faces.patches);
      entry["face"] = block(faces.polygons);
      entry["edges"] = faces.edges.empty() ? ViewerJson() : ViewerJson(block(faces.edges));
      entry["position"] = position_series(points, walls.points.size(), begin);
      entry["hits"] = hits_series(begin, end, walls.patches.size());
      json_["walls"].push_back(std::move(entry));
      begin = end;
    }
  }

  void describe_solids() {
    std::map<std::pair<SolidKind, std::string>, SolidSeries> all;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      for (const RecordedSolid& s : frames_[k].solids) {
        SolidSeries& series = all[{s.kind, s.name}];
        if (series.present.empty()) series.first = s;
        series.items = std::max(series.items, s.points.size());
        series.present.resize(frames_.size());
        series.present[k] = static_cast<std::uint32_t>(s.points.size());
      }
    }
    json_["solids"] = ViewerJson::array();
    for (auto& [key, series] : all) {
      std::vector<RecordedPoint> points(frames_.size() * series.items);
      for (std::size_t k = 0; k < frames_.size(); ++k) {
        for (const RecordedSolid& s : frames_[k].solids) {
          if (s.kind == key.first && s.name == key.second)
            std::copy(s.points.begin(), s.points.end(), points.begin() + static_cast<std::ptrdiff_t>(k * series.items));
        }
      }
      ViewerJson entry = {
          {"kind", key.first == SolidKind::body ? "body" : "catheter"}, {"name", key.second}, {"items", series.items}};
      entry["present"] = block(series.present);
      entry["radius"] = series.first.radius;
      entry["corners"] = series.first.triangles.empty() ? ViewerJson() : ViewerJson(block(series.first.triangles));
      entry["position"] = position_series(points, series.items);
      json_["solids"].push_back(std::move(entry));
    }
  }

  void describe_events() {
    json_["events"] = ViewerJson::array();
    for (const RecordedFile::Chunk& chunk : file_.chunks()) {
      if (chunk.tag != RecordedEvent::tag) continue;
      const auto e = file_.read<RecordedEvent>(chunk);
      json_["events"].push_back({{"time", e.time}, {"step", e.step}, {"text", e.text}});
    }
  }

  const RecordedFile& file_;
  Vec3 gravity_;
  std::size_t opening_ = 0;
  ReportSelection chosen_;
  std::size_t slots_;
  Threads threads_;
  std::vector<RecordedFrame> frames_;
  std::map<std::size_t, RecordedWalls> walls_;  // by chunk
  QuantisedBox box_;
  std::vector<std::uint16_t> first_;  // frame of each slot
  std::vector<std::uint16_t> last_;
  ViewerJson json_;
  ViewerData data_;
};

}  // namespace

ViewerData viewer_data(const RecordedFile& file, const ReportOptions& options, const Vec3& gravity) {
  return Builder(file, options, gravity).build();
}

}  // namespace dartcast
