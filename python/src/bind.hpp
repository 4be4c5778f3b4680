// The functions that bind the public headers, one for each: environment::bind() is in environment.cpp, and binds
// include/dartcast/environment.hpp. Those of records are written by tools/make_bindings.py, for all headers.
#pragma once

#include <pybind11/pybind11.h>

// In this order: a class comes before those that it is a default for.
// clang-format off
#define DARTCAST_PARTS(PART) PART(errors) PART(records) PART(mesh_data) PART(mesh_check) PART(mesh_files) \
  PART(mesh_selection) PART(generators) PART(predicates) PART(cell_shape) \
  PART(combinatorial_map) PART(map_edits) PART(cell_complex) PART(walls) PART(complex_edit) PART(cutting) PART(remeshing) \
  PART(validity) PART(particle_state) PART(step) PART(response) PART(environment) PART(cell_tally) PART(audit) \
  PART(shared_environment) PART(spheres) PART(trajectory) PART(deformation) PART(vector_field) PART(forces) \
  PART(surface) PART(solids) PART(bodies) PART(catheter) PART(statistics) PART(simulation) PART(events) \
  PART(plan) PART(run)
// clang-format on

namespace dartcast::python {

#define DARTCAST_DECLARE(name)     \
  namespace name {                 \
  void bind(pybind11::module_& m); \
  }
DARTCAST_PARTS(DARTCAST_DECLARE)
#undef DARTCAST_DECLARE
namespace records {
void bind_in_classes(pybind11::module_& m);
}

}  // namespace dartcast::python
