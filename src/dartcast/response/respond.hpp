// What particles do at walls: reflect, slide, stick, absorb, escape; per patch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/exact/vec3.hpp"
#include "dartcast/walk/contact.hpp"

namespace dartcast {

enum class ResponseKind : std::uint8_t {
  reflect,  ///< rebounds, relative to the moving wall, with restitution and friction
  slide,    ///< loses the normal part of its motion
  stick,    ///< stays on the wall from then on, and moves with it
  absorb,   ///< ends at the wall
  escape    ///< leaves the scene through it
};

struct Response {
  ResponseKind kind = ResponseKind::reflect;
  double restitution = 1.0;  ///< share of the normal velocity kept by a reflection, in [0, 1]
  double friction = 0.0;     ///< Coulomb: tangential velocity lost per normal velocity changed, >= 0
};

/// A response for every patch. Wall faces without a patch, and patches without a response, get the general one.
class Responses {
 public:
  /// Throws InvalidArgument where restitution or friction is out of range.
  explicit Responses(const Response& general = {});
  void set(Patch patch, const Response& response);
  [[nodiscard]] const Response& of(Patch patch) const {
    return patch.value < by_patch_.size() && by_patch_[patch.value].set ? by_patch_[patch.value].response : general_;
  }

 private:
  struct Entry {
    Response response;
    bool set = false;
  };
  Response general_;
  std::vector<Entry> by_patch_;
};

/// What has become of a particle.
enum class Fate : std::uint8_t { alive, stuck, absorbed, escaped };

/// A callable for Environment::advance() that answers contacts by `responses` (the patch of the wall met first decides)
/// and writes each particle's new velocity and fate. `velocities` in length per time, `dt` the step's duration > 0. The
/// spans, one entry per particle, and `responses` must outlive it. A particle already absorbed, escaped or
/// stuck goes no further at a contact: give it its own position as the target.
Respond respond_with(const Responses& responses, std::span<Vec3> velocities, std::span<Fate> fates, double dt);

// The operators, for a caller's own responses. Vectors are relative to the wall; walls in the order of a contact's.

/// Rebound from every wall that v points into, the one most opposed first.
Vec3 reflected(Vec3 v, std::span<const WallHit> walls, double restitution, double friction);

/// Projection on the newest walls; an earlier wall joins (a crease, a corner) only if the projected vector points into
/// it: joined at once, two nearly coplanar fan triangles would make a false crease.
Vec3 slid(const Vec3& v, std::span<const WallHit> walls, std::span<const WallHit> earlier);

}  // namespace dartcast
