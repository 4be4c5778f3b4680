// A blood vessel that branches: one inlet, two outlets, tissue around.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// SI units: metres, radians, metres per second.
struct VesselOptions {
  double radius = 3e-3;                                   ///< of the trunk's lumen
  double trunk_length = 30e-3;                            ///< along the centre line, in whole steps
  std::array<double, 2> branch_lengths = {36e-3, 30e-3};  ///< left, right
  double branch_radius = 0.79;  ///< of each branch, as a share of `radius`; Murray's law asks for 0.794
  double branch_angle = 0.6;    ///< between the trunk's and each branch's direction, in one plane
  double out_of_plane = 0.5;    ///< by how much the trunk and, further on, the branches turn out of that plane
  double tissue_thickness = 1.5e-3;
  std::uint32_t core = 6;           ///< cells across the square in the middle of each half of the lumen
  std::uint32_t rings = 3;          ///< rings of cells around that square
  std::uint32_t tissue_layers = 2;  ///< layers of cells through the tissue
  double step_length = 0.9e-3;      ///< of a cell along the centre line
  double peak_speed = 0.3;          ///< of the flow, in the middle of the inlet
};

/// A conforming mesh of hexahedra, with prisms where the tissue between the branches begins. The trunk comes along z
/// and is made of two halves sewn along a plane; at the carina (the origin) they part, and each becomes round along its
/// own branch, the left one towards -x, the right one towards +x. At the default options: 20,948 cells, 15,012 of them
/// lumen.
///
/// Regions: 1 "lumen" (free), 2 "tissue" (blocked). Patches: 1 "inlet", 2 "outlet_left", 3 "outlet_right" (the lumen's
/// ends), 4 "wall" (the faces between lumen and tissue, seen from the lumen), 5 "outer" (the tissue's outside, with its
/// ends). Point data:
///  - "velocity" (3): along the vessel, a paraboloid over the inlet, 0 on the wall and in the tissue. The flux through
///  each section is the
///    same, half of it in each branch; between sections the field is free of divergence as far as the mesh resolves it.
///  - "pulse_direction" (3): from the centre line to the point, in its section: the vessel widens by a share a in
///  radius where
///    points move by a times this.
///  - "path_length" (1): along the centre line from the inlet.
///
/// Throws InvalidArgument where an option is out of the range in which every cell is positive: radius > 0, trunk_length
/// >= 4 radii, branch_lengths
/// >= 6 radii, branch_radius in [0.7, 0.85], branch_angle in [0.4, 0.8], out_of_plane in [0, 0.7], tissue_thickness in
/// [0.2, 0.8] radii, core in [2, 64], rings in [1, 32], tissue_layers in [1, 32], step_length in [0.02, 0.5] radii,
/// peak_speed finite. Cost: about 2 us per cell.
MeshData generate_vessel(const VesselOptions& options = {});

}  // namespace dartcast
