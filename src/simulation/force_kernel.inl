// Samples of a field, forces, and the motion under them of four particles, one in each lane.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

#include "base/double4.inl"
#include "base/elementary4.inl"
#include "base/normal_deviates4.inl"
#include "dartcast/predicates.hpp"
#include "simulation/force_kernel.hpp"
#include "simulation/rows4.inl"
#include "simulation/simplex4.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

struct Gradient4 {
  Vec3x4 x, y, z;

  [[nodiscard]] Vec3x4 along(const Vec3x4& way) const { return x * way.x + y * way.y + z * way.z; }
  [[nodiscard]] Vec3x4 curl() const { return {y.z - z.y, z.x - x.z, x.y - y.x}; }
};

inline Gradient4 load_gradients(const Rows4& rows, std::span<const VelocityGradient> all) {
  const VelocityGradient& a = all[rows.at(0)];
  const VelocityGradient& b = all[rows.at(1)];
  const VelocityGradient& c = all[rows.at(2)];
  const VelocityGradient& d = all[rows.at(3)];
  return {load_vec3x4(a.x, b.x, c.x, d.x), load_vec3x4(a.y, b.y, c.y, d.y), load_vec3x4(a.z, b.z, c.z, d.z)};
}

inline void store_gradients(const Rows4& rows, const Gradient4& g, std::span<VelocityGradient> all) {
  for (unsigned k = 0; k < rows.count(); ++k)
    all[rows.at(k)] = {{g.x.x[k], g.x.y[k], g.x.z[k]}, {g.y.x[k], g.y.y[k], g.y.z[k]}, {g.z.x[k], g.z.y[k], g.z.z[k]}};
}

// The gradients of the barycentric coordinates 1, 2 and 3.
struct WeightGradients {
  Vec3x4 a, b, c;

  explicit WeightGradients(const Corners4& v) {
    const Vec3x4 to_1 = v.corner[1] - v.corner[0];
    const Vec3x4 to_2 = v.corner[2] - v.corner[0];
    const Vec3x4 to_3 = v.corner[3] - v.corner[0];
    const Vec3x4 across = cross(to_2, to_3);
    const Double4 per_volume = splat(1.0) / dot(to_1, across);
    a = across * per_volume;
    b = cross(to_3, to_1) * per_volume;
    c = cross(to_1, to_2) * per_volume;
  }
  // The coordinates at the end of a way, of which none changes by more than 1.
  [[nodiscard]] Weights4 shifted(const Weights4& w, const Vec3x4& way) const {
    const Double4 change[3] = {dot(a, way), dot(b, way), dot(c, way)};
    const Double4 first = splat(0.0) - ((change[0] + change[1]) + change[2]);
    const Double4 most =
        larger(larger(magnitude(change[0]), magnitude(change[1])), larger(magnitude(change[2]), magnitude(first)));
    const Double4 share = choose(most > splat(1.0), splat(1.0) / most, splat(1.0));
    return {{w.at[0] + first * share, w.at[1] + change[0] * share, w.at[2] + change[1] * share,
             w.at[3] + change[2] * share}};
  }
};

class FieldKernel {
 public:
  FieldKernel(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples)
      : field_(field), particles_(particles), samples_(samples) {}

  // The lanes that were sampled.
  [[nodiscard]] std::uint8_t sample(const Rows4& rows) const {
    const auto place = [&](unsigned k) -> const Vec3& { return particles_.states[rows.at(k)].position; };
    const Vec3x4 x = load_vec3x4(place(0), place(1), place(2), place(3));
    const Corners4 now = corners(rows, field_.now);
    const Corners4 before = field_.before == field_.now ? now : corners(rows, field_.before);
    const BatchDeterminants d(field_.moving ? before : now, x);
    const Corners4 middle = field_.moving ? between(before, now, splat(0.5)) : now;  // of the move
    const Weights4 w = weights_of(d);
    const Corners4 u = values(rows, middle, now, before);
    const WeightGradients weights(middle);
    const Gradient4 gradient = gradient_of(rows, weights, u);
    rows.store(combine(u, w), samples_.values);
    if (!samples_.mesh.empty()) rows.store(mesh_velocity(now, before, w), samples_.mesh);
    if (!samples_.rates.empty()) {
      const Weights4 there = particles_.ways.empty() ? w : weights.shifted(w, rows.load(particles_.ways));
      rows.store(rates(rows, there, gradient, mesh_velocity(now, before, there)), samples_.rates);
    }
    return static_cast<std::uint8_t>(lanes_set(d.proves_coordinates()));
  }

