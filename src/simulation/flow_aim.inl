// Aims four particles in a flow, one in each lane. The operations are those of VelocityField::at(),
// detail::barycentric() and ParticleSystem::aim_at(), in their order.
#pragma once

#include <cstddef>

#include "base/double4.inl"
#include "dartcast/predicates.hpp"
#include "simulation/flow_aim.hpp"
#include "simulation/simplex4.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// As flushed() of predicates.hpp.
inline Double4 flushed(const Double4& x) { return choose(magnitude(x) < splat(smallest_magnitude), splat(0.0), x); }
inline Vec3x4 flushed(const Vec3x4& v) { return {flushed(v.x), flushed(v.y), flushed(v.z)}; }

class FlowKernel {
 public:
  FlowKernel(const FlowScene& scene, const FlowParticles& particles) : scene_(scene), particles_(particles) {}

  void aim_all() const {
    for (std::size_t block = 0; block < particles_.aimed.size(); ++block) particles_.aimed[block] = aim(4 * block);
  }
  void find_all() const {
    for (std::size_t block = 0; block < particles_.aimed.size(); ++block) particles_.aimed[block] = find(4 * block);
  }

 private:
  [[nodiscard]] Corners4 corners(const Vec3* positions, std::size_t i) const {
    const VertexNumbers* v = &particles_.vertices[i];
    Corners4 corners(positions, v[0], v[1], v[2], v[3]);
    if (scene_.planar) raise(corners);
    return corners;
  }

  [[nodiscard]] Vec3x4 values(std::size_t i, const Weights4& w) const {
    const VertexNumbers* v = &particles_.vertices[i];
    return combine(Corners4(scene_.values, v[0], v[1], v[2], v[3]), w);
  }

  // Lanes of particles that take a step of their own.
  [[nodiscard]] unsigned free_lanes(std::size_t i) const {
    unsigned lanes = 0;
    for (unsigned k = 0; k < 4; ++k) {
      const bool is_free = !particles_.states[i + k].held && particles_.statuses[i + k] == ParticleStatus::alive;
      lanes |= static_cast<unsigned>(is_free) << k;
    }
    return lanes;
  }

  [[nodiscard]] std::uint8_t aim(std::size_t i) const {
    const ParticleState* s = &particles_.states[i];
    const Vec3x4 x = load_vec3x4(s[0].position, s[1].position, s[2].position, s[3].position);
    const Corners4 now = corners(scene_.now, i);
    const Corners4 before = scene_.before == scene_.now ? now : corners(scene_.before, i);
    const BatchDeterminants d(scene_.moving ? before : now, x);
    const unsigned lanes = free_lanes(i) & lanes_set(d.proves_coordinates());
    if (lanes == 0) return 0;
    const Weights4 w = weights_of(d);
    const Vec3x4 u = values(i, w);
    const Vec3x4 velocity = load_vec3x4(&particles_.velocities[i]);
    if (scene_.rest == nullptr) {
      const Vec3x4 v = accelerated(velocity, u);
      store(i, lanes, v, flushed(x + v * splat(scene_.dt)));
    } else {
      const Vec3x4 carried = combine(now, w);
      const Vec3x4 mesh = (carried - combine(before, w)) * splat(scene_.per_move);
      const Vec3x4 v = accelerated(velocity, mapped(corners(scene_.rest, i), now, u) + mesh);
      store(i, lanes, v, flushed((scene_.moving ? carried : x) + (v - mesh) * splat(scene_.dt)));
    }
    return static_cast<std::uint8_t>(lanes);
  }

  [[nodiscard]] std::uint8_t find(std::size_t i) const {
    const ParticleState* s = &particles_.states[i];
    const Vec3x4 x = load_vec3x4(s[0].position, s[1].position, s[2].position, s[3].position);
    const Corners4 here = corners(scene_.at, i);
    const BatchDeterminants d(here, x);
    const unsigned lanes = free_lanes(i) & lanes_set(d.proves_coordinates());
    if (lanes == 0) return 0;
    const Weights4 w = weights_of(d);
    Vec3x4 u = values(i, w);
    if (scene_.rest != nullptr) {
      u = mapped(corners(scene_.rest, i), here, u);
      if (scene_.moving) {
        const Vec3x4 mesh = combine(corners(scene_.now, i), w) - combine(corners(scene_.before, i), w);
        u = u + mesh * splat(scene_.per_move);
      }
    }
    for (unsigned k = 0; k < 4; ++k) {
      if ((lanes >> k & 1U) != 0) particles_.velocities[i + k] = {u.x[k], u.y[k], u.z[k]};
    }
    return static_cast<std::uint8_t>(lanes);
  }

  [[nodiscard]] Vec3x4 accelerated(const Vec3x4& v, const Vec3x4& flow) const {
    if (!scene_.drags) return flow;
    return v + (flow + splat(scene_.terminal) - v) * splat(scene_.lost);
  }

  void store(std::size_t i, unsigned lanes, const Vec3x4& velocity, const Vec3x4& target) const {
    for (unsigned k = 0; k < 4; ++k) {
      if ((lanes >> k & 1U) == 0) continue;
      particles_.velocities[i + k] = {velocity.x[k], velocity.y[k], velocity.z[k]};
      particles_.targets[i + k] = {target.x[k], target.y[k], target.z[k]};
    }
  }

  const FlowScene& scene_;
  const FlowParticles& particles_;
};

}  // namespace

void aim_in_flow(const FlowScene& scene, const FlowParticles& particles) { FlowKernel(scene, particles).aim_all(); }
void find_flow(const FlowScene& scene, const FlowParticles& particles) { FlowKernel(scene, particles).find_all(); }

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
