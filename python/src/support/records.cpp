// The common part of all records: their representation, comparison, and the values of their constructor.
#include "support/records.hpp"

#include <algorithm>

namespace py = pybind11;

namespace dartcast::python {
namespace {

// Lists may hold arrays, at any depth. `equal`: numpy.array_equal.
bool equal_values(const py::object& x, const py::object& y, const py::object& equal) {
  if (py::isinstance<py::array>(x) || py::isinstance<py::array>(y)) return equal(x, y).cast<bool>();
  if (!py::isinstance<py::list>(x) || !py::isinstance<py::list>(y)) return x.equal(y);
  const py::list a(x);
  const py::list b(y);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](py::handle one, py::handle other) {
    return equal_values(py::reinterpret_borrow<py::object>(one), py::reinterpret_borrow<py::object>(other), equal);
  });
}

}  // namespace

std::string representation(const py::object& record, const std::vector<std::string>& members) {
  std::string text = py::type::of(record).attr("__name__").cast<std::string>() + "(";
  for (std::size_t i = 0; i < members.size(); ++i) {
    py::object value = record.attr(members[i].c_str());
    if (py::isinstance<py::array>(value) && py::len(value) <= 4) value = value.attr("tolist")();
    text += (i > 0 ? ", " : "") + members[i] + "=" + py::repr(value).cast<std::string>();
  }
  return text + ")";
}

py::tuple member_values(const py::object& record, const std::vector<std::string>& members) {
  py::tuple values(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) values[i] = record.attr(members[i].c_str());
  return values;
}

bool equal_members(const py::object& a, const py::object& b, const std::vector<std::string>& members) {
  const py::object equal = py::module_::import("numpy").attr("array_equal");
  return std::all_of(members.begin(), members.end(), [&](const std::string& member) {
    const py::object x = a.attr(member.c_str());
    const py::object y = b.attr(member.c_str());
    return equal_values(x, y, equal);
  });
}

py::dict named_values(const char* record, const std::vector<std::string>& members, const py::args& values,
                      const py::kwargs& named) {
  if (values.size() > members.size()) {
    throw py::type_error(std::string(record) + ": " + std::to_string(values.size()) + " values, but it has " +
                         std::to_string(members.size()) + " members");
  }
  py::dict all;
  for (std::size_t i = 0; i < values.size(); ++i) all[members[i].c_str()] = values[i];
  for (const auto& [key, value] : named) {
    const auto name = key.cast<std::string>();
    if (std::find(members.begin(), members.end(), name) == members.end()) {
      std::string known;
      for (const std::string& m : members) known += (known.empty() ? "" : ", ") + m;
      throw py::type_error(std::string(record) + " has no member '" + name + "': it has " + known);
    }
    if (all.contains(key)) throw py::type_error(std::string(record) + ": '" + name + "' is given twice");
    all[key] = value;
  }
  return all;
}

py::object without_writing(py::object value) {
  if (py::isinstance<py::array>(value)) return read_only(py::reinterpret_borrow<py::array>(value));
  return value;
}

void refuse_member(const std::string& member, const std::string& expected, py::handle value) {
  const bool is_class = expected.find('%') != std::string::npos;
  throw py::type_error(member + ": expected " + (is_class ? "an object of its class, see help()" : expected) +
                       "; got " + py::repr(value).cast<std::string>() + ", a " +
                       py::type::of(py::reinterpret_borrow<py::object>(value)).attr("__name__").cast<std::string>());
}

}  // namespace dartcast::python
