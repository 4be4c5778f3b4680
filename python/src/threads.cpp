// Binds dartcast/threads.hpp. A number of threads is a plain integer in Python.
#include "dartcast/threads.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::threads {

void bind(py::module_& m) {
  m.def("max_threads", &max_threads, doc("max_threads"));
  m.def("check_threads", &check_threads, py::arg("threads"), py::call_guard<py::gil_scoped_release>(),
        doc("check_threads"));
}

}  // namespace dartcast::python::threads
