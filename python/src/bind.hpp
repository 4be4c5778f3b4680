// The functions that bind the public headers, one for each: bind_environment() is in environment.cpp, and binds
// include/dartcast/environment.hpp.
#pragma once

#include <pybind11/pybind11.h>

namespace dartcast::python {

void bind_errors(pybind11::module_& m);
void bind_ids(pybind11::module_& m);

// Meshes.
void bind_mesh_data(pybind11::module_& m);
void bind_mesh_check(pybind11::module_& m);
void bind_mesh_files(pybind11::module_& m);
void bind_mesh_selection(pybind11::module_& m);
void bind_decompose(pybind11::module_& m);
void bind_generators(pybind11::module_& m);
void bind_mesh_part(pybind11::module_& m);

// Maps and their edits.
void bind_predicates(pybind11::module_& m);
void bind_cell_shape(pybind11::module_& m);
void bind_combinatorial_map(pybind11::module_& m);
void bind_map_edits(pybind11::module_& m);
void bind_cell_complex(pybind11::module_& m);
void bind_complex_edit(pybind11::module_& m);
void bind_cutting(pybind11::module_& m);
void bind_remeshing(pybind11::module_& m);
void bind_validity(pybind11::module_& m);

// Particles.
void bind_threads(pybind11::module_& m);
void bind_particle_state(pybind11::module_& m);
void bind_contact(pybind11::module_& m);
void bind_step(pybind11::module_& m);
void bind_response(pybind11::module_& m);
void bind_environment(pybind11::module_& m);
void bind_audit(pybind11::module_& m);
void bind_shared_environment(pybind11::module_& m);
void bind_spheres(pybind11::module_& m);
void bind_dynamics(pybind11::module_& m);
void bind_trajectory(pybind11::module_& m);
void bind_deformation(pybind11::module_& m);
void bind_vector_field(pybind11::module_& m);

// All that runs.
void bind_statistics(pybind11::module_& m);
void bind_surface(pybind11::module_& m);
void bind_bodies(pybind11::module_& m);
void bind_solids(pybind11::module_& m);
void bind_catheter(pybind11::module_& m);
void bind_simulation(pybind11::module_& m);
void bind_events(pybind11::module_& m);
void bind_scene(pybind11::module_& m);
void bind_report(pybind11::module_& m);
void bind_plan(pybind11::module_& m);
void bind_run(pybind11::module_& m);

}  // namespace dartcast::python
