// Forces on particles of a given size and mass in a fluid: laws of the library, and laws of one's own.
//
// dv/dt = c (u - v) + a + v x r with the fluid's velocity u. Laws give the rate c, the acceleration a and the rotation r.
// Each step holds them, and is then exact for any c dt (docs/method.md). The fluid's velocity is that of the field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// A term of the equation of motion. Re = |u - v| d / nu, tau = rho_p d^2 / (18 mu), k = rho_f / rho_p. Give one of the
/// three laws of drag at most.
enum class Force : std::uint8_t {
  stokes,             ///< drag: c = 1 / tau
  schiller_naumann,   ///< drag: c = (1 + 0.15 Re^0.687) / tau; from Re 1000 on with a drag coefficient of 0.44 (1935)
  putnam,             ///< drag: c = (1 + Re^(2/3) / 6) / tau; from Re 1000 on with 0.424 (1961)
  buoyancy,           ///< gravity counts times 1 - k
  pressure_gradient,  ///< k Du/Dt
  virtual_mass,       ///< k (Du/Dt - dv/dt) / 2: the left side gets the second part
  saffman_mei,        ///< lift from shear: k C (u - v) x curl u, after R. Mei, 1992, up to and beyond Re 40
  lorentz,            ///< q (E + v x B), with Boris' scheme
  /// Random motion by the fluid's molecules; it needs a law of drag, and the fluid's temperature. Velocity and way are drawn
  /// together, by a law that is exact for any c dt. Random numbers depend on the seed, the particle's id and the step alone.
  brownian
};

/// The medium around the particles, SI units.
struct Fluid {
  double density = 0.0;          ///< kg / m^3, 0: of no effect
  double viscosity = 0.0;        ///< Pa s, dynamic
  double mean_free_path = 0.0;   ///< m; above 0 drag is divided by Cunningham's 1 + Kn (1.257 + 0.4 exp(-1.1 / Kn))
  double temperature = 0.0;      ///< K, 0: of no effect
  double surface_tension = 0.0;  ///< N / m, of drops in it: for WallResponse::stick_below_weber
};

/// J / K
inline constexpr double boltzmann_constant = 1.380649e-23;

/// The forces of a simulation.
struct ForceOptions {
  std::vector<Force> terms = {};
  Fluid fluid = {};
  Vec3 electric_field = {};  ///< V / m, everywhere the same
  Vec3 magnetic_field = {};  ///< T
};

/// Turbulent dispersion by a discrete random walk: eddies add velocities to the field's, whose components have the variance
/// 2 k / 3 each. An eddy lives for 2 C_L k / epsilon, or until a particle with forces has crossed its size, C_mu^(3/4)
/// k^(3/2) / epsilon. The dispersion of a long time is D = (2 k / 3) C_L k / epsilon. Random numbers depend on the seed, the
/// particle's id and the step alone. Near walls, where turbulence is not isotropic, it brings too many small particles to
/// the wall, unless `wall_distance` damps it.
struct TurbulenceOptions {
  /// The names of the numbers of user data that have k at a particle's place; empty: there is no turbulence. A scene takes
  /// them from arrays (MotionScene::sample). User data must also have eddy_x, eddy_y, eddy_z and eddy_left, in a row: a
  /// scene adds them.
  std::string k = {};
  std::string epsilon = {};  ///< likewise, m^2 / s^3; or:
  std::string omega = {};    ///< 1 / s: epsilon = 0.09 k omega
  double lagrangian = 0.15;  ///< C_L, > 0: the Lagrangian integral time is C_L k / epsilon
  /// The name of a value that a scene samples at points: the distance y from walls, m; empty: none. With it each eddy loses
  /// the share exp(-0.02 y+) of its velocity along grad y, after Q. Wang and W. James, 1999. Here y+ = y 0.09^(1/4) sqrt(k)
  /// rho / mu. It needs the fluid's density and viscosity.
  std::string wall_distance = {};
};

/// The matter of a particle.
struct Material {
  double diameter = 0.0;         ///< m, of a sphere of its mass. Walls know of the radius alone.
  double density = 0.0;          ///< kg / m^3
  double charge_per_mass = 0.0;  ///< C / kg
};

/// The particles that one stands for.
struct Parcel {
  std::uint64_t number = 1;
  double mass = 0.0;  ///< kg, of all; 0 without a diameter or a density
};

/// The derivatives of the velocity along each axis: x = du/dx and so on.
struct VelocityGradient {
  Vec3 x, y, z;

  [[nodiscard]] Vec3 curl() const { return {y.z - z.y, z.x - x.z, x.y - y.x}; }
  /// Its product with a vector: the change of the velocity along that way.
  [[nodiscard]] Vec3 along(const Vec3& way) const { return x * way.x + y * way.y + z * way.z; }
};

/// The particles at a stage of a step: its start, or its predicted middle. Entry i of each span is of one particle, in
/// no order that a law may rely on. Particles that are held or stuck are among them: they take no part.
struct LawParticles {
  std::span<const std::uint64_t> ids;
  std::span<const Vec3> positions;
  std::span<const Vec3> velocities;
  std::span<const double> diameters;
  std::span<const double> densities;
  std::span<const double> charges_per_mass;
  std::span<const double> user_data;  ///< Simulation::user_data(), particle by particle
  double time = 0.0;                  ///< s, of the stage
};

/// The fluid at the particles. Without a field it is at rest.
struct LawSamples {
  std::span<const Vec3> velocities;
  /// They are those of the particle's simplex: 0 if the field is given in cells, and in slivers.
  std::span<const VelocityGradient> gradients;
  std::span<const Vec3> rates;  ///< du/dt at a fixed point, m / s^2
};

/// The arrays that a law fills in.
struct LawResult {
  std::span<Vec3> accelerations;  ///< a, m / s^2
  std::span<double> rates;        ///< c, 1 / s, >= 0
  std::span<Vec3> rotations;      ///< r, rad / s
};

/// A law of one's own. It gets the sums of gravity and ForceOptions::terms in the result, and changes them. Each entry may
/// depend on the entries of the same particle alone: ranks have some particles each.
using ParticleLaw = std::function<void(const LawParticles&, const LawSamples&, const LawResult&)>;

}  // namespace dartcast
