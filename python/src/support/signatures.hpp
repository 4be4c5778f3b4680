// Signatures of functions as Python shows them: pybind11 writes types of C++ into docstrings.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <typeinfo>

namespace dartcast::python {

/// A type as stubs and docstrings name it. `text`: of pybind11, where `%` stands for the next of `types`.
std::string type_name(const char* text, const std::type_info* const* types);

/// Gives each function and method of the module a signature for inspect.signature(), and a docstring that begins with its
/// names, types and defaults. Those of properties take time, and only the stub has them: a private function writes them.
void write_signatures(pybind11::module_& m);

}  // namespace dartcast::python
