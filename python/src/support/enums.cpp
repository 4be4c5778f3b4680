// Enumerations as classes of Python. They live as long as the process, as the module itself does.
#include "support/enums.hpp"

#include <cctype>
#include <map>

#include "support/docs.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

std::map<std::string, py::handle>& enum_classes() {
  static std::map<std::string, py::handle> classes;
  return classes;
}

}  // namespace

void make_enum(py::module_& m, const char* name, const py::dict& members) {
  py::object made = py::module_::import("enum").attr("IntEnum")(name, members, py::arg("module") = m.attr("__name__"));
  made.attr("__doc__") = doc(name);
  m.attr(name) = made;
  enum_classes()[name] = made.release();
}

bool load_enum(const char* name, py::handle from, std::int64_t& value) {
  const py::handle type = enum_classes().at(name);
  py::object member;
  try {
    if (py::isinstance<py::str>(from)) {
      member = type[from.attr("upper")()];
    } else if (PyIndex_Check(from.ptr()) != 0) {
      member = type(from);
    } else {
      return false;
    }
  } catch (py::error_already_set&) {
    std::string names;
    for (const py::handle m : type) names += (names.empty() ? "" : ", ") + m.attr("name").cast<std::string>();
    throw py::value_error(py::repr(from).cast<std::string>() + " is no " + name + ": it is one of " + names);
  }
  value = member.attr("value").cast<std::int64_t>();
  return true;
}

py::handle cast_enum(const char* name, std::int64_t value) {
  return py::object(enum_classes().at(name)(value)).release();
}

}  // namespace dartcast::python