 private:
  [[nodiscard]] Corners4 at_vertices(const Rows4& rows, const Vec3* all) const {
    const auto v = [&](unsigned k) -> const VertexNumbers& { return particles_.vertices[rows.at(k)]; };
    return Corners4(all, v(0), v(1), v(2), v(3));
  }
  [[nodiscard]] Corners4 corners(const Rows4& rows, const Vec3* positions) const {
    Corners4 c = at_vertices(rows, positions);
    if (field_.planar) raise(c);
    return c;
  }

  // In the plane the fourth corner has the value of the first one, so that nothing changes along z.
  [[nodiscard]] Corners4 values(const Rows4& rows, const Corners4& middle, const Corners4& now,
                                const Corners4& before) const {
    Corners4 u = at_vertices(rows, field_.values);
    if (field_.planar) u.corner[3] = u.corner[0];
    if (field_.rest == nullptr) return u;
    const Corners4 rest = corners(rows, field_.rest);
    for (unsigned i = 0; i < 4; ++i) {
      u.corner[i] = mapped(rest, middle, u.corner[i]);
      if (field_.carries) u.corner[i] = u.corner[i] + (now.corner[i] - before.corner[i]) * splat(field_.per_move);
    }
    return u;
  }

  [[nodiscard]] Vec3x4 mesh_velocity(const Corners4& now, const Corners4& before, const Weights4& w) const {
    return (combine(now, w) - combine(before, w)) * splat(field_.per_move);
  }

  [[nodiscard]] Gradient4 gradient_of(const Rows4& rows, const WeightGradients& w, const Corners4& u) const {
    const Vec3x4 da = u.corner[1] - u.corner[0];
    const Vec3x4 db = u.corner[2] - u.corner[0];
    const Vec3x4 dc = u.corner[3] - u.corner[0];
    const Gradient4 g = {da * w.a.x + db * w.b.x + dc * w.c.x, da * w.a.y + db * w.b.y + dc * w.c.y,
                         da * w.a.z + db * w.b.z + dc * w.c.z};
    store_gradients(rows, g, samples_.gradients);
    rows.store(larger(larger(square(da), square(db)), square(dc)), samples_.spreads);
    return g;
  }

  // At a fixed point: values go with the vertices.
  [[nodiscard]] Vec3x4 rates(const Rows4& rows, const Weights4& w, const Gradient4& gradient,
                             const Vec3x4& mesh) const {
    if (field_.rest != nullptr) return splat(Vec3{});
    Vec3x4 rate = splat(Vec3{});
    if (field_.later != field_.earlier)
      rate = (combine(at_vertices(rows, field_.later), w) - combine(at_vertices(rows, field_.earlier), w)) *
             splat(field_.per_time);
    return field_.moving ? rate - gradient.along(mesh) : rate;
  }

  const FieldAtPoints& field_;
  const StageParticles& particles_;
  const SamplesOfField& samples_;
};

// The fields of a term are read once for all particles.
class ForceKernel {
 public:
  ForceKernel(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
              const LawResult& result)
      : terms_(terms), particles_(particles), samples_(samples), result_(result) {}

