// Contacts and their walls as structured arrays, and as records for a response that sees one contact.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "dartcast/contact.hpp"

namespace dartcast::python {

/// The fields are those of Contact; the dart is `dart_cell`, `dart`, and `patch` that of the first wall.
pybind11::array contact_array(const ContactList& list);
/// The fields are those of WallHit; the face is `cell`, `face`.
pybind11::array wall_array(const std::vector<WallHit>& walls);

}  // namespace dartcast::python
