// A case: a few small numbers from which a scene and all steps in it follow. Two equal cases take equal steps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast::soak {

/// The choices of a case. Each is a number below the number of its values; 0 is the simplest.
enum class Knob : std::uint8_t {
  mesh,          ///< the cells
  size,          ///< of the mesh
  walls,         ///< blocked cells, baffles
  edit,          ///< the kind of edits
  edits,         ///< how many before the first step, and how many between steps
  state,         ///< what happens to the particles before each step
  motion,        ///< of the vertices
  mover,         ///< who moves the vertices
  steps,         ///< how many
  first,         ///< the first particle: those before it are left out
  particles,     ///< how many
  places,        ///< where the particles begin
  targets,       ///< where they head for
  length,        ///< of the ways
  response,      ///< of walls
  threads,       ///< how many
  rounds,        ///< whether contacts are answered in rounds, too
  simultaneous,  ///< whether points and walls move at the same time, too
  spheres,       ///< whether there are spheres
  ranks,         ///< how many share the cells
  throws,        ///< whether responses and edits throw in their middle
  surface,       ///< whether particles step on the walls, too
  periodic,      ///< which sides lead to each other
  meets          ///< whether solids meet each other
};
inline constexpr std::size_t knob_count = 24;

/// A knob's name and the names of its values. A knob whose values are amounts has one name and a number of values.
struct KnobText {
  Knob knob;
  std::string_view name;
  std::vector<std::string_view> values;  ///< empty: amounts
  std::uint32_t most = 0;                ///< of amounts
  [[nodiscard]] std::uint32_t count() const { return values.empty() ? most + 1 : std::uint32_t(values.size()); }
};
std::span<const KnobText> knob_texts();

struct Case {
  std::uint64_t seed = 1;
  std::array<std::uint32_t, knob_count> values{};

  std::uint32_t& operator[](Knob k) { return values[static_cast<std::size_t>(k)]; }
  std::uint32_t operator[](Knob k) const { return values[static_cast<std::size_t>(k)]; }
  /// The name of a knob's value.
  [[nodiscard]] std::string_view name(Knob k) const;
  [[nodiscard]] bool is(Knob k, std::string_view value) const { return name(k) == value; }
  bool operator==(const Case&) const = default;
};

/// The case with what its features admit beside each other: others are turned off.
Case admitted(Case c);

/// The case of a seed.
Case draw_case(std::uint64_t seed);

/// A line for each number that is not 0.
std::string text_of(const Case& c);
/// The case of such a text. Lines with # are comments. Throws Error, which names the line.
Case case_of(const std::string& text);
/// Sets a knob to the value of a name, or to an amount: `mesh=one cell`. Throws Error.
void set(Case& c, const std::string& assignment);

}  // namespace dartcast::soak
