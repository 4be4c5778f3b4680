// The features that steps have had: how often each, and how often each two at once.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/step_replay.hpp"
#include "soak/case.hpp"

namespace dartcast::soak {

/// Marks that a step may have besides the choices of its case.
enum class Mark : std::uint8_t {
  face_contact,
  edge_contact,
  vertex_contact,
  several_walls,
  many_contacts,
  held,
  slices,
  unfinished,
  invalid_cells,
  after_edit,
  refused_edit,
  thrown,
  walls_stopped,
  solid_contact,
  stuck,
  edge_of_body,
  pushed_catheter,
  large_polyhedron,
  steiner_point,
  overlap,
  left,
  field,
  inlet,
  statistics,
  by_cells,
  taken_again,
  passage,
  meeting,
  varying_diffusion
};
inline constexpr std::size_t mark_count = 29;
std::string_view name_of(Mark e);

/// Plain numbers, so that processes can share them.
struct Counts {
  static constexpr std::size_t most = 128;  // of features

  std::uint64_t cases = 0;
  std::uint64_t steps = 0;
  std::uint64_t particle_steps = 0;
  std::uint64_t true_steps = 0;  ///< whose first contacts were compared with all walls
  std::array<std::array<std::uint64_t, most>, most> pairs{};

  Counts& operator+=(const Counts& other);
};

/// A table of features for docs/trust.md: the steps of each, its rarest partner, and pairs that never were.
std::string table_of(const Counts& counts);

/// Counts the features of steps.
class Seen {
 public:
  explicit Seen(Counts& counts) : counts_(counts) {}
  /// Begins the steps of a case.
  void begin(const Case& c);
  /// Notes that the step at hand has this.
  void note(Mark e);
  /// A particle-step was compared with all walls.
  void note_true_step() { ++counts_.true_steps; }
  /// Ends a step of so many particles.
  void end_step(std::uint64_t particles);

  std::optional<StepReplay> replay;  ///< the step that went wrong, if it was that of a point

 private:
  using Features = std::bitset<Counts::most>;

  Counts& counts_;
  Features case_features_, step_features_;
};

}  // namespace dartcast::soak
