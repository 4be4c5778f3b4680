// The functions that need VTK, for the table of formats.
#include "formats/vtk_functions.hpp"

#include "formats/vtk/vtk_mesh.hpp"
#include "formats/vtk/vtp_read.hpp"
#include "formats/vtk/vtu_points.hpp"

namespace dartcast {

constinit const VtkFunctions vtk_functions = {parse_vtu, parse_legacy_vtk, write_legacy_vtk,
                                              read_vtp,  read_vtu_points,  read_vtp_faces};

}  // namespace dartcast
