// Applies a step of a motion to four vertices, one in each lane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/double4.inl"
#include "base/elementary4.inl"
#include "simulation/motion.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Up to four vertices, and what a step has for each of them. Behind the last one it is repeated.
struct FourVertices {
  Vec3x4 position;
  Double4 path;
  Vec3x4 field;
};

class MotionKernel {
 public:
  explicit MotionKernel(const Motion& motion)
      : s_(*motion.step),
        motion_(motion),
        axis_(splat(s_.axis)),
        centre_(splat(s_.centre)),
        direction_(splat(s_.direction)) {}

  void apply(std::span<Vec3> vertices, std::size_t first) const {
    for (std::size_t i = 0; i < vertices.size(); i += 4) {
      const std::size_t size = std::min<std::size_t>(4, vertices.size() - i);
      const Vec3x4 x = moved(load(vertices, i, first));
      for (std::size_t k = 0; k < size; ++k) vertices[i + k] = {x.x[k], x.y[k], x.z[k]};
    }
  }

 private:
  [[nodiscard]] FourVertices load(std::span<const Vec3> vertices, std::size_t i, std::size_t first) const {
    const std::size_t last = vertices.size() - 1;
    const std::array<std::size_t, 4> at = {i, std::min(i + 1, last), std::min(i + 2, last), std::min(i + 3, last)};
    FourVertices four{};
    four.position = load_vec3x4(vertices[at[0]], vertices[at[1]], vertices[at[2]], vertices[at[3]]);
    if (!s_.path.empty()) {
      const double* path = &s_.path[first];
      four.path = Double4{path[at[0]], path[at[1]], path[at[2]], path[at[3]]};
    }
    if (!s_.field.empty()) {
      const Vec3* field = &s_.field[first];
      four.field = load_vec3x4(field[at[0]], field[at[1]], field[at[2]], field[at[3]]);
    }
    return four;
  }

  [[nodiscard]] Vec3x4 moved(const FourVertices& v) const {
    const Vec3x4& x = v.position;
    const Vec3x4 r = x - centre_;
    const Double4 height = dot(r, axis_);
    switch (s_.kind) {
      case DeformationKind::rotate:
      case DeformationKind::swing: return centre_ + turned(r, {splat(motion_.angle.sine), splat(motion_.angle.cosine)});
      case DeformationKind::bend: return centre_ + bent(r, height);
      case DeformationKind::twist: return centre_ + turned(r, sine_cosine(motion_.amount * height / s_.length));
      case DeformationKind::stretch: return centre_ + stretched(r, height);
      case DeformationKind::pulse: return x + pulsed(v, r, height);
      case DeformationKind::bump: return bumped(x, r);
      case DeformationKind::frames: break;
    }
    return x;
  }

  // Turned about the axis (O. Rodrigues, 1840).
  [[nodiscard]] Vec3x4 turned(const Vec3x4& r, const SineCosine4& angle) const {
    return r * angle.cosine + cross(axis_, r) * angle.sine + axis_ * (dot(axis_, r) * (1.0 - angle.cosine));
  }

  // By the sine and cosine of half the angle: sin(ks) / k and (1 - cos(ks)) / k keep their digits for small k, too.
  [[nodiscard]] Vec3x4 bent(const Vec3x4& r, const Double4& height) const {
    const Double4 half = 0.5 * (motion_.amount * height / s_.length);
    const Double4 depth = dot(r, direction_);
    const SineCosine4 at_half = sine_cosine(half);
    const Vec3x4 aside = r - axis_ * height - direction_ * depth;
    const Double4 chord = choose(half == splat(0.0), height, height * (at_half.sine / half));
    const Double4 along = chord * at_half.cosine - depth * (2.0 * at_half.sine * at_half.cosine);
    const Double4 across = chord * at_half.sine + depth * (1.0 - 2.0 * at_half.sine * at_half.sine);
    return axis_ * along + direction_ * across + aside;
  }

  [[nodiscard]] Vec3x4 stretched(const Vec3x4& r, const Double4& height) const {
    const Vec3x4 along = axis_ * height;
    return along * splat(1.0 + motion_.amount) + (r - along) * splat(1.0 / std::sqrt(1.0 + motion_.amount));
  }

  [[nodiscard]] Vec3x4 pulsed(const FourVertices& v, const Vec3x4& r, const Double4& height) const {
    Double4 phase = splat(motion_.turns);
    if (s_.wavelength > 0.0) phase -= (s_.path.empty() ? height : v.path) / s_.wavelength;
    const Vec3x4 way = s_.field.empty() ? r - axis_ * height : v.field;
    return way * (s_.amplitude * sine_cosine_of_turns(phase).sine);
  }

  [[nodiscard]] Vec3x4 bumped(const Vec3x4& x, const Vec3x4& r) const {
    const Double4 inside = 1.0 - dot(r, r) / (s_.length * s_.length);
    return choose(inside > splat(0.0), x + axis_ * (motion_.amount * inside * inside), x);
  }

  const DeformationStep& s_;
  const Motion& motion_;
  Vec3x4 axis_, centre_, direction_;
};

}  // namespace

void apply(const Motion& motion, std::span<Vec3> vertices, std::size_t first) {
  MotionKernel(motion).apply(vertices, first);
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
