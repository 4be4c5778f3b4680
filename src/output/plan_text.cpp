// Writes plans.
#include "output/plan_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace dartcast {

namespace {

std::string line(const char* what, const RankSpread& s, const char* note = "") {
  return fmt::format("{:<13}{:.4g} in the mean, {:.4g} at most{}\n", what, s.mean, s.largest, note);
}

nlohmann::ordered_json json_of(const RankSpread& s) { return {{"mean", s.mean}, {"largest", s.largest}}; }

}  // namespace

std::string plan_text(const RunPlan& p) {
  const PlanOptions& o = p.options;
  constexpr double gigabyte = 1e9;
  constexpr double milli = 1e3;
  std::string text = fmt::format("{:<13}{}, each with {:.4g} particles\n", "ranks", o.ranks, o.particles);
  text += line("cells", p.cells);
  text +=
      line("ghosts", p.ghosts, fmt::format(" ({:.1f}% of the cells)", 100.0 * p.ghosts.mean / p.cells.mean).c_str());
  text += line("neighbours", p.neighbours);
  text += line("memory", {p.bytes.mean / gigabyte, p.bytes.largest / gigabyte}, " (GB)");
  text += line("sent", p.sent, fmt::format(" (particles a step, {:.0f} bytes each)", p.sent_bytes).c_str());
  text += fmt::format("{:<13}{:.3g} us latency, {:.3g} GB/s\n", "network", 1e6 * o.latency, o.bandwidth / gigabyte);
  text += fmt::format(
      "{:<13}{:.3g} ms: walks {:.3g}, packing {:.3g}, messages {:.3g}, sums and gathers {:.3g}; alone {:.3g} ms\n",
      "step", milli * p.seconds(), milli * p.seconds_walk, milli * p.seconds_pack, milli * p.seconds_messages,
      milli * p.seconds_all, milli * p.seconds_alone);
  text += fmt::format("{:<13}{:.1f}% (weak scaling)\n", "efficiency", 100.0 * p.efficiency());
  return text;
}

std::string plan_json(const RunPlan& p) {
  const PlanOptions& o = p.options;
  nlohmann::ordered_json json;
  json["ranks"] = o.ranks;
  json["particles"] = o.particles;
  json["step"] = o.step;
  json["deforms"] = o.deforms;
  json["network"] = {{"latency", o.latency}, {"bandwidth", o.bandwidth}};
  json["cells"] = json_of(p.cells);
  json["ghosts"] = json_of(p.ghosts);
  json["neighbours"] = json_of(p.neighbours);
  json["bytes"] = json_of(p.bytes);
  json["sent"] = json_of(p.sent);
  json["sent_bytes"] = p.sent_bytes;
  json["rounds"] = p.rounds;
  json["seconds"] = {{"step", p.seconds()},          {"walk", p.seconds_walk},
                     {"pack", p.seconds_pack},       {"messages", p.seconds_messages},
                     {"collectives", p.seconds_all}, {"alone", p.seconds_alone}};
  json["efficiency"] = p.efficiency();
  return json.dump();
}

}  // namespace dartcast
