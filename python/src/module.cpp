// The extension module dartcast._core. The package (python/dartcast) gives its names to users.
#include <pybind11/pybind11.h>

#include "bind.hpp"
#include "dartcast/run.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_core, m) {
  using namespace dartcast::python;
  m.doc() = "Bindings of the C++ library dartcast.";
  m.attr("__version__") = dartcast::version();
  py::options options;
  options.disable_function_signatures();
  bind_errors(m);
  bind_ids(m);

  bind_threads(m);
  bind_dynamics(m);
  bind_particle_state(m);
  bind_contact(m);
  bind_step(m);
  bind_response(m);
  bind_environment(m);
  bind_audit(m);
  bind_spheres(m);
  bind_trajectory(m);
  bind_deformation(m);
  bind_vector_field(m);
}
