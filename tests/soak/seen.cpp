// Counts features and pairs of them, and writes the table.
#include "soak/seen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dartcast::soak {

namespace {

struct Feature {
  std::string name;
  std::size_t group;  // features of one group exclude each other; events are groups of their own
};

// All features: the values of knobs that have names, then the events.
const std::vector<Feature>& features() {
  static const std::vector<Feature> all = [] {
    std::vector<Feature> list;
    std::size_t group = 0;
    for (const KnobText& t : knob_texts()) {
      for (const std::string_view v : t.values) list.push_back({fmt::format("{}: {}", t.name, v), group});
      ++group;
    }
    for (std::size_t e = 0; e < mark_count; ++e) list.push_back({std::string(name_of(static_cast<Mark>(e))), group++});
    return list;
  }();
  return all;
}

std::size_t first_mark() { return features().size() - mark_count; }

// Pairs that cannot be: the starts of both names.
struct Impossible {
  std::vector<std::string_view> one, others;
  std::string_view why;
};
Impossible of_pairs() {
  return {{"periodic: one axis", "periodic: all axes", "periodic: turned"},
          {"mover: solids",
           "mover: bodies",
           "mover: catheter",
           "edit: mark",
           "edit: merge",
           "edit: subdivide",
           "edit: coarsen",
           "edit: split",
           "edit: plane",
           "edit: carve",
           "edit: open faces",
           "edit: sew",
           "edit: remesh",
           "edit: rebuild",
           "edit: all",
           "simultaneous: on",
           "spheres: on",
           "surface: on",
           "an edit",
           "contact of a",
           "a solid stuck",
           "a catheter pushed",
           "a sphere in a wall",
           "two solids",
           "a replay",
           "mesh: patchwork",
           "mesh: octahedra",
           "mesh: slivers",
           "mesh: vessel",
           "mesh: maze",
           "motion: turn",
           "motion: twist",
           "motion: wave",
           "a cell of nine faces",
           "a Steiner point",
           "a simulation shared by cells",
           "walls that were stopped"},
          "scenes with pairs refuse these, or have other meshes and motions"};
}
const std::vector<Impossible>& impossible() {
  static const std::vector<Impossible> list = {
      {{"mesh: plane", "mesh: maze"},
       {"a catheter pushed", "a cell of nine faces", "a simulation shared by cells", "a solid stuck", "an inlet",
        "contact of a", "contact with a face", "walls that were stopped"},
       "these are of space"},
      {{"mover: environment", "mover: solids", "mover: bodies", "mover: catheter"},
       {"a field", "a simulation shared by cells", "an inlet", "statistics", "a diffusivity"},
       "only a simulation has these"},
      {{"mover: environment"},
       {"a catheter pushed", "a solid stuck", "contact of a", "walls that were stopped"},
       "the environment moves the vertices itself"},
      {{"mover: solids"}, {"a catheter pushed", "contact of a body"}, "there are only solids"},
      {{"mover: bodies"}, {"a catheter pushed", "contact of a solid"}, "there are only bodies"},
      {{"mover: catheter"}, {"contact of a"}, "there is only a catheter"},
      {{"motion: rest"}, {"a step in slices", "walls that were stopped"}, "walls are at rest"},
      {{"response: stop"},
       {"a step not finished", "more than three contacts"},
       "a particle stops at its first contact"},
      {{"ranks: off"}, {"a simulation shared by cells"}, "there is one process"},
      {{"spheres: off"}, {"a sphere in a wall"}, "there are no spheres"},
      {{"throws: off"}, {"a call that threw"}, "nothing throws"},
      {{"a Steiner point"},
       {"a replay", "a simulation shared by cells"},
       "replays make these points anew; ranks refuse them"},
      {{"edit: none", "edit: rebuild"}, {"an edit refused", "a solid stuck"}, "nothing is edited"},
      {{"edit: none"}, {"an edit just made"}, "nothing is edited"},
      of_pairs(),
      {{"periodic: off"}, {"a passage through"}, "there are no pairs"},
      {{"meets: off"}, {"two solids"}, "solids pass through each other"},
      {{"mover: environment", "mover: bodies", "mover: catheter", "mesh: plane", "mesh: maze"},
       {"two solids"},
       "there are no solids"},
  };
  return list;
}

bool is_one(const std::vector<std::string_view>& starts, const std::string& name) {
  return std::any_of(starts.begin(), starts.end(), [&](std::string_view start) { return name.starts_with(start); });
}
bool cannot_be(const std::string& a, const std::string& b) {
  return std::any_of(impossible().begin(), impossible().end(), [&](const Impossible& pair) {
    return (is_one(pair.one, a) && is_one(pair.others, b)) || (is_one(pair.one, b) && is_one(pair.others, a));
  });
}

}  // namespace

