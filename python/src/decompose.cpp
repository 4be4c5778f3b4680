// Binds dartcast/decompose.hpp.
#include "dartcast/decompose.hpp"

#include "bind.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::decompose {

void bind(py::module_& m) { function(m, "decompose", &dartcast::decompose); }

}  // namespace dartcast::python::decompose
