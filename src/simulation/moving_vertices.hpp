// The motion of an environment's vertices in a simulation, and its time. Not installed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/environment.hpp"
#include "simulation/followers.hpp"
#include "simulation/simulation_state.hpp"

namespace dartcast {

/// A function with the name of one of Simulation's does the work of that function.
class MovingVertices {
 public:
  /// `dt`: of a step, s.
  MovingVertices(Environment& environment, Followers& followers, double dt);

  void set_deformation(Deformation deformation);
  void pull(std::span<const Vec3> displacement, double duration);
  /// Moves the environment in a step to the positions that the deformation gives, or as far as something lets it.
  using Mover = std::function<void(std::span<const Vec3>)>;
  void set_mover(Mover mover) { mover_ = std::move(mover); }

  [[nodiscard]] bool deforms() const { return deformation_.has_value(); }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] double time() const { return static_cast<double>(steps_) * dt_; }

  /// Reads what the next move() needs of files. Throws as Deformation::load_frames().
  void load_step() const { load(steps_ + 1); }
  /// Moves the vertices to their places after the next step.
  void move();
  void count_step() { ++steps_; }

  void go_to(std::uint64_t steps);
  /// Moves the vertices as after the last of these steps: where they were before it counts, too. Vertices that an edit made
  /// stand then where the edit put them, not where the motion would. Throws as load_step().
  void stand_at(std::uint64_t steps);
  /// Goes on from a checkpoint: moves the vertices to where they were then.
  void restore(const SimulationState& state);
  /// For put_back(). Cost: a copy of all positions, twice.
  [[nodiscard]] VertexPlaces places() const;
  /// Moves the vertices back, and counts steps from there. The caller restores all particles.
  void put_back(const VertexPlaces& places);
  /// Where the vertices stood after some steps, if not where the deformation puts them. go_to() looks there.
  void set_known_places(std::vector<VertexPlaces> places) { known_places_ = std::move(places); }

 private:
  void load(std::uint64_t steps) const;
  void move_to(std::uint64_t steps);

  Environment& environment_;
  double dt_;
  std::optional<Deformation> deformation_;
  Mover mover_;  // none: Environment::move()
  std::vector<VertexPlaces> known_places_;
  std::vector<Vec3> next_;
  std::uint64_t steps_ = 0;
};

}  // namespace dartcast
