// The summary of a run for people: a table of two columns, a subject and what there is to say of it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/run.hpp"
#include "output/summary.hpp"
#include "report/grouped.hpp"

namespace dartcast {

namespace {

class SummaryTable {
 public:
  // A subject of several lines is named in the first of them.
  void add(std::string_view subject, const std::string& line) {
    text_ += fmt::format("{:<13}{}\n", subject == subject_ ? "" : subject, line);
    subject_ = subject;
  }
  // Short facts in a row; those that do not fit go to the next line.
  void add(std::string_view subject, const std::vector<std::string>& facts) {
    std::string line;
    for (const std::string& fact : facts) {
      if (!line.empty() && line.size() + fact.size() > 84) {
        add(subject, line);
        line.clear();
      }
      line += (line.empty() ? "" : "   ") + fact;
    }
    if (!line.empty()) add(subject, line);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::string subject_;
};

// The extent of the mesh, which is in metres, and what looks as if it were in another unit.
void add_scale(SummaryTable& table, const Summary& s) {
  table.add("environment",
            {fmt::format("from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m", s.low.x, s.low.y, s.low.z,
                         s.high.x, s.high.y, s.high.z),
             fmt::format("edges of cells: smallest {:.3g} m, mean {:.3g} m", s.smallest_edge, s.mean_edge)});
  const Vec3 sides = s.high - s.low;
  const double size = std::max({sides.x, sides.y, sides.z});
  if (s.mean_edge > 0.0 && (size > 1000.0 || size < 1e-5))
    table.add("environment",
              fmt::format("warning: the mesh is {:.3g} m across: does its file have metres? The key scale "
                          "multiplies its lengths",
                          size));
  if (s.far_steps > 0)
    table.add("environment", fmt::format("warning: {} steps of particles were longer than 100 cells: are scale, dt and "
                                         "velocities right?",
                                         grouped(s.far_steps)));
}

void add_scene(SummaryTable& table, const Summary& s) {
  std::string with = fmt::format("{} thread{}", s.threads, s.threads == 1 ? "" : "s");
  if (s.ranks > 1) with = fmt::format("{} processes of {}", s.ranks, with);
  table.add("scene", fmt::format("{}: {} steps with {}", s.scene, grouped(s.steps), with));
  if (s.cancelled) table.add("scene", fmt::format("cancelled after {} steps", grouped(s.steps)));
  table.add("environment", {fmt::format("{} cells ({} free)", grouped(s.cells), grouped(s.free_cells)),
                            fmt::format("{} wall faces", grouped(s.wall_faces)),
                            fmt::format("{:.1f} MB", static_cast<double>(s.bytes) / 1e6)});
  add_scale(table, s);
  if (s.skipped.count > 0)
    table.add("environment", fmt::format("{} {}; the first: {}", grouped(s.skipped.count), s.skipped.message,
                                         fmt::join(s.skipped.first, ", ")));
  for (const Finding& warning : s.warnings)
    table.add("environment", fmt::format("warning: {} {}", grouped(warning.count), warning.message));
}

void add_particle_rows(SummaryTable& table, const Summary& s) {
  const SimulationTotals& t = s.totals;
  if (t.start + t.injected == 0) return;
  table.add("particles", {grouped(t.start) + " at the start", grouped(t.injected) + " injected",
                          grouped(t.escaped) + " escaped", grouped(t.absorbed) + " absorbed"});
  table.add("particles", {grouped(s.alive) + " alive", grouped(s.held) + " held", grouped(s.lost) + " lost"});
}

void add_contact_rows(SummaryTable& table, const Summary& s) {
  if (s.totals.start + s.totals.injected == 0) return;
  const auto& kinds = s.totals.counters.contacts;
  table.add("contacts", {grouped(kinds[0] + kinds[1] + kinds[2]) + " in all", grouped(kinds[2]) + " with faces",
                         grouped(kinds[1]) + " with edges", grouped(kinds[0]) + " with vertices"});
  std::vector<std::string> patches;
  const std::vector<std::uint64_t>& by_patch = s.totals.contacts_by_patch;
  for (std::size_t i = 0; i < by_patch.size(); ++i) {
    if (by_patch[i] > 0)
      patches.push_back(fmt::format("{} {}", i == 0 ? "no patch" : s.patch_names[i], grouped(by_patch[i])));
  }
  if (patches.size() > 1) table.add("contacts", patches);
  for (const Deposition& d : depositions(s)) {
    if (d.deposited == 0) continue;
    std::string row = fmt::format("{}: {} ({:.2f} %)", d.patch.empty() ? "no patch" : d.patch, grouped(d.deposited),
                                  100.0 * d.fraction);
    if (d.area > 0.0) row += fmt::format(", {:.4g} per unit of area", d.per_area);
    table.add("deposition", row);
  }
  const CollisionCounts& c = s.totals.collisions;
  if (c.pairs_tested > 0)
    table.add("collisions", fmt::format("{} touching pairs, {} overlaps, the deepest {:.3g} m",
                                        grouped(c.pairs_touching), grouped(c.overlaps), c.deepest));
}

void add_cost(SummaryTable& table, const Summary& s) {
  const SimulationTotals& t = s.totals;
  const Counters& c = t.counters;
  if (c.particle_steps > 0) {
    std::vector<std::string> step;
    if (counts_tests(c))
      step = {fmt::format("{:.2f} orientation tests", ratio(c.orientation.tests, c.particle_steps)),
              fmt::format("forecast kept in {:.1f} %", 100.0 * ratio(c.forecast_kept, c.particle_steps))};
    step.push_back(fmt::format("{:.0f} ns a particle in all", ns_per_particle_step(s)));
    table.add("a step", step);
  }
  std::vector<std::string> parts;
  const auto add = [&](std::string_view part, double seconds) {
    if (seconds >= 0.005) parts.push_back(fmt::format("{} {:.2f}", part, seconds));
  };
  add("load", s.seconds_load);
  add("locate", s.seconds_locate);
  add("detect", t.seconds_detect);
  add("deform", t.seconds_deform);
  add("collide", t.seconds_collide);
  add("respond", t.seconds_respond);
  if (has_solids(s)) add("solids", s.seconds_solids);
  if (s.statistics) add("statistics", s.statistics->seconds);
  add("write", s.seconds_write);
  add("report", s.seconds_report);
  table.add("seconds", parts);
}

void add_solids(SummaryTable& table, const Summary& s) {
  for (const BodySummary& b : s.bodies) {
    table.add("bodies", b.gone
                            ? fmt::format("{}: left at a wall", b.name)
                            : fmt::format("{}: {} particles, centre ({:.4g}, {:.4g}, {:.4g}), kinetic energy {:.3g} J",
                                          b.name, b.particles, b.centre.x, b.centre.y, b.centre.z, b.energy.kinetic));
  }
  for (const CatheterSummary& c : s.catheters) {
    table.add("catheters", fmt::format("{}: {:.4g} m inserted, its length {:.4g} m (worst segment off by {:.2f} %)",
                                       c.name, c.inserted, c.measured_length, 100.0 * c.totals.worst_segment));
    table.add("catheters", fmt::format("{:.3g} m of pushes refused, tip ({:.4g}, {:.4g}, {:.4g})", c.totals.refused,
                                       c.tip.x, c.tip.y, c.tip.z));
  }
}

void add_tools(SummaryTable& table, const Summary& s) {
  for (const SolidSummary& solid : s.solids) {
    table.add("solids",
              fmt::format("{}: {} vertices, {} contacts, stopped in {} steps{}, pivot ({:.4g}, {:.4g}, {:.4g})",
                          solid.name, solid.vertices, grouped(solid.contacts), grouped(solid.stopped),
                          solid.stuck ? " and stuck" : "", solid.pivot.x, solid.pivot.y, solid.pivot.z));
  }
}

void add_edits(SummaryTable& table, const EventLog& log) {
  for (const EventReport& e : log.events) {
    if (!e.refused.empty()) {
      table.add("events",
                fmt::format("{} at {:.6g} s: refused, nothing changed: {}", name_of(e.kind), e.time, e.refused));
      continue;
    }
    table.add("events", fmt::format("{} at {:.6g} s: {} cells replaced by {}, {} opened, {} blocked", name_of(e.kind),
                                    e.time, grouped(e.cells_removed), grouped(e.cells_added), grouped(e.cells_opened),
                                    grouped(e.cells_blocked)));
    table.add("events",
              fmt::format("  particles: {} located again, {} moved, {} held, {} absorbed, {} in opened cells before",
                          grouped(e.particles_located), grouped(e.particles_moved), grouped(e.particles_held),
                          grouped(e.particles_absorbed), grouped(e.particles_in_opened)));
  }
  if (log.mended + log.left > 0)
    table.add("remeshing",
              fmt::format("{} regions mended, {} cells left as they were", grouped(log.mended), grouped(log.left)));
  if (log.subdivided + log.refused > 0)
    table.add("crowding", fmt::format("{} cells subdivided, {} made again, {} left as they were",
                                      grouped(log.subdivided), grouped(log.merged), grouped(log.refused)));
  if (log.in_opened > 0)
    table.add("opened", fmt::format("{} particles in opened cells at the end", grouped(log.in_opened)));
}

void add_residence(SummaryTable& table, const Summary& s) {
  const auto add = [&](std::string_view how, std::string_view where, const ResidenceTimes& t) {
    if (t.count > 0)
      table.add("residence",
                fmt::format("{} {}: {} particles after {:.4g} s on average", how,
                            where.empty() ? std::string_view("without a patch") : where, grouped(t.count), t.mean()));
  };
  for (std::size_t i = 0; i < s.statistics->left.size(); ++i) {
    add("escaped at", s.patch_names[i], s.statistics->left[i].escaped);
    add("absorbed at", s.patch_names[i], s.statistics->left[i].absorbed);
  }
  add("absorbed by", "edits", s.statistics->absorbed_by_edits);
}

void add_statistics(SummaryTable& table, const Summary& s) {
  const StatisticsSummary& all = *s.statistics;
  if (all.options.hits)
    table.add("hits", fmt::format("{} on {} wall faces, {} on faces that edits ended",
                                  grouped(sum(all.hits_by_patch) - sum(all.ended_by_patch)), grouped(all.hit_faces),
                                  grouped(sum(all.ended_by_patch))));
  for (std::size_t i = 0; i < all.planes.size(); ++i)
    table.add("planes", fmt::format("{}: {} forward after {:.4g} s on average, {} backward", all.options.planes[i].name,
                                    grouped(all.planes[i].forward.count), all.planes[i].forward.mean(),
                                    grouped(all.planes[i].backward.count)));
  add_residence(table, s);
}

}  // namespace

std::string summary_text(const Summary& s) {
  check_summary(s);
  SummaryTable table;
  add_scene(table, s);
  add_particle_rows(table, s);
  add_contact_rows(table, s);
  add_cost(table, s);
  add_solids(table, s);
  add_tools(table, s);
  if (s.surgery) add_edits(table, *s.surgery);
  if (s.statistics) add_statistics(table, s);
  if (s.audit) table.add("audit", {grouped(s.audit->checked) + " checked", grouped(s.audit->failed) + " failed"});
  table.add("state hash", s.state_hash);
  return table.text();
}

std::string histogram_text(const Summary& s) {
  const Counters& c = s.totals.counters;
  if (!counts_tests(c)) return "orientation tests: not counted\n";
  std::string out = "orientation tests: share of particle-steps\n";
  for (std::size_t i = 0; i < c.histogram.size(); ++i) {
    if (c.histogram[i] > 0) out += fmt::format("{:4}: {:.4f}%\n", i, 100.0 * ratio(c.histogram[i], c.particle_steps));
  }
  return out;
}

}  // namespace dartcast
