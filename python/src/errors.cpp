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

// The classes live as long as the process: a translator may need them until the end.
struct ErrorClasses {
  py::handle error, invalid_argument, invalid_mesh, edit_refused, internal_error, in_use, rank_failed;
};
ErrorClasses& error_classes() {
  static ErrorClasses classes;
  return classes;
}

py::handle make_error(py::module_& m, const char* name, const char* text, const py::tuple& bases) {
  const std::string full = std::string("dartcast.") + name;
  PyObject* made = PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr);
  if (made == nullptr) throw py::error_already_set();
  m.attr(name) = py::handle(made);
  return made;
}

void translate(std::exception_ptr thrown) {
  const ErrorClasses& c = error_classes();
  const auto set = [](py::handle type, const std::exception& e) { PyErr_SetString(type.ptr(), e.what()); };
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const InUse& e) {
    set(c.in_use, e);
  } catch (const InvalidArgument& e) {
    set(c.invalid_argument, e);
  } catch (const InvalidMesh& e) {
    set(c.invalid_mesh, e);
  } catch (const EditRefused& e) {
    set(c.edit_refused, e);
  } catch (const RankFailed& e) {
    set(c.rank_failed, e);
  } catch (const InternalError& e) {
    set(c.internal_error, e);
  } catch (const Error& e) {
    set(c.error, e);
  } catch (const py::cast_error&) {
    // pybind11 would raise RuntimeError, and explain how pybind11 is compiled.
    PyErr_SetString(PyExc_TypeError,
                    "an argument, or the answer of a function that was given, has a wrong type: the docstring of the "
                    "called function names the right ones");
  }
}

}  // namespace

void bind(py::module_& m) {
  ErrorClasses& c = error_classes();
  c.error = make_error(m, "Error", doc("Error"), py::make_tuple(py::handle(PyExc_Exception)));
  c.invalid_argument =
      make_error(m, "InvalidArgument", doc("InvalidArgument"), py::make_tuple(c.error, py::handle(PyExc_ValueError)));
  c.invalid_mesh = make_error(m, "InvalidMesh", doc("InvalidMesh"), py::make_tuple(c.error));
  c.edit_refused = make_error(m, "EditRefused", doc("EditRefused"), py::make_tuple(c.error));
  c.internal_error = make_error(m, "InternalError", doc("InternalError"), py::make_tuple(c.error));
  c.rank_failed = make_error(m, "RankFailed", doc("RankFailed"), py::make_tuple(c.error));
  c.in_use = make_error(m, "InUse",
                        "An object that serves a call is asked for another: by a second thread, or by a response that "
                        "the call waits for.",
                        py::make_tuple(c.error));
  py::register_exception_translator(translate);
}

}  // namespace dartcast::python::errors
