// The C interface of the engine, for JavaScript and for the tests. engine.cpp says how errors, arrays and texts return.
#pragma once

#include <cstdint>

/// What dartcast_read() reads. Those from wall_triangles on are whole numbers, of 32 bits.
enum class EngineArray : std::uint32_t {
  positions,   ///< of particles: 3 numbers each, as all points and vectors
  velocities,  ///< likewise
  radii,       ///< likewise
  ids,         ///< likewise
  vertices,    ///< all positions of the environment: places of pulls
  wall_points,
  solid_points,     ///< of solid `index`
  catheter_frames,  ///< of catheter `index`: tangent, normal and binormal at each of its points
  contacts,         ///< of particles in the last step: id, patch, time, point, normal: 9 numbers each
  wall_triangles,   ///< 3 places in wall_points each
  wall_patches,     ///< of the triangles
  wall_vertices,    ///< of the wall points: places in `vertices`
  solid_triangles,  ///< of solid `index`: 3 places in its points each; none of a catheter
};

extern "C" {
/// Makes the simulation. `text`: of a scene file, named scene.toml for its relative paths.
const char* dartcast_make(const char* text);
/// Adds the particles, bodies, catheters and solids of a text.
const char* dartcast_add(const char* text);
/// Makes the edits of a text now: its events, without their times.
const char* dartcast_edit(const char* text);
const char* dartcast_step(std::uint32_t count);
/// As Simulation::steer() and steer_solid().
const char* dartcast_steer(std::uint32_t catheter, double push, double turn);
const char* dartcast_steer_solid(std::uint32_t solid, double vx, double vy, double vz, double tx, double ty, double tz);
/// As Simulation::pull() by pull_around().
const char* dartcast_pull(double x, double y, double z, double dx, double dy, double dz, double reach, double duration);
/// As Simulation::pull(): 3 numbers for each of `vertices`.
const char* dartcast_pull_all(const double* displacement, std::uint32_t numbers, double duration);
/// Numbers; dartcast_length() of them. Precondition: `index` is less than the number of solids or catheters.
const void* dartcast_read(EngineArray what, std::uint32_t index);
std::uint32_t dartcast_length();
/// A JSON object: steps, time, particles, edits, dimension, patches, solids, totals, warnings.
const char* dartcast_info();
/// A JSON object: checked, failed, first.
const char* dartcast_audit();
const char* dartcast_hash();
/// The bytes from address 0 on that hold the engine's state.
std::uint32_t dartcast_memory();
}
