// Draws cases, and writes and reads them.
#include "soak/case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "base/random.hpp"
#include "dartcast/error.hpp"

namespace dartcast::soak {

std::span<const KnobText> knob_texts() {
  static const std::vector<KnobText> texts = {
      {Knob::mesh,
       "mesh",
       {"hexahedra", "one cell", "tetrahedra", "prisms", "pyramids", "mixed", "patchwork", "octahedra", "slivers",
        "vessel", "plane", "maze", "10^4 cells"}},
      {Knob::size, "size", {}, 3},
      {Knob::walls, "walls", {"sides", "a few cells", "many cells", "baffles"}},
      {Knob::edit,
       "edit",
       {"none", "mark", "merge", "subdivide", "coarsen", "split", "plane", "carve", "open faces", "sew", "remesh",
        "rebuild", "all"}},
      {Knob::edits, "edits", {}, 24},
      {Knob::state, "state", {"as it is", "copied", "restored", "removed and reordered"}},
      {Knob::motion,
       "motion",
       {"rest", "turn", "twist", "wave", "frames", "near inversion", "inversion and back", "infinite vertices"}},
      {Knob::mover, "mover", {"environment", "solids", "bodies", "catheter", "simulation"}},
      {Knob::steps, "steps", {}, 12},
      {Knob::first, "first", {}, 20000},
      {Knob::particles, "particles", {}, 20000},
      {Knob::places, "places", {"at random", "at vertices", "mixed"}},
      {Knob::targets, "targets", {"at random", "lattice", "vertices", "mixed"}},
      {Knob::length, "length", {"a cell", "10^-6 cells", "300 cells", "mixed"}},
      {Knob::response, "response", {"stop", "reflect", "slide", "stick", "absorb", "any answer", "into the wall"}},
      {Knob::threads, "threads", {"1", "2", "4"}},
      {Knob::rounds, "rounds", {"off", "on"}},
      {Knob::simultaneous, "simultaneous", {"off", "on"}},
      {Knob::spheres, "spheres", {"off", "on"}},
      {Knob::ranks, "ranks", {"off", "2", "3"}},
      {Knob::throws, "throws", {"off", "on"}},
      {Knob::surface, "surface", {"off", "on"}},
      {Knob::periodic, "periodic", {"off", "one axis", "all axes", "turned"}},
      {Knob::meets, "meets", {"off", "on"}},
  };
  return texts;
}

namespace {

const KnobText& text_of(Knob k) { return knob_texts()[static_cast<std::size_t>(k)]; }

const KnobText& knob_named(std::string_view name) {
  for (const KnobText& t : knob_texts())
    if (t.name == name) return t;
  throw Error(fmt::format("there is no knob '{}'", name));
}

std::uint64_t number_of(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) throw Error(fmt::format("'{}' is no number", text));
  return number;
}

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::string_view Case::name(Knob k) const {
  const KnobText& t = text_of(k);
  return t.values.empty() ? std::string_view{} : t.values[(*this)[k]];
}

Case draw_case(std::uint64_t seed) {
  Random random(seed, 1);
  Case c;
  c.seed = seed;
  for (const KnobText& t : knob_texts()) c[t.knob] = random.below(t.count());
  // Large meshes take long, and what is on in all steps hides what is not.
  if (c.is(Knob::mesh, "10^4 cells") && random.below(8) != 0) c[Knob::mesh] = random.below(9);
  if (c.is(Knob::edit, "none") || random.below(3) == 0) c[Knob::edits] = random.below(4);
  c[Knob::steps] = 1 + random.below(6);
  c[Knob::first] = 0;
  c[Knob::particles] = 8 + random.below(random.below(4) == 0 ? 392 : 72);
  for (const Knob k : {Knob::mover, Knob::ranks, Knob::throws, Knob::simultaneous, Knob::spheres, Knob::state})
    if (random.below(2) == 0) c[k] = 0;
  if (random.below(3) != 0) c[Knob::periodic] = 0;
  // A crowd costs little beside the edits and the checks of cells. The first seeds are a short test.
  if (seed > 1000 && random.below(6) == 0 && !c.is(Knob::mover, "simulation"))
    c[Knob::particles] = 1000 + random.below(19000);
  return c;
}

// Scenes with periodic pairs refuse edits, and all but points. Their meshes are boxes, which move so that pairs fit.
Case admitted(Case c) {
  if (c[Knob::periodic] == 0) return c;
  for (const Knob k : {Knob::edit, Knob::edits, Knob::simultaneous, Knob::spheres, Knob::surface}) c[k] = 0;
  if (!c.is(Knob::mover, "simulation")) c[Knob::mover] = c[Knob::ranks] = 0;
  c[Knob::particles] = std::min(c[Knob::particles], 1000U);  // a long way has hundreds of passages
  if (c.is(Knob::mesh, "patchwork") || c.is(Knob::mesh, "octahedra")) set(c, "mesh = mixed");
  if (c.is(Knob::mesh, "slivers")) set(c, "mesh = tetrahedra");
  if (c.is(Knob::mesh, "vessel")) set(c, "mesh = hexahedra");
  if (c.is(Knob::mesh, "maze")) set(c, "mesh = plane");
  if (c.is(Knob::motion, "turn") || c.is(Knob::motion, "twist") || c.is(Knob::motion, "wave"))
    set(c, "motion = frames");
  return c;
}

std::string text_of(const Case& c) {
  std::string text = fmt::format("seed = {}\n", c.seed);
  for (const KnobText& t : knob_texts()) {
    if (c[t.knob] == 0) continue;
    text += t.values.empty() ? fmt::format("{} = {}\n", t.name, c[t.knob])
                             : fmt::format("{} = {}\n", t.name, t.values[c[t.knob]]);
  }
  return text;
}

void set(Case& c, const std::string& assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos) throw Error(fmt::format("'{}': write KNOB = VALUE", assignment));
  const std::string_view name = trimmed(std::string_view(assignment).substr(0, equals));
  const std::string_view value = trimmed(std::string_view(assignment).substr(equals + 1));
  if (name == "seed") {
    c.seed = number_of(value);
    return;
  }
  const KnobText& t = knob_named(name);
  if (t.values.empty()) {
    const std::uint64_t amount = number_of(value);
    if (amount > t.most) throw Error(fmt::format("{} is {}: at most {}", name, amount, t.most));
    c[t.knob] = static_cast<std::uint32_t>(amount);
    return;
  }
  const auto at = std::find(t.values.begin(), t.values.end(), value);
  if (at == t.values.end()) throw Error(fmt::format("{} has no value '{}'", name, value));
  c[t.knob] = static_cast<std::uint32_t>(at - t.values.begin());
}

Case case_of(const std::string& text) {
  Case c;
  std::istringstream lines(text);
  std::string line;
  for (unsigned number = 1; std::getline(lines, line); ++number) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content[0] == '#') continue;
    try {
      set(c, std::string(content));
    } catch (const Error& e) {
      throw Error(fmt::format("line {}: {}", number, e.what()));
    }
  }
  return c;
}

}  // namespace dartcast::soak
