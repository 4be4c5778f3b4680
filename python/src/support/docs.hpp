// Docstrings: the comments of the public headers (make_docs.py writes them into docs.inl).
#pragma once

#include <string_view>

namespace dartcast::python {

/// The comment of a public C++ name, as "Environment::advance"; those of several overloads one after another. Empty
/// where the header has none. Throws std::logic_error where no header has the name: importing the package then fails.
const char* doc(std::string_view name);

}  // namespace dartcast::python
