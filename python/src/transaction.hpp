// The class Transaction of dartcast/map_edits.hpp.
#pragma once

#include <pybind11/pybind11.h>

namespace dartcast::python {

namespace transaction {
void bind(pybind11::module_& m);
}

}  // namespace dartcast::python
