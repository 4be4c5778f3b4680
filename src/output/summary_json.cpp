// The summary of a run, as JSON.
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "dartcast/run.hpp"
#include "output/summary.hpp"

namespace dartcast {

namespace {

using Json = nlohmann::ordered_json;

// Each is null if not all were counted.
Json orientation_tests(const Summary& s) {
  const Counters& c = s.totals.counters;
  std::size_t size = c.histogram.size();
  while (size > 1 && c.histogram[size - 1] == 0) --size;
  Json json = {{"mean", ratio(c.orientation.tests, c.particle_steps)},
               {"histogram", std::vector<std::uint64_t>(c.histogram.begin(),
                                                        c.histogram.begin() + static_cast<std::ptrdiff_t>(size))},
               {"exact_share", ratio(c.orientation.exact, c.orientation.tests)},
               {"forecast_kept_share", ratio(c.forecast_kept, c.particle_steps)}};
  if (s.deforms) json["updated_by_deformation_share"] = ratio(c.updated_by_deformation, c.particle_steps);
  if (!counts_tests(c)) {
    for (Json& value : json) value = nullptr;
  } else if (c.orientation.tests == 0) {
    json.erase("exact_share");
  }
  return json;
}

// Values by the name of the patch; those without a patch if there are any.
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

Json deposition(const Summary& s) {
  Json json = Json::object();
  for (const Deposition& d : depositions(s)) {
    json[d.patch] = {{"deposited", d.deposited}, {"escaped", d.escaped}, {"fraction", d.fraction}};
    if (d.area > 0.0) json[d.patch]["per_area"] = d.per_area;
  }
  return json;
}

Json seconds(const Summary& s) {
  Json json = {{"load", s.seconds_load}, {"locate", s.seconds_locate}, {"detect", s.totals.seconds_detect}};
  if (s.deforms) json["deform"] = s.totals.seconds_deform;
  if (s.totals.seconds_collide > 0.0) json["collide"] = s.totals.seconds_collide;
  json["respond"] = s.totals.seconds_respond;
  if (has_solids(s)) json["solids"] = s.seconds_solids;
  if (s.statistics) json["statistics"] = s.statistics->seconds;
  json["write"] = s.seconds_write;
  json["writing_thread"] = s.seconds_writing_thread;
  if (s.seconds_report > 0.0) json["report"] = s.seconds_report;
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
    if (!e.refused.empty()) list.back()["refused"] = e.refused;
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

Json solids(const std::vector<SolidSummary>& all) {
  Json list = Json::array();
  for (const SolidSummary& s : all) {
    list.push_back({{"name", s.name},
                    {"vertices", s.vertices},
                    {"pivot", vector(s.pivot)},
                    {"contacts", s.contacts},
                    {"stopped_steps", s.stopped},
                    {"stuck", s.stuck}});
  }
  return list;
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
Json residence_at(std::span<const LeaveTotals> left, const std::vector<std::string>& patches) {
  Json json = {{"escaped", Json::object()}, {"absorbed", Json::object()}};
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left[i].escaped.count > 0) json["escaped"][patches[i]] = residence_time(left[i].escaped);
    if (left[i].absorbed.count > 0) json["absorbed"][patches[i]] = residence_time(left[i].absorbed);
  }
  return json;
}

Json residence(const Summary& s) {
  const StatisticsSummary& all = *s.statistics;
  Json json = residence_at(all.left, s.patch_names);
  for (std::size_t i = 0; i < all.left_by_class.size(); i += all.left.size())
    json["by_class"].push_back(residence_at(std::span(all.left_by_class).subspan(i, all.left.size()), s.patch_names));
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

}  // namespace

std::string summary_json(const Summary& s) {
  check_summary(s);
  const SimulationTotals& t = s.totals;
  Json json = {{"version", version()},
               {"scene", s.scene},
               {"threads", s.threads},
               {"ranks", s.ranks},
               {"steps", s.steps},
               {"particle_steps", t.counters.particle_steps},
               {"environment",
                {{"cells", s.cells},
                 {"free_cells", s.free_cells},
                 {"vertices", s.vertices},
                 {"wall_faces", s.wall_faces},
                 {"bytes", s.bytes},
                 {"bounds", {vector(s.low), vector(s.high)}},
                 {"smallest_edge", s.smallest_edge},
                 {"mean_edge", s.mean_edge}}},
               {"particles",
                {{"start", t.start},
                 {"injected", t.injected},
                 {"absorbed", t.absorbed},
                 {"escaped", t.escaped},
                 {"alive", s.alive},
                 {"held", s.held},
                 {"lost", s.lost}}}};
  if (s.skipped.count > 0) json["environment"]["bad_cells"] = {{"count", s.skipped.count}, {"first", s.skipped.first}};
  for (const Finding& f : s.warnings)
    json["environment"]["warnings"].push_back({{"kind", f.kind}, {"count", f.count}, {"message", f.message}});
  if (s.surgery) {
    json["particles"]["in_opened"] = s.surgery->in_opened;
    json["events"] = events(*s.surgery);
    json["remeshing"] = {{"mended", s.surgery->mended}, {"left", s.surgery->left}};
    json["crowding"] = {
        {"subdivided", s.surgery->subdivided}, {"merged", s.surgery->merged}, {"refused", s.surgery->refused}};
  }
  if (t.collisions.pairs_tested + t.wall_overlaps > 0) json["collisions"] = collisions(t);
  if (t.start + t.injected > 0) json["energy_unit"] = s.has_masses ? "J" : "J/kg";
  if (!s.bodies.empty()) json["bodies"] = bodies(s.bodies);
  if (!s.catheters.empty()) json["catheters"] = catheters(s.catheters);
  if (!s.solids.empty()) json["tools"] = solids(s.solids);
  if (t.counters.particle_steps > 0) json["orientation_tests"] = orientation_tests(s);
  json["contacts"] = contacts(s);
  if (t.start + t.injected > 0) json["deposition"] = deposition(s);
  if (s.statistics) json["statistics"] = statistics(s);
  json["seconds"] = seconds(s);
  if (t.counters.particle_steps > 0) json["ns_per_particle_step"] = ns_per_particle_step(s);
  if (s.cancelled) json["cancelled"] = true;
  if (s.audit) json["audit"] = {{"checked", s.audit->checked}, {"failed", s.audit->failed}};
  if (!s.replay.empty()) json["replay"] = s.replay.string();
  json["state_hash"] = s.state_hash;
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace dartcast
