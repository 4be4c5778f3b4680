// The extension module dartcast._core. The package (python/dartcast) gives its names to users.
#include <pybind11/pybind11.h>

#include "bind.hpp"
#include "dartcast/run.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_core, m) {
  using namespace dartcast::python;  // NOLINT(google-build-using-namespace): a function for each header
  m.doc() = "Bindings of the C++ library dartcast.";
  m.attr("__version__") = dartcast::version();
  py::options options;
  options.disable_function_signatures();
  bind_errors(m);
  bind_ids(m);

  bind_mesh_data(m);
  bind_mesh_check(m);
  bind_mesh_files(m);
  bind_mesh_selection(m);
  bind_decompose(m);
  bind_generators(m);
  bind_mesh_part(m);

  bind_predicates(m);
  bind_cell_shape(m);
  bind_combinatorial_map(m);
  bind_map_edits(m);
  bind_cell_complex(m);
  bind_complex_edit(m);
  bind_cutting(m);
  bind_remeshing(m);
  bind_validity(m);

  bind_threads(m);
  bind_particle_state(m);
  bind_contact(m);
  bind_step(m);
  bind_response(m);
  bind_environment(m);
  bind_audit(m);
  bind_shared_environment(m);
  bind_spheres(m);
  bind_dynamics(m);
  bind_trajectory(m);
  bind_deformation(m);
  bind_vector_field(m);

  bind_surface(m);
  bind_solids(m);
  bind_bodies(m);
  bind_catheter(m);
  bind_statistics(m);
  bind_simulation(m);
  bind_events(m);
  bind_scene(m);
  bind_report(m);
  bind_run(m);
  bind_plan(m);
}