  void apply(const Rows4& rows) const {
    const Vec3x4 u = rows.load(samples_.velocities);
    const Vec3x4 slip = u - rows.load(particles_.velocities);
    const Double4 diameter = rows.load(particles_.diameters);
    const Double4 density = rows.load(particles_.densities);
    const Double4 ratio = splat(terms_.fluid.density) / density;
    const Double4 reynolds = root(square(slip)) * diameter * splat(terms_.fluid.density / terms_.fluid.viscosity);
    Double4 rate = terms_.drag == ForceTerms::Drag::none ? splat(0.0) : drag(diameter, density, reynolds);
    Vec3x4 a = splat(terms_.gravity) * (terms_.buoyancy ? splat(1.0) - ratio : splat(1.0));
    if (terms_.pressure_gradient || terms_.virtual_mass) {
      const Double4 share =
          (terms_.pressure_gradient ? ratio : splat(0.0)) + (terms_.virtual_mass ? 0.5 * ratio : splat(0.0));
      a = a + (rows.load(samples_.rates) + load_gradients(rows, samples_.gradients).along(u)) * share;
    }
    if (terms_.saffman_mei)
      a = a + lift(slip, load_gradients(rows, samples_.gradients).curl(), diameter, reynolds) * ratio;
    const Double4 charge = terms_.lorentz ? rows.load(particles_.charges_per_mass) : splat(0.0);
    if (terms_.lorentz) a = a + splat(terms_.electric_field) * charge;
    const Double4 share = terms_.virtual_mass ? splat(1.0) / (splat(1.0) + 0.5 * ratio) : splat(1.0);
    rows.store(a * share, result_.accelerations);
    rows.store(rate * share, result_.rates);
    if (terms_.lorentz) rows.store(splat(terms_.magnetic_field) * (charge * share), result_.rotations);
  }

 private:
  // Re is kept from 0, whose logarithm is infinite: such a power is below the rounding of 1.
  [[nodiscard]] Double4 drag(const Double4& diameter, const Double4& density, const Double4& reynolds) const {
    const Double4 some = larger(reynolds, splat(1e-30));
    const Mask4 slow = reynolds <= splat(1000.0);
    Double4 factor = splat(1.0);
    switch (terms_.drag) {
      case ForceTerms::Drag::none:
      case ForceTerms::Drag::stokes: break;
      case ForceTerms::Drag::schiller_naumann:
        factor = choose(slow, splat(1.0) + 0.15 * power(some, 0.687), reynolds * (0.44 / 24.0));
        break;
      case ForceTerms::Drag::putnam:
        factor = choose(slow, splat(1.0) + power(some, 2.0 / 3.0) * (1.0 / 6.0), reynolds * (0.424 / 24.0));
        break;
    }
    return splat(18.0 * terms_.fluid.viscosity) * factor / (density * diameter * diameter * slip_factor(diameter));
  }

  // Cunningham's.
  [[nodiscard]] Double4 slip_factor(const Double4& diameter) const {
    if (terms_.fluid.mean_free_path == 0.0) return splat(1.0);
    const Double4 knudsen = splat(2.0 * terms_.fluid.mean_free_path) / diameter;
    const Double4 fading = exponential(larger(splat(-1.1) / knudsen, splat(-690.0)));
    return splat(1.0) + knudsen * (splat(1.257) + 0.4 * fading);
  }

  // By the ratio of densities.
  [[nodiscard]] Vec3x4 lift(const Vec3x4& slip, const Vec3x4& curl, const Double4& diameter,
                            const Double4& reynolds) const {
    const Double4 of_shear =
        root(square(curl)) * diameter * diameter * splat(terms_.fluid.density / terms_.fluid.viscosity);
    const Mask4 acts = (reynolds > splat(1e-100)) & (of_shear > splat(1e-100));
    const Double4 some = choose(acts, reynolds, splat(1.0));
    const Double4 shear = choose(acts, of_shear, splat(1.0));
    const Double4 b = 0.5 * shear / some;
    const Double4 alpha = 0.3314 * root(b);
    const Double4 fading = exponential(smaller(some, splat(40.0)) * -0.1);
    const Double4 slow = (splat(1.0) - alpha) * fading + alpha;
    const Double4 fast = 0.0524 * root(b * some);
    const Double4 factor = choose(some <= splat(40.0), slow, fast);
    const Double4 coefficient = factor * (3.0 * 6.46 / (2.0 * std::numbers::pi)) / root(shear);
    return cross(slip, curl) * choose(acts, coefficient, splat(0.0));
  }

