// Records of C++ as rows of structured arrays: contacts, walls, states, locations. Rows are copies.
#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/solids.hpp"
#include "dartcast/spheres.hpp"
#include "dartcast/step.hpp"

namespace dartcast::python {

using Row3 = std::array<double, 3>;

struct ContactRow {
  std::uint32_t particle;
  std::uint8_t kind;
  bool last;
  std::uint16_t patch;
  double time_of_impact;
  Row3 point, normal, wall_displacement, displacement, unused;
  std::uint32_t first_wall, wall_count, earlier, together, cell;
  std::uint16_t dart;
};
struct WallRow {
  std::uint32_t cell;
  std::uint16_t face, triangle, patch;
  Row3 normal;
};
struct StateRow {
  Row3 position;
  std::uint32_t cell;
  std::uint16_t simplex;
  std::uint8_t touching_count;
  bool held;
  std::array<std::uint32_t, 3> touching_cell;
  std::array<std::uint16_t, 3> touching_face;
};
struct LocationRow {
  std::uint8_t place, kind;
  std::uint16_t simplex, dart;
  std::uint32_t cell, dart_cell;
};
struct AddRow {
  std::uint32_t particle;
  std::uint8_t place, kind;
  std::uint16_t simplex, dart;
  std::uint32_t cell, dart_cell;
};
struct RayRow {
  std::uint8_t origin;
  bool hit;
  std::uint8_t kind;
  std::uint32_t cell;
  std::uint16_t face, triangle, patch;
  double distance;
  Row3 point, normal;
  std::uint32_t invalid_cell;
};
struct HeldRow {
  std::uint32_t particle, cell;
};
struct StoppedRow {
  std::uint32_t particle;
  Row3 unused;
};
struct OverlapRow {
  std::uint32_t particle, cell;
  std::uint16_t face;
  double depth, left;
  Row3 point, normal;
};
struct SolidContactRow {
  std::uint32_t solid;
  std::uint8_t kind, count, wall_kind;
  std::array<std::uint32_t, 3> vertices;
  Row3 weights;
  std::uint32_t cell;
  std::uint16_t face, triangle, dart, patch;
  double time_of_impact, gap;
  Row3 point, wall_point, normal, displacement, wall_displacement;
};
struct OrphanRow {
  std::uint32_t particle;
  std::uint8_t place, outcome;
  Row3 position;
  double distance;
};

/// Makes the dtypes known. To be called once, first.
void register_rows();

pybind11::array rows_of(const std::vector<Contact>& contacts, std::span<const WallHit> walls);
pybind11::array rows_of(std::span<const WallHit> walls);
pybind11::array rows_of(std::span<const ParticleState> states);
pybind11::array rows_of(const std::vector<Location>& locations);
pybind11::array rows_of(const std::vector<AddResult>& added);
pybind11::array rows_of(const std::vector<RayHit>& hits);
pybind11::array rows_of(const std::vector<HeldParticle>& held);
pybind11::array rows_of(const std::vector<StoppedParticle>& stopped);
pybind11::array rows_of(const std::vector<SphereOverlap>& overlaps);
pybind11::array rows_of(const std::vector<SolidContact>& contacts);
pybind11::array rows_of(const std::vector<OrphanedParticle>& orphaned);

/// An array (n,) of this dtype, from one whose fields have the same names and types. Where they stand makes no
/// difference: numpy.concatenate() packs them. Throws TypeError for another array; `expected` and `remedy`: of its text.
pybind11::array structured(const pybind11::object& x, const pybind11::dtype& wanted, const char* name,
                           const char* expected, const char* remedy);

/// States from an array as rows_of() makes it. Throws TypeError for another dtype.
std::vector<ParticleState> states_of(const pybind11::object& x, const char* name);

}  // namespace dartcast::python