std::string_view name_of(Mark e) {
  switch (e) {
    case Mark::face_contact: return "contact with a face";
    case Mark::edge_contact: return "contact with an edge";
    case Mark::vertex_contact: return "contact with a vertex";
    case Mark::several_walls: return "several walls at once";
    case Mark::many_contacts: return "more than three contacts in a step";
    case Mark::held: return "a particle held";
    case Mark::slices: return "a step in slices";
    case Mark::unfinished: return "a step not finished";
    case Mark::invalid_cells: return "cells that are not valid";
    case Mark::after_edit: return "an edit just made";
    case Mark::refused_edit: return "an edit refused";
    case Mark::thrown: return "a call that threw";
    case Mark::walls_stopped: return "walls that were stopped";
    case Mark::solid_contact: return "contact of a solid";
    case Mark::stuck: return "a solid stuck";
    case Mark::edge_of_body: return "contact of a body's edge";
    case Mark::pushed_catheter: return "a catheter pushed";
    case Mark::large_polyhedron: return "a cell of nine faces or more";
    case Mark::steiner_point: return "a Steiner point";
    case Mark::overlap: return "a sphere in a wall";
    case Mark::left: return "a particle left or absorbed";
    case Mark::field: return "a field of velocities";
    case Mark::inlet: return "an inlet";
    case Mark::statistics: return "statistics";
    case Mark::by_cells: return "a simulation shared by cells";
    case Mark::taken_again: return "a replay";
    case Mark::passage: return "a passage through a periodic face";
    case Mark::meeting: return "two solids meeting";
    case Mark::varying_diffusion: return "a diffusivity that varies";
  }
  return {};
}

void Seen::begin(const Case& c) {
  case_features_.reset();
  step_features_.reset();
  std::size_t at = 0;
  for (const KnobText& t : knob_texts()) {
    if (!t.values.empty()) case_features_.set(at + c[t.knob]);
    at += t.values.size();
  }
  ++counts_.cases;
}

void Seen::note(Mark e) { step_features_.set(first_mark() + static_cast<std::size_t>(e)); }

void Seen::end_step(std::uint64_t particles) {
  const Features on = case_features_ | step_features_;
  for (std::size_t i = 0; i < features().size(); ++i)
    for (std::size_t j = i; on[i] && j < features().size(); ++j)
      if (on[j]) ++counts_.pairs[i][j];
  step_features_.reset();
  ++counts_.steps;
  counts_.particle_steps += particles;
}

Counts& Counts::operator+=(const Counts& other) {
  cases += other.cases;
  steps += other.steps;
  particle_steps += other.particle_steps;
  true_steps += other.true_steps;
  for (std::size_t i = 0; i < most; ++i)
    for (std::size_t j = 0; j < most; ++j) pairs[i][j] += other.pairs[i][j];
  return *this;
}

std::string table_of(const Counts& counts) {
  const auto& all = features();
  std::string text = "| feature | steps | rarest other feature | steps with both |\n| --- | ---: | --- | ---: |\n";
  std::string never;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::uint64_t least = ~std::uint64_t{0};
    std::size_t rarest = i;
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (all[i].group == all[j].group || cannot_be(all[i].name, all[j].name)) continue;
      const std::uint64_t both = counts.pairs[std::min(i, j)][std::max(i, j)];
      if (both == 0 && i < j) never += fmt::format("  {} / {}\n", all[i].name, all[j].name);
      if (both >= least) continue;
      least = both;
      rarest = j;
    }
    text += fmt::format("| {} | {} | {} | {} |\n", all[i].name, counts.pairs[i][i], all[rarest].name, least);
  }
  text += "\nPairs that were never on together:\n" + (never.empty() ? "  none\n" : never);
  text += "\nPairs that cannot be:\n";
  for (const Impossible& pair : impossible())
    text += fmt::format("- {} with {}: {}.\n", fmt::join(pair.one, ", "), fmt::join(pair.others, ", "), pair.why);
  return text;
}

}  // namespace dartcast::soak
