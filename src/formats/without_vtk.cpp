// The functions that need VTK, in a build without it: none.
#include "formats/vtk_functions.hpp"

namespace dartcast {

constinit const VtkFunctions vtk_functions = {};

}  // namespace dartcast
