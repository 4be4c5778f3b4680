// The functions that bind the public headers, one for each: environment::bind() is in environment.cpp, and binds
// include/dartcast/environment.hpp.
#pragma once

#include <pybind11/pybind11.h>

namespace dartcast::python {

// clang-format off
namespace errors { void bind(pybind11::module_& m); }
namespace ids { void bind(pybind11::module_& m); }

// Meshes.
namespace mesh_data { void bind(pybind11::module_& m); }
namespace mesh_check { void bind(pybind11::module_& m); }
namespace mesh_files { void bind(pybind11::module_& m); }
namespace mesh_selection { void bind(pybind11::module_& m); }
namespace decompose { void bind(pybind11::module_& m); }
namespace generators { void bind(pybind11::module_& m); }
namespace mesh_part { void bind(pybind11::module_& m); }

// Maps and their edits.
namespace predicates { void bind(pybind11::module_& m); }
namespace cell_shape { void bind(pybind11::module_& m); }
namespace combinatorial_map { void bind(pybind11::module_& m); }
namespace map_edits { void bind(pybind11::module_& m); }
namespace cell_complex { void bind(pybind11::module_& m); }
namespace complex_edit { void bind(pybind11::module_& m); }
namespace cutting { void bind(pybind11::module_& m); }
namespace remeshing { void bind(pybind11::module_& m); }
namespace validity { void bind(pybind11::module_& m); }

// Particles.
namespace threads { void bind(pybind11::module_& m); }
namespace particle_state { void bind(pybind11::module_& m); }
namespace contact { void bind(pybind11::module_& m); }
namespace step { void bind(pybind11::module_& m); }
namespace response { void bind(pybind11::module_& m); }
namespace environment { void bind(pybind11::module_& m); }
namespace audit { void bind(pybind11::module_& m); }
namespace shared_environment { void bind(pybind11::module_& m); }
namespace spheres { void bind(pybind11::module_& m); }
namespace dynamics { void bind(pybind11::module_& m); }
namespace trajectory { void bind(pybind11::module_& m); }
namespace deformation { void bind(pybind11::module_& m); }
namespace vector_field { void bind(pybind11::module_& m); }

// All that runs.
namespace statistics { void bind(pybind11::module_& m); }
namespace surface { void bind(pybind11::module_& m); }
namespace bodies { void bind(pybind11::module_& m); }
namespace solids { void bind(pybind11::module_& m); }
namespace catheter { void bind(pybind11::module_& m); }
namespace simulation { void bind(pybind11::module_& m); }
namespace events { void bind(pybind11::module_& m); }
namespace scene { void bind(pybind11::module_& m); }
namespace report { void bind(pybind11::module_& m); }
namespace plan { void bind(pybind11::module_& m); }
namespace run { void bind(pybind11::module_& m); }
// clang-format on

}  // namespace dartcast::python
