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

const py::detail::type_info* type_info_of(py::handle record) {
  return py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(record.ptr()));
}

// The C++ record in an object of Python. Throws TypeError where the object is none of this class.
std::byte* record_in(const py::object& self, py::handle record) {
  py::detail::type_caster_generic caster(type_info_of(record));
  if (!py::isinstance(self, record) || !caster.load(self, false)) {
    throw py::type_error("expected " + record.attr("__name__").cast<std::string>() + ", got " +
                         py::type::of(self).attr("__name__").cast<std::string>());
  }
  return static_cast<std::byte*>(caster.value);
}

// A descriptor: __signature__ of a class. To make all signatures takes time, and few are asked for.
struct RecordSignature {
  RecordMembers members;
};

template <class F, class... Extra>
void define(py::handle record, const char* name, F&& f, const Extra&... extra) {
  record.attr(name) = py::cpp_function(std::forward<F>(f), py::name(name), py::is_method(record), extra...);
}

}  // namespace

void RecordMembers::add(const char* name, const char* cpp_name, std::ptrdiff_t offset, Getter get, Setter set,
                        TypeText type) {
  members_.emplace_back(name);
  types_.push_back(type);
  const auto getter = [record = record_, offset, get](const py::object& self) {
    return get(record_in(self, record) + offset);
  };
  const auto setter = [record = record_, offset, set, full_name = name_ + "." + name](const py::object& self,
                                                                                      const py::object& value) {
    set(record_in(self, record) + offset, value, full_name);
  };
  const py::object property = py::module_::import("builtins").attr("property");
  record_.attr(name) =
      property(py::cpp_function(getter, py::is_method(record_)), py::cpp_function(setter, py::is_method(record_)),
               py::none(), doc(cpp_ + "::" + cpp_name));
}

// The values are set through an object of Python that does not own the record.
void RecordMembers::define_constructor(Maker make) const {
  const auto construct = [members = *this, make](py::detail::value_and_holder& self, const py::args& values,
                                                 const py::kwargs& named) {
    auto made = make();
    const auto reference = py::return_value_policy::reference;
    members.set_all(py::reinterpret_steal<py::object>(py::detail::type_caster_generic::cast(
                        made.get(), reference, {}, type_info_of(members.record_), nullptr, nullptr)),
                    values, named);
    self.value_ptr() = made.release();
  };
  const py::sibling others(py::getattr(record_, "__init__", py::none()));  // a record may have further constructors
  define(record_, "__init__", construct, py::detail::is_new_style_constructor(), others);
}

void RecordMembers::finish(Maker make) const {
  define_constructor(make);
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
  record_.attr("__signature__") = py::cast(RecordSignature{*this});
}

py::object RecordMembers::signature() const {
  const py::module_ inspect = py::module_::import("inspect");
  const py::object parameter = inspect.attr("Parameter");
  const py::object defaults = record_();
  py::list parameters;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    parameters.append(parameter(members_[i], parameter.attr("POSITIONAL_OR_KEYWORD"),
                                py::arg("default") = defaults.attr(members_[i].c_str()),
                                py::arg("annotation") = types_[i]()));
  }
  return inspect.attr("Signature")(parameters);
}

void prepare_records(py::module_& m) {
  py::class_<RecordSignature>(m, "_RecordSignature", "Makes the signature of a record when it is asked for.")
      .def("__get__", [](const RecordSignature& s, const py::object& /*record*/, const py::object& /*type*/) {
        return s.members.signature();
      });
}

void RecordMembers::set_all(const py::object& self, const py::args& values, const py::kwargs& named) const {
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
