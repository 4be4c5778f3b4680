// The parts of the binding of dartcast/environment.hpp, one file each.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "support/handles.hpp"

namespace dartcast::python {

using EnvironmentClass = pybind11::class_<EnvironmentHandle, std::shared_ptr<EnvironmentHandle>>;

inline constexpr const char* the_environment = "the Environment";
inline constexpr const char* the_particles = "the set of particles";

/// A read-only array (n, 3).
pybind11::array particle_positions(const Particles& particles);

void bind_particles(pybind11::module_& m);
void bind_places(EnvironmentClass& c);                         ///< location, adding
void bind_motion(pybind11::module_& m, EnvironmentClass& c);   ///< moves and edits
void bind_advance(pybind11::module_& m, EnvironmentClass& c);  ///< steps and responses

}  // namespace dartcast::python
