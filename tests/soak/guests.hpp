// Sets of particles that take every step in several ways, which must agree. They share one environment.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "soak/crowd.hpp"
#include "soak/seen.hpp"

namespace dartcast::soak {

/// A step of a case, when the vertices have moved.
struct Step {
  std::uint64_t number = 0;
  bool moved = false;  ///< whether the vertices did
  bool valid = false;  ///< whether all cells are positive throughout, so that all walls of the scene are the truth
};

class Guest {
 public:
  Guest() = default;
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;
  virtual ~Guest() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// Takes a step. Returns what is wrong.
  virtual std::string step(Environment& environment, const Step& step, Seen& seen) = 0;
  /// The particles, to follow edits and to be checked after each step.
  virtual Crowd& crowd() = 0;
};

/// Points: a batch, each alone as a trace, in rounds.
std::unique_ptr<Guest> make_points(const Case& c, const SceneMesh& scene, Environment& environment);
/// Points that move with the walls at the same time: together, and each alone.
std::unique_ptr<Guest> make_simultaneous(const Case& c, const SceneMesh& scene, Environment& environment);
/// Spheres: together, and each alone.
std::unique_ptr<Guest> make_spheres(const Case& c, const SceneMesh& scene, Environment& environment);

}  // namespace dartcast::soak
