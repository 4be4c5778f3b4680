// The responses of particles at walls: reflect, slide, stick, absorb, escape; per patch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/step.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// The way in which a wall answers a particle that meets it.
enum class WallResponseKind : std::uint8_t {
  reflect,  ///< rebounds, relative to the moving wall, with restitution and friction
  slide,    ///< loses the normal part of its motion
  stick,    ///< stays on the wall from then on, and moves with it
  absorb,   ///< ends at the wall
  escape    ///< leaves the scene through it
};

/// Restitution by how a particle meets a wall, bilinear between these speeds and angles. Beyond the ends it is as there.
struct RestitutionTable {
  std::vector<double> speeds;  ///< m / s, increasing, relative to the wall; empty: there is no table
  std::vector<double> angles;  ///< degrees from the wall's plane, increasing, from 0 to 90
  std::vector<double> values;  ///< in [0, 1]: for each speed one for each angle
};

/// A kind of response, with its parameters.
struct WallResponse {
  WallResponseKind kind = WallResponseKind::reflect;
  double restitution = 1.0;  ///< share of the normal velocity kept by a reflection, in [0, 1]
  double friction = 0.0;     ///< Coulomb: tangential velocity lost per normal velocity changed, >= 0
  /// >= 0: a particle sticks instead of rebounding if it meets the wall with a normal speed below this. So is the table:
  /// for particles of a simulation without collisions, not for those of bodies.
  double stick_below = 0.0;
  RestitutionTable table = {};  ///< in place of `restitution`
  /// >= 0: likewise, if its Weber number rho d v^2 / sigma with this speed v is below it. For particles of a simulation that
  /// have a diameter d and a density rho, in a fluid with the surface tension sigma (Fluid).
  double stick_below_weber = 0.0;
};

// The responses as values, each with its own parameters: Reflect{0.5, 0.1}, Slide{}.

// They convert by themselves, so that an option takes one as it is: NOLINTBEGIN(google-explicit-constructor)
/// A rebound, relative to the moving wall.
struct Reflect {
  double restitution = 1.0;  ///< as WallResponse::restitution
  double friction = 0.0;     ///< as WallResponse::friction
  operator WallResponse() const { return {WallResponseKind::reflect, restitution, friction}; }
};
/// The particle goes on along the wall.
struct Slide {
  operator WallResponse() const { return {WallResponseKind::slide}; }
};
/// The particle stays on the wall from then on, and moves with it.
struct Stick {
  operator WallResponse() const { return {WallResponseKind::stick}; }
};
/// The particle ends at the wall.
struct Absorb {
  operator WallResponse() const { return {WallResponseKind::absorb}; }
};
/// The particle leaves the scene through the wall.
struct Escape {
  operator WallResponse() const { return {WallResponseKind::escape}; }
};
// NOLINTEND(google-explicit-constructor)

/// A response for every patch. Wall faces without a patch, and patches without a response, get the general one.
class WallResponses {
 public:
  /// Throws InvalidArgument if a number is out of range.
  explicit WallResponses(const WallResponse& general = {});
  void set(Patch patch, const WallResponse& response);
  [[nodiscard]] const WallResponse& of(Patch patch) const {
    return patch.value < by_patch_.size() && by_patch_[patch.value].set ? by_patch_[patch.value].response : general_;
  }

 private:
  struct Entry {
    WallResponse response;
    bool set = false;
  };
  WallResponse general_;
  std::vector<Entry> by_patch_;
};

/// Whether a particle still moves, and why not.
enum class ParticleStatus : std::uint8_t { alive, stuck, absorbed, escaped };

/// A constant acceleration of all particles, if nothing else changes their velocities between contacts. Each target
/// is position + velocity * duration, with the velocity after the acceleration (the symplectic rule of Euler).
struct Acceleration {
  Vec3 value;
  double duration = 0.0;  ///< of one advance(), > 0
};

/// Particles as drops, one entry per particle.
struct Drops {
  std::span<const double> diameters;  ///< m
  std::span<const double> densities;  ///< kg / m^3
  double surface_tension = 0.0;       ///< N / m, > 0
};

/// A callable for Environment::advance() that answers contacts by `responses` and writes each particle's new velocity
/// and status. The patch of the wall met first decides which response it is; if that is a reflection, each wall
/// gives its own restitution and friction. `velocities` in length per time, `dt` the duration > 0 in which the vertices
/// move. The spans, one entry per particle, and `responses` must outlive it. A particle already absorbed, escaped or
/// stuck goes no further at a contact: give it its own position as the target.
///
/// Reflection acts on all walls at once: those of the contact, and those met at the same place (Contact::together). At
/// the last contact it also acts on the walls met earlier in the step. So the velocity points into none of them, and
/// stays so from step to step while the particle is wedged. The kinetic energy relative to the wall, as computed, does
/// not grow at any contact. With an `acceleration` this is the energy at the moment of the contact. The sum of kinetic
/// and potential energy is then bounded for any number of steps (docs/method.md, "Reflection"). Without one the sum
/// changes at each contact by up to the work of a step.
/// `drops`: for WallResponse::stick_below_weber, which has no effect without.
ContactCallback respond_with(const WallResponses& responses, std::span<Vec3> velocities,
                             std::span<ParticleStatus> statuses, double dt, const Acceleration& acceleration = {},
                             const Drops& drops = {});

/// Serves particles that a step has stopped at a wall beyond their last contact (StepReport::stopped). Each gets a
/// velocity that all walls met in the step permit, with no more energy than it had at that wall. They stand still for
/// the rest of the step, so gravity gives them no energy in it. Call it after an advance() with respond_with(), with
/// the same arguments. Cost: linear in the contacts of the step; nothing if none is stopped.
void hold_stopped(const StepReport& report, const WallResponses& responses, std::span<Vec3> velocities,
                  std::span<const ParticleStatus> statuses, double dt, const Acceleration& acceleration = {});

// The operators, for a caller's own responses. Vectors are relative to the wall; walls in the order of a contact's.

/// Rebound from all walls at once (response/incident_walls.hpp), whatever their order: it points into none of them, and
/// is not longer than v.
Vec3 reflected(const Vec3& v, std::span<const WallHit> walls, double restitution, double friction);

/// Projection on the newest walls. An earlier wall joins (a crease, a corner) only if the projected vector points into
/// it. If both joined at once, two nearly coplanar fan triangles would make a false crease.
Vec3 slid(const Vec3& v, std::span<const WallHit> walls, std::span<const WallHit> earlier);

}  // namespace dartcast
