// The velocity field of a simulation: a VectorField in m / s.
#pragma once

#include "dartcast/vector_field.hpp"

namespace dartcast {

using VelocityField = VectorField;

}  // namespace dartcast