  const ForceTerms& terms_;
  const LawParticles& particles_;
  const LawSamples& samples_;
  const LawResult& result_;
};

// The shares of an acceleration in a time with z = c t. For the velocity it is phi = (1 - e^-z) / z, and for the way
// psi = (z - 1 + e^-z) / z^2. If differences would cancel, psi is its series.
struct Shares4 {
  Double4 phi, psi;
};
inline Shares4 shares_of(const Double4& z) {
  const Double4 series = polynomial(exponential_terms, splat(0.0) - z);
  const Double4 small = splat(1.0) - z * series;
  const Mask4 is_small = z <= splat(0.34);
  if (lanes_set(is_small) == 15) return {small, series};
  const Double4 some = choose(is_small, splat(1.0), z);
  const Double4 phi = (splat(0.0) - exponential_less_one(splat(0.0) - some)) / some;
  return {choose(is_small, small, phi), choose(is_small, series, (splat(1.0) - phi) / some)};
}

class HeldKernel {
 public:
  explicit HeldKernel(const HeldMotion& motion)
      : motion_(motion),
        rotates_(!motion.result.rotations.empty()),
        time_(rotates_ ? 0.5 * motion.duration : motion.duration) {}

  void move(const Rows4& rows) const {
    const Double4 rate = rows.load(motion_.result.rates);
    const Shares4 shares = shares_of(rate * splat(time_));
    const Vec3x4 u = rows.load(motion_.fluid);
    const Vec3x4 a = rows.load(motion_.result.accelerations);
    Vec3x4 v = rows.load(motion_.starts);
    Vec3x4 way = relax(v, u, a, rate, shares);
    if (rotates_) {
      v = rotated(v, rows.load(motion_.result.rotations) * splat(time_));
      way = way + relax(v, u, a, rate, shares);
    }
    rows.store(v, motion_.ends);
    rows.store(way, motion_.ways);
  }

 private:
  // Returns the way.
  Vec3x4 relax(Vec3x4& v, const Vec3x4& u, const Vec3x4& a, const Double4& rate, const Shares4& shares) const {
    const Vec3x4 gain = (u - v) * rate + a;
    const Vec3x4 way = v * splat(time_) + gain * (shares.psi * (time_ * time_));
    v = v + gain * (shares.phi * time_);
    return way;
  }

  // Boris' rotation: t = r dt / 2 is the tangent of half the angle.
  static Vec3x4 rotated(const Vec3x4& v, const Vec3x4& t) {
    const Vec3x4 half = v + cross(v, t);
    return v + cross(half, t) * (splat(2.0) / (splat(1.0) + square(t)));
  }

  const HeldMotion& motion_;
  bool rotates_;
  double time_;
};

// With z = c t, the velocity has the variance s z phi (2 - z phi) with s = k T / m. Given the velocity's change dv, the
// way has the mean t w dv with w = phi / (2 - z phi). Its variance is 2 s t^2 (1 - 2 w) / z. If 1 - 2 w would cancel,
// it is z^2 / (2 - z phi) times the series of 1/6 - 2 z / 24 + 3 z^2 / 120 ...
constexpr auto rest_terms = [] {
  std::array<double, exponential_terms.size() - 1> terms{};
  for (std::size_t k = 0; k < terms.size(); ++k) terms[k] = static_cast<double>(k + 1) * exponential_terms[k + 1];
  return terms;
}();

class ThermalKernel {
 public:
  explicit ThermalKernel(const ThermalMotion& motion) : motion_(motion) {}

