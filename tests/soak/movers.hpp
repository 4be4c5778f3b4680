// Those who move the vertices: the environment itself, solids, bodies, a catheter, a simulation.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "dartcast/environment.hpp"
#include "dartcast/solids.hpp"
#include "soak/guests.hpp"
#include "soak/scene.hpp"
#include "soak/seen.hpp"

namespace dartcast::soak {

class Mover {
 public:
  Mover() = default;
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;
  virtual ~Mover() = default;
  /// Moves the vertices, or lets time go on with the vertices at rest, and checks its own state. Returns what is wrong.
  virtual std::string move(const std::optional<std::vector<Vec3>>& next, std::uint64_t step, Seen& seen) = 0;
  /// Edits the environment, and follows the edit. Throws as Environment::edit().
  virtual void edit(const std::function<void(ComplexEdit&)>& make) = 0;
  /// Whether it moves and edits by itself: then `next` is not read, and this calls `follow` after each edit.
  virtual bool decides(const std::function<void()>& follow) {
    (void)follow;
    return false;
  }
};

/// Solids; null where none finds a place.
std::unique_ptr<Mover> make_solids_mover(const Case& c, const SceneMesh& scene, Environment& environment);

/// A place in the box of the scene.
Vec3 place_in(const SceneMesh& scene, Random& random);
/// The first fault that an audit has found, if a scene is valid.
std::string check_audit(const Case& c, const Environment& environment, const SolidAudit& audit);

/// The mover of the case; where its solids, bodies or catheter find no place, the environment itself.
std::unique_ptr<Mover> make_mover(const Case& c, const SceneMesh& scene, Environment& environment);

}  // namespace dartcast::soak
