// The step of one point while point and walls move at the same time. docs/method.md, "Points and walls that move at the
// same time".
//
// A leg is a straight way of the point from a time to the end of the step, among vertices on their straight ways.
// Most points touch none in a step: find_free() proves it with filters alone, and a batch of walks takes the step. Else:
//  1. look()          the walls that the point comes to in the leg, with the exact time of each touch
//  2. no touch        the point ends at its target, in the simplex among the cells reached that holds it
//  3. stop_before()   else the point goes on to just before the first touch, once this rounded way is proved free
//  4. describe()      the contact; the response gives the next leg
// A leg cannot be decided so if a cell in reach becomes flat, if the point is on a wall already, and after the last
// contact allowed. The vertices then carry the point for the rest of the step: StepStage::carry. A point on a wall that
// goes towards it has a contact there first, and then a target off that wall. So its next step has legs again.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dynamics/moving_walls.hpp"
#include "dynamics/near_walls.hpp"
#include "dynamics/places_between.hpp"
#include "tracking/step.hpp"

namespace dartcast {

/// A point's straight way to the end of a step.
struct SimultaneousLeg {
  SimplexId at;  ///< holds `from` at `begin`
  Vec3 from;     ///< at the time `begin`
  Vec3 to;       ///< at the time 1
  double begin = 0.0;
};

/// Takes steps of points. A plain reader of the complex: any number may run at once, each with memory of its own.
class SimultaneousStep {
 public:
  /// Memory of steps, for one thread at a time. After a few steps it allocates no more.
  struct Memory {
    struct Touch {
      double time = 0.0;  ///< a share of the way that was looked at
      NearWall wall;
    };

    NearWalls near;
    PlacesBetween places;
    VertexMotion motion;  ///< of the last search
    std::span<const NearWall> found;
    std::vector<Touch> touches;  ///< of the last look
    std::vector<Touch> met;      ///< of the contact
    std::uint64_t pairs = 0;     ///< of this step
    std::vector<WayAndWall> ways;
    std::vector<std::uint8_t> free;
  };

  /// The references must outlive it. The complex has been moved for this step. `all_walls`: its walls; none: each point's are
  /// searched for.
  SimultaneousStep(const CellComplex& complex, const StepOptions& options, const ContactCallback& respond,
                   const MovingWalls* all_walls)
      : complex_(complex),
        options_(options),
        respond_(respond),
        stepper_(complex, true, options, respond),
        all_walls_(all_walls) {}

  /// Clears the marks of points that do not prove to touch no wall on their ways. Those without a mark are not looked at.
  void find_free(std::span<const ParticleState> states, std::span<const Vec3> targets, std::span<std::uint8_t> free,
                 Memory& memory) const;

  /// As Stepper::step().
  StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                  ContactList& contacts, Counters& counters, Memory& memory) const;

 private:
  struct Run;
  struct Stop;
  enum class LegEnd : std::uint8_t { arrived, stopped, goes_on, on_wall, undecided };

  void find_free_of_all(std::span<const ParticleState> states, std::span<const Vec3> targets,
                        std::span<std::uint8_t> free, Memory& memory) const;
  VertexMotion motion_of(Memory& memory, double begin, double end) const;
  LegEnd take(Run& run, SimultaneousLeg& leg) const;
  bool walk(Run& run, const Vec3& target) const;
  bool search(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const;
  bool is_proved_free(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const;
  bool look(Memory& memory, const SimultaneousLeg& leg, const Vec3& to, double end) const;
  [[nodiscard]] SimplexId holding(const Memory& memory, const SimultaneousLeg& leg, const Vec3& x, double end) const;
  static void keep_first_touches(Memory& memory);
  [[nodiscard]] std::optional<Stop> stop_before(Memory& memory, const SimultaneousLeg& leg, double time) const;
  const Contact& describe(Run& run, const SimultaneousLeg& leg) const;
  [[nodiscard]] bool presses(const Memory& memory, const SimultaneousLeg& leg) const;
  [[nodiscard]] Vec3 wall_displacement(const NearWall& wall, const Vec3& x, double time) const;
  [[nodiscard]] Vec3 aim(const Run& run, const Contact& contact, const AfterContact& next,
                         const SimultaneousLeg& leg) const;
  void count(const Run& run) const;

  const CellComplex& complex_;
  const StepOptions& options_;
  const ContactCallback& respond_;
  Stepper stepper_;
  const MovingWalls* all_walls_;
};

}  // namespace dartcast
