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
  errors::bind(m);
  ids::bind(m);

  mesh_data::bind(m);
  mesh_check::bind(m);
  mesh_files::bind(m);
  mesh_selection::bind(m);
  decompose::bind(m);
  generators::bind(m);
  mesh_part::bind(m);

  predicates::bind(m);
  cell_shape::bind(m);
  combinatorial_map::bind(m);
  map_edits::bind(m);
  cell_complex::bind(m);
  complex_edit::bind(m);
  cutting::bind(m);
  remeshing::bind(m);
  validity::bind(m);

  threads::bind(m);
  particle_state::bind(m);
  contact::bind(m);
  step::bind(m);
  response::bind(m);
  environment::bind(m);
  audit::bind(m);
  shared_environment::bind(m);
  spheres::bind(m);
  dynamics::bind(m);
  trajectory::bind(m);
  deformation::bind(m);
  vector_field::bind(m);

  surface::bind(m);
  solids::bind(m);
  bodies::bind(m);
  catheter::bind(m);
  statistics::bind(m);
  simulation::bind(m);
  events::bind(m);
  scene::bind(m);
  report::bind(m);
  plan::bind(m);
  run::bind(m);
}
