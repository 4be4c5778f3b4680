// The summary of a run, as JSON and for people.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"

namespace dartcast {

namespace {

using Json = nlohmann::ordered_json;

double ratio(double a, double b) { return a / b; }
double ratio(std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

Json orientation_tests(const Summary& s) {
  const Counters& c = s.totals.counters;
  std::size_t size = c.histogram.size();
  while (size > 1 && c.histogram[size - 1] == 0) --size;
  Json json = {{"mean", ratio(c.orientation.tests, c.particle_steps)},
               {"histogram", std::vector<std::uint64_t>(c.histogram.begin(),
                                                        c.histogram.begin() + static_cast<std::ptrdiff_t>(size))}};
  if (c.orientation.tests > 0) json["exact_share"] = ratio(c.orientation.exact, c.orientation.tests);
  json["forecast_kept_share"] = ratio(c.forecast_kept, c.particle_steps);
  if (s.deforms) json["updated_by_deformation_share"] = ratio(c.updated_by_deformation, c.particle_steps);
  return json;
}

// A summary may come from anywhere: each list by patch needs its names, and each plane its options.
void check_names(const Summary& s) {
  std::size_t patches = s.totals.contacts_by_patch.size();
  if (s.statistics) {
    const StatisticsSummary& all = *s.statistics;
    patches = std::max({patches, all.hits_by_patch.size(), all.left.size()});
    if (all.planes.size() > all.options.planes.size()) {
      throw InvalidArgument(
          fmt::format("summary: {} planes, but options for {}", all.planes.size(), all.options.planes.size()));
    }
  }
  if (patches > s.patch_names.size())
    throw InvalidArgument(fmt::format("summary: values for {} patches, but {} names", patches, s.patch_names.size()));
}

// Values by the name of the patch; those without a patch where there are any.
Json by_patch(const Summary& s, const std::vector<std::uint64_t>& values) {
  Json json = Json::object();
  for (std::size_t i = 1; i < values.size(); ++i) json[s.patch_names[i]] = values[i];
  if (!values.empty() && values[0] > 0) json[""] = values[0];
  return json;
}

Json contacts(const Summary& s) {
  const auto& by_kind = s.totals.counters.contacts;
  return {{"total", by_kind[0] + by_kind[1] + by_kind[2]},
          {"face", by_kind[2]},
          {"edge", by_kind[1]},
          {"vertex", by_kind[0]},
          {"by_patch", by_patch(s, s.totals.contacts_by_patch)}};
}

Json seconds(const Summary& s) {
  Json json = {{"load", s.seconds_load}, {"locate", s.seconds_locate}, {"detect", s.totals.seconds_detect}};
  if (s.deforms) json["deform"] = s.totals.seconds_deform;
  if (s.totals.seconds_collide > 0.0) json["collide"] = s.totals.seconds_collide;
  json["respond"] = s.totals.seconds_respond;
  if (!s.bodies.empty() || !s.catheters.empty()) json["solids"] = s.seconds_solids;
  if (s.statistics) json["statistics"] = s.statistics->seconds;
  json["write"] = s.seconds_write;
  json["writing_thread"] = s.seconds_writing_thread;
  return json;
}

Json events(const EventLog& log) {
  Json list = Json::array();
  for (const EventReport& e : log.events) {
    list.push_back({{"kind", name_of(e.kind)},
                    {"time", e.time},
                    {"step", e.step},
                    {"cells",
                     {{"removed", e.cells_removed},
                      {"added", e.cells_added},
                      {"opened", e.cells_opened},
                      {"blocked", e.cells_blocked},
                      {"whole", e.cells_whole}}},
                    {"particles",
                     {{"in_opened", e.particles_in_opened},
                      {"touched", e.particles_touched},
                      {"located", e.particles_located},
                      {"moved", e.particles_moved},
                      {"held", e.particles_held},
                      {"absorbed", e.particles_absorbed}}},
                    {"boundary_shift", e.boundary_shift},
                    {"seconds", e.seconds}});
  }
  return list;
}

Json collisions(const SimulationTotals& t) {
  const CollisionCounts& c = t.collisions;
  return {{"pairs_tested", c.pairs_tested},
          {"pairs_near", c.pairs_near},
          {"pairs_touching", c.pairs_touching},
          {"walls_touching", c.walls_touching},
          {"overlaps", c.overlaps},
          {"deepest", c.deepest},
          {"wall_overlaps", t.wall_overlaps},
          {"deepest_in_wall", t.deepest_in_wall}};
}

Json vector(const Vec3& v) { return {v.x, v.y, v.z}; }

Json bodies(const std::vector<BodySummary>& all) {
  Json list = Json::array();
  for (const BodySummary& b : all) {
    Json json = {{"name", b.name}, {"gone", b.gone}};
    if (!b.gone) {
      json["particles"] = b.particles;
      json["centre"] = vector(b.centre);
      json["energy"] = {
          {"kinetic", b.energy.kinetic}, {"potential", b.energy.potential}, {"matching", b.energy.matching}};
    }
    list.push_back(json);
  }
  return list;
}

Json catheters(const std::vector<CatheterSummary>& all) {
  Json list = Json::array();
  for (const CatheterSummary& c : all) {
    list.push_back({{"name", c.name},
                    {"inserted", c.inserted},
                    {"measured_length", c.measured_length},
                    {"worst_segment", c.totals.worst_segment},
                    {"refused", c.totals.refused},
                    {"tip", vector(c.tip)}});
  }
  return list;
}

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

Json residence_time(const ResidenceTimes& t) {
  if (t.count == 0) return {{"count", 0}};
  return {{"count", t.count}, {"mean", t.mean()}, {"least", t.least},
          {"most", t.most},   {"bin", t.bin},     {"histogram", t.bins}};
}

Json planes(const StatisticsSummary& s) {
  Json list = Json::array();
  for (std::size_t i = 0; i < s.planes.size(); ++i) {
    const PlaneTotals& p = s.planes[i];
    list.push_back({{"name", s.options.planes[i].name},
                    {"forward", p.forward.count},
                    {"backward", p.backward.count},
                    {"residence_time", residence_time(p.forward)}});
    if (s.time > 0.0)
      list.back()["flux"] = (static_cast<double>(p.forward.count) - static_cast<double>(p.backward.count)) / s.time;
  }
  return list;
}

// For the patches where particles left.
Json residence(const Summary& s) {
  Json json = {{"escaped", Json::object()}, {"absorbed", Json::object()}};
  const StatisticsSummary& all = *s.statistics;
  for (std::size_t i = 0; i < all.left.size(); ++i) {
    if (all.left[i].escaped.count > 0) json["escaped"][s.patch_names[i]] = residence_time(all.left[i].escaped);
    if (all.left[i].absorbed.count > 0) json["absorbed"][s.patch_names[i]] = residence_time(all.left[i].absorbed);
  }
  if (all.absorbed_by_edits.count > 0) json["absorbed_by_edits"] = residence_time(all.absorbed_by_edits);
  return json;
}

Json statistics(const Summary& s) {
  const StatisticsSummary& all = *s.statistics;
  Json json = Json::object();
  if (all.options.hits) {
    json["hits"] = {{"total", sum(all.hits_by_patch)},
                    {"by_patch", by_patch(s, all.hits_by_patch)},
                    {"faces", all.hit_faces},
                    {"ended", sum(all.ended_by_patch)}};
  }
  if (!all.planes.empty()) json["planes"] = planes(all);
  if (all.options.residence) json["residence_time"] = residence(s);
  return json;
}

double ns_per_particle_step(const Summary& s) {
  return ratio(s.totals.seconds_detect * 1e9, static_cast<double>(s.totals.counters.particle_steps));
}

}  // namespace

std::string version() { return DARTCAST_VERSION; }

std::string summary_json(const Summary& s) {
  check_names(s);
  const SimulationTotals& t = s.totals;
  Json json = {{"version", version()},
               {"scene", s.scene},
               {"threads", s.threads},
               {"steps", s.steps},
               {"particle_steps", t.counters.particle_steps},
               {"environment",
                {{"cells", s.cells},
                 {"free_cells", s.free_cells},
                 {"vertices", s.vertices},
                 {"wall_faces", s.wall_faces},
                 {"bytes", s.bytes}}},
               {"particles",
                {{"start", t.start},
                 {"injected", t.injected},
                 {"absorbed", t.absorbed},
                 {"escaped", t.escaped},
                 {"alive", s.alive},
                 {"held", s.held},
                 {"lost", s.lost}}}};
  if (s.skipped.count > 0) json["environment"]["bad_cells"] = {{"count", s.skipped.count}, {"first", s.skipped.first}};
  if (s.surgery) {
    json["particles"]["in_opened"] = s.surgery->in_opened;
    json["events"] = events(*s.surgery);
    json["remeshing"] = {{"mended", s.surgery->mended}, {"left", s.surgery->left}};
    json["crowding"] = {
        {"subdivided", s.surgery->subdivided}, {"merged", s.surgery->merged}, {"refused", s.surgery->refused}};
  }
  if (t.collisions.pairs_tested + t.wall_overlaps > 0) json["collisions"] = collisions(t);
  if (!s.bodies.empty()) json["bodies"] = bodies(s.bodies);
  if (!s.catheters.empty()) json["catheters"] = catheters(s.catheters);
  if (t.counters.particle_steps > 0) json["orientation_tests"] = orientation_tests(s);
  json["contacts"] = contacts(s);
  if (s.statistics) json["statistics"] = statistics(s);
  json["seconds"] = seconds(s);
  if (t.counters.particle_steps > 0) json["ns_per_particle_step"] = ns_per_particle_step(s);
  if (s.cancelled) json["cancelled"] = true;
  if (s.audit) json["audit"] = {{"checked", s.audit->checked}, {"failed", s.audit->failed}};
  json["state_hash"] = s.state_hash;
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

namespace {

std::string solids_text(const Summary& s) {
  std::string out;
  for (const BodySummary& b : s.bodies) {
    out += b.gone ? fmt::format("body {}: left at a wall\n", b.name)
                  : fmt::format("body {}: {} particles, centre ({:.4g}, {:.4g}, {:.4g}), kinetic energy {:.3g} J\n",
                                b.name, b.particles, b.centre.x, b.centre.y, b.centre.z, b.energy.kinetic);
  }
  for (const CatheterSummary& c : s.catheters) {
    out += fmt::format(
        "catheter {}: {:.4g} m inserted, its length {:.4g} m (worst segment off by {:.2f}%), {:.3g} m of pushes "
        "refused, "
        "tip ({:.4g}, {:.4g}, {:.4g})\n",
        c.name, c.inserted, c.measured_length, 100.0 * c.totals.worst_segment, c.totals.refused, c.tip.x, c.tip.y,
        c.tip.z);
  }
  return out;
}

std::string surgery_text(const EventLog& log) {
  std::string out;
  for (const EventReport& e : log.events) {
    out += fmt::format(
        "{} at {:.6g} s: {} cells replaced by {}, {} opened, {} blocked; {} particles located again, {} moved, {} "
        "held, {} "
        "absorbed; {} in opened cells before\n",
        name_of(e.kind), e.time, e.cells_removed, e.cells_added, e.cells_opened, e.cells_blocked, e.particles_located,
        e.particles_moved, e.particles_held, e.particles_absorbed, e.particles_in_opened);
  }
  if (log.mended + log.left > 0)
    out += fmt::format("remeshing: {} regions mended, {} cells left as they were\n", log.mended, log.left);
  if (log.subdivided + log.refused > 0)
    out += fmt::format("crowding: {} cells subdivided, {} made again, {} left as they were\n", log.subdivided,
                       log.merged, log.refused);
  return out + fmt::format("{} particles in opened cells at the end\n", log.in_opened);
}

std::string residence_text(const Summary& s) {
  std::string out;
  const auto add = [&](std::string_view how, std::string_view where, const ResidenceTimes& t) {
    if (t.count > 0)
      out += fmt::format("{} {}: {} particles after {:.4g} s on average\n", how,
                         where.empty() ? std::string_view("without a patch") : where, t.count, t.mean());
  };
  for (std::size_t i = 0; i < s.statistics->left.size(); ++i) {
    add("escaped at", s.patch_names[i], s.statistics->left[i].escaped);
    add("absorbed at", s.patch_names[i], s.statistics->left[i].absorbed);
  }
  add("absorbed by", "edits", s.statistics->absorbed_by_edits);
  return out;
}

std::string statistics_text(const StatisticsSummary& s) {
  std::string out;
  if (s.options.hits)
    out += fmt::format("hits: {} on {} wall faces, {} on faces that edits ended\n",
                       sum(s.hits_by_patch) - sum(s.ended_by_patch), s.hit_faces, sum(s.ended_by_patch));
  for (std::size_t i = 0; i < s.planes.size(); ++i)
    out += fmt::format("plane {}: {} forward after {:.4g} s on average, {} backward\n", s.options.planes[i].name,
                       s.planes[i].forward.count, s.planes[i].forward.mean(), s.planes[i].backward.count);
  return out;
}

}  // namespace

std::string summary_text(const Summary& s) {
  check_names(s);
  const SimulationTotals& t = s.totals;
  const Counters& c = t.counters;
  std::string out = fmt::format("{}: {} steps, {} cells ({} free), {} wall faces, {:.1f} MB\n", s.scene, s.steps,
                                s.cells, s.free_cells, s.wall_faces, static_cast<double>(s.bytes) / 1e6);
  if (s.skipped.count > 0)
    out += fmt::format("{} {}; the first: {}\n", s.skipped.count, s.skipped.message, fmt::join(s.skipped.first, ", "));
  out += fmt::format("particles: {} at the start, {} injected, {} absorbed, {} escaped, {} alive, {} held, {} lost\n",
                     t.start, t.injected, t.absorbed, t.escaped, s.alive, s.held, s.lost);
  out += fmt::format("contacts: {} ({} with faces, {} with edges, {} with vertices)\n",
                     c.contacts[0] + c.contacts[1] + c.contacts[2], c.contacts[2], c.contacts[1], c.contacts[0]);
  if (c.particle_steps > 0) {
    out += fmt::format(
        "per particle-step: {:.2f} orientation tests, {:.0f} ns with {} threads; forecast kept in {:.1f}%\n",
        ratio(c.orientation.tests, c.particle_steps), ns_per_particle_step(s), s.threads,
        100.0 * ratio(c.forecast_kept, c.particle_steps));
  }
  out += fmt::format(
      "seconds: load {:.2f}, locate {:.2f}, detect {:.2f}, deform {:.2f}, respond {:.2f}, write {:.2f}\n",
      s.seconds_load, s.seconds_locate, t.seconds_detect, t.seconds_deform, t.seconds_respond, s.seconds_write);
  if (t.collisions.pairs_tested > 0)
    out += fmt::format("collisions: {} touching pairs, {} overlaps, the deepest {:.3g} m\n",
                       t.collisions.pairs_touching, t.collisions.overlaps, t.collisions.deepest);
  out += solids_text(s);
  if (s.surgery) out += surgery_text(*s.surgery);
  if (s.statistics) out += statistics_text(*s.statistics) + residence_text(s);
  if (s.cancelled) out += fmt::format("cancelled after {} steps\n", s.steps);
  if (s.audit) out += fmt::format("audit: {} checked, {} failed\n", s.audit->checked, s.audit->failed);
  return out + fmt::format("state hash: {}\n", s.state_hash);
}

std::string histogram_text(const Summary& s) {
  const Counters& c = s.totals.counters;
  std::string out = "orientation tests: share of particle-steps\n";
  for (std::size_t i = 0; i < c.histogram.size(); ++i) {
    if (c.histogram[i] > 0) out += fmt::format("{:4}: {:.4f}%\n", i, 100.0 * ratio(c.histogram[i], c.particle_steps));
  }
  return out;
}

}  // namespace dartcast