  void add(const Rows4& rows) const {
    const Double4 d = rows.load(motion_.diameters);
    const Double4 mass = d * d * d * (rows.load(motion_.densities) + motion_.added_density) * (std::numbers::pi / 6.0);
    const Double4 s = splat(motion_.energy) / mass;
    const Double4 z = rows.load(motion_.rates) * splat(motion_.duration);
    const Shares4 shares = shares_of(z);
    const Double4 lost = z * shares.phi;
    const Double4 w = shares.phi / (splat(2.0) - lost);
    const Mask4 is_small = z <= splat(0.34);
    const Double4 series = z * polynomial(rest_terms, splat(0.0) - z) / (splat(2.0) - lost);
    const Double4 rest = choose(is_small, series, (splat(1.0) - 2.0 * w) / choose(is_small, splat(1.0), z));
    const Double4 speed = root(s * lost * (splat(2.0) - lost));
    const Double4 spread = root(2.0 * s * rest) * motion_.duration;
    const auto ids = bits_as<Bits4>(rows.load(motion_.ids));
    const std::array<Bits4, 4> a = random_bits(motion_.moment, ids, 0);
    const std::array<Bits4, 4> b = random_bits(motion_.moment, ids, 1);
    const SineCosine4 first = normal_pair(a[0], a[1]);
    const SineCosine4 second = normal_pair(a[2], a[3]);
    const SineCosine4 third = normal_pair(b[0], b[1]);
    const Vec3x4 change = in_space({first.cosine, first.sine, second.cosine}) * speed;
    const Vec3x4 aside = in_space({second.sine, third.cosine, third.sine}) * spread;
    rows.store(rows.load(std::span<const Vec3>(motion_.ends)) + change, motion_.ends);
    rows.store(rows.load(std::span<const Vec3>(motion_.ways)) + (change * (w * motion_.duration) + aside),
               motion_.ways);
  }

 private:
  [[nodiscard]] Vec3x4 in_space(const Vec3x4& v) const { return motion_.planar ? Vec3x4{v.x, v.y, splat(0.0)} : v; }

  const ThermalMotion& motion_;
};

}  // namespace

void sample_field(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples,
                  std::span<std::uint8_t> sampled) {
  const FieldKernel kernel(field, particles, samples);
  for (std::size_t i = 0; i < particles.states.size(); i += 4)
    sampled[i / 4] = kernel.sample(Rows4(i, particles.states.size()));
}

void shift_samples(const SamplesOfField& samples, std::span<const Vec3> ways) {
  for (std::size_t i = 0; i < ways.size(); i += 4) {
    const Rows4 rows(i, ways.size());
    const Vec3x4 change = load_gradients(rows, samples.gradients).along(rows.load(ways));
    const Double4 size = square(change);
    const Double4 spread = rows.load(std::span<const double>(samples.spreads));
    const Double4 share = choose(size > spread, root(spread / size), splat(1.0));
    rows.store(rows.load(std::span<const Vec3>(samples.values)) + change * share, samples.values);
  }
}

void apply_forces(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
                  const LawResult& result) {
  const ForceKernel kernel(terms, particles, samples, result);
  for (std::size_t i = 0; i < result.rates.size(); i += 4) kernel.apply(Rows4(i, result.rates.size()));
}

void move_held(const HeldMotion& motion) {
  const HeldKernel kernel(motion);
  for (std::size_t i = 0; i < motion.starts.size(); i += 4) kernel.move(Rows4(i, motion.starts.size()));
}

void draw_ways(const RandomWays& random) {
  for (std::size_t i = 0; i < random.ways.size(); i += 4) {
    const Rows4 rows(i, random.ways.size());
    const auto bits = random_bits(random.moment, bits_as<Bits4>(rows.load(random.ids)), 0);
    const SineCosine4 first = normal_pair(bits[0], bits[1]);
    const Double4 z = random.planar ? splat(0.0) : normal_pair(bits[2], bits[3]).cosine;
    rows.store(Vec3x4{first.cosine, first.sine, z} * splat(random.length), random.ways);
  }
}

void add_thermal_motion(const ThermalMotion& motion) {
  const ThermalKernel kernel(motion);
  for (std::size_t i = 0; i < motion.ways.size(); i += 4) kernel.add(Rows4(i, motion.ways.size()));
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
