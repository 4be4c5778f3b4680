// Laws of particles that are functions of Python.
#pragma once

#include <pybind11/pybind11.h>

#include "dartcast/forces.hpp"

namespace dartcast::python {

/// A law that calls this function with Python's lock taken; none if it is None. It throws what the function raises, and
/// InvalidArgument if the function has kept an array.
ParticleLaw law_of(const pybind11::object& function);

}  // namespace dartcast::python
