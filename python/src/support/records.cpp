// The common part of all records: their representation, comparison, and the values of their constructor.
#include "support/records.hpp"

#include <algorithm>
#include <utility>

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

using Members = std::vector<std::string>;

// "BoxOptions(cells=[1, 1, 1], ...)".
std::string representation(const py::object& record, const std::string& name, const Members& members) {
  std::string text = name + "(";
  for (std::size_t i = 0; i < members.size(); ++i) {
    py::object value = record.attr(members[i].c_str());
    if (py::isinstance<py::array>(value) && py::len(value) <= 4) value = value.attr("tolist")();
    text += (i > 0 ? ", " : "") + members[i] + "=" + py::repr(value).cast<std::string>();
  }
  return text + ")";
}

py::tuple values_of(const py::object& record, const Members& members) {
  py::tuple values(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) values[i] = record.attr(members[i].c_str());
  return values;
}

// Whether all members are equal; arrays entry by entry.
bool equal(const py::object& a, const py::object& b, const Members& members) {
  const py::object equal_arrays = py::module_::import("numpy").attr("array_equal");
  return std::all_of(members.begin(), members.end(), [&](const std::string& member) {
    const py::object x = a.attr(member.c_str());
    const py::object y = b.attr(member.c_str());
    return equal_values(x, y, equal_arrays);
  });
}

void expect_record(const py::object& self, py::handle record) {
  if (!py::isinstance(self, record))
    throw py::type_error("expected " + record.attr("__name__").cast<std::string>() + ", got " +
                         py::type::of(self).attr("__name__").cast<std::string>());
}

template <class F>
void define(py::handle record, const char* name, F&& f) {
  record.attr(name) = py::cpp_function(std::forward<F>(f), py::name(name), py::is_method(record));
}

}  // namespace

void RecordMembers::add(const char* name, const Getter& get, const Setter& set, const char* doc) {
  members_.emplace_back(name);
  const auto checked_get = [get, record = record_](const py::object& self) {
    expect_record(self, record);
    return get(self);
  };
  const auto checked_set = [set, record = record_](const py::object& self, const py::object& value) {
    expect_record(self, record);
    set(self, value);
  };
  const py::object property = py::module_::import("builtins").attr("property");
  record_.attr(name) = property(py::cpp_function(checked_get, py::is_method(record_)),
                                py::cpp_function(checked_set, py::is_method(record_)), py::none(), doc);
}

void RecordMembers::finish() const {
  define(record_, "__repr__",
         [name = name_, members = members_](const py::object& self) { return representation(self, name, members); });
  define(record_, "__eq__", [record = record_, members = members_](const py::object& self, const py::object& other) {
    return py::isinstance(other, record) && equal(self, other, members);
  });
  // Copies and pickles call the constructor with all values.
  define(record_, "__reduce__", [record = record_, members = members_](const py::object& self) {
    return py::make_tuple(record, values_of(self, members));
  });
  // The values are copies already. Some, such as a StepReport, have no deep copy in Python.
  define(record_, "__deepcopy__",
         [record = record_, members = members_](const py::object& self, const py::dict& /*memo*/) {
           return record(*values_of(self, members));
         });
  record_.attr("__hash__") = py::none();
}

void RecordMembers::set(const py::object& self, const py::args& values, const py::kwargs& named) const {
  if (values.size() > members_.size()) {
    throw py::type_error(name_ + ": " + std::to_string(values.size()) + " values, but it has " +
                         std::to_string(members_.size()) + " members");
  }
  for (std::size_t i = 0; i < values.size(); ++i) py::setattr(self, members_[i].c_str(), values[i]);
  for (const auto& [key, value] : named) {
    const auto member = std::find(members_.begin(), members_.end(), key.cast<std::string>());
    if (member == members_.end()) {
      std::string known;
      for (const std::string& m : members_) known += (known.empty() ? "" : ", ") + m;
      throw py::type_error(name_ + " has no member '" + key.cast<std::string>() + "': it has " + known);
    }
    if (static_cast<std::size_t>(member - members_.begin()) < values.size())
      throw py::type_error(name_ + ": '" + *member + "' is given twice");
    py::setattr(self, key, value);
  }
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
