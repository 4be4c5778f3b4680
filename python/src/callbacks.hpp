// Responses of Python at walls: one function for all contacts of a round, or one for each contact.
#pragma once

#include <pybind11/pybind11.h>

#include "dartcast/contact.hpp"

namespace dartcast::python {

/// respond(contacts, walls) -> None, an array (m, 3), or a pair of it and a flag or flags (m,).
RoundCallback round_callback(const pybind11::object& respond);

/// respond(contact, walls, earlier) -> None, three numbers, or an AfterContact.
ContactCallback contact_callback(const pybind11::object& respond);

void bind_callbacks(pybind11::module_& m);

}  // namespace dartcast::python
