// The class Transaction of dartcast/map_edits.hpp.
#pragma once

#include <pybind11/pybind11.h>

namespace dartcast::python {

void bind_transaction(pybind11::module_& m);

}  // namespace dartcast::python
