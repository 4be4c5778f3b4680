// Binds dartcast/error.hpp: the exceptions of C++ with their texts. InvalidArgument is a ValueError, too.
#include <pybind11/pybind11.h>

#include "bind.hpp"
#include "dartcast/error.hpp"
#include "dartcast/ranks.hpp"
#include "support/docs.hpp"
#include "support/in_use.hpp"

namespace py = pybind11;

namespace dartcast::python::errors {
namespace {

// The class lives as long as the process: its translator may need it until the end.
template <class E>
py::handle bind_error(py::module_& m, const char* name, const char* text, const py::tuple& bases) {
  static py::handle type;
  const std::string full = std::string("dartcast.") + name;
  type = PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr);
  if (!type) throw py::error_already_set();
  m.attr(name) = type;
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const E& e) {
      PyErr_SetString(type.ptr(), e.what());
    }
  });
  return type;
}

// pybind11 would raise RuntimeError, and explain how pybind11 is compiled.
void translate_cast_error(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const py::cast_error&) {
    PyErr_SetString(PyExc_TypeError,
                    "an argument, or the answer of a function that was given, has a wrong type: the docstring of the "
                    "called function names the right ones");
  }
}

}  // namespace

// The translator that was registered last is asked first: a class comes after its base.
void bind(py::module_& m) {
  py::register_exception_translator(translate_cast_error);
  const py::handle error = bind_error<Error>(m, "Error", doc("Error"), py::make_tuple(py::handle(PyExc_Exception)));
  const py::tuple bases = py::make_tuple(error);
  bind_error<InvalidArgument>(m, "InvalidArgument", doc("InvalidArgument"),
                              py::make_tuple(error, py::handle(PyExc_ValueError)));
  bind_error<InvalidMesh>(m, "InvalidMesh", doc("InvalidMesh"), bases);
  bind_error<EditRefused>(m, "EditRefused", doc("EditRefused"), bases);
  bind_error<InternalError>(m, "InternalError", doc("InternalError"), bases);
  bind_error<RankFailed>(m, "RankFailed", doc("RankFailed"), bases);
  bind_error<InUse>(m, "InUse",
                    "An object that serves a call is asked for another: by a second thread, or by a response that the "
                    "call waits for.",
                    bases);
}

}  // namespace dartcast::python::errors
