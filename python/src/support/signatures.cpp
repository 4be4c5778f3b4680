// Signatures of functions. A docstring of pybind11 begins with "name(self: dartcast._core.Class, x: int = 0) -> float". It
// becomes "name(self, x=0)", a mark, then the line with simpler types: Python takes what is before the mark for the
// signature.
#include "support/signatures.hpp"

#include <array>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

namespace py = pybind11;

namespace dartcast::python {
namespace {

constexpr std::string_view mark = ")\n--\n\n";

std::string simplified(std::string text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 14> words = {{
      {"dartcast._core.", ""},
      {"dartcast::", ""},
      {"::", "."},
      {"three numbers", "Vector"},
      {"float64 (n, 3)", "Points"},
      {"whole numbers (n,)", "Integers"},
      {"numbers (n,)[numpy.", "Numbers["},
      {"numpy.ndarray[numpy.", "NDArray["},
      {"numpy.ndarray[bool]", "NDArray[bool]"},
      {"numpy.ndarray", "Records"},
      {"os.PathLike", "Path"},
      {"List[", "list["},
      {"Dict[", "dict["},
      {"Tuple[", "tuple["},
  }};
  for (const auto& [from, to] : words) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }
  return text;
}

// Where the first of `ends` is that stands in no brackets and in no quotes.
std::size_t find_outside(std::string_view text, std::string_view ends, std::size_t from) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = from; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\'') quoted = !quoted;
    if (quoted) continue;
    if (depth == 0 && ends.find(c) != std::string_view::npos) return i;
    if (std::strchr("([{<", c) != nullptr) ++depth;
    if (std::strchr(")]}", c) != nullptr || (c == '>' && text[i - 1] != '-')) --depth;
  }
  return text.size();
}

// "<Kind.FACE: 2>" is Kind.FACE, and a record is shown without its members.
std::string simple_value(std::string_view value) {
  if (value.starts_with('<')) return std::string(value.substr(1, value.find(':') - 1));
  const std::size_t bracket = value.find('(');
  const bool is_record = bracket != std::string_view::npos && bracket > 0 && std::isupper(value[0]) != 0;
  return std::string(is_record ? value.substr(0, bracket) : value) + (is_record ? "()" : "");
}

// A default that Python can read in a signature; other defaults are `...` there.
std::string literal(const std::string& value) {
  if (value == "inf") return "1e999";
  return value.ends_with("()") && value.size() > 2 ? "..." : value;
}

struct Signature {
  std::string typed;  // "self, x: int = 0"
  std::string plain;  // "self, x=0"
};

Signature signature_of(std::string_view arguments) {
  Signature made;
  for (std::size_t at = 0; at < arguments.size(); at += 2) {
    const std::size_t end = find_outside(arguments, ",", at);
    const std::string_view argument = arguments.substr(at, end - at);
    const std::size_t colon = std::min(argument.find(':'), argument.size());
    const std::size_t equal = find_outside(argument, "=", 0);
    const std::string name(argument.substr(0, colon));
    const std::string value = equal < argument.size() ? simple_value(argument.substr(equal + 2)) : std::string();
    const std::string separator = made.plain.empty() ? "" : ", ";
    made.plain += separator + name + (value.empty() ? "" : "=" + literal(value));
    const std::string_view type = argument.substr(colon, std::min(equal, argument.size()) - colon);
    made.typed += separator + name +
                  (name == "self" ? "" : std::string(type.substr(0, type.find_last_not_of(' ') + 1))) +
                  (value.empty() ? "" : " = " + value);
    at = end;
  }
  return made;
}

// A line of pybind11, "name(arguments) -> result": with simpler types, and its signature for Python.
std::pair<std::string, std::string> rewritten(const std::string& line) {
  const std::string text = simplified(line);
  const std::size_t open = text.find('(');
  const std::size_t close = find_outside(text, ")", open + 1);
  const Signature s = signature_of(std::string_view(text).substr(open + 1, close - open - 1));
  return {text.substr(0, open + 1) + s.typed + text.substr(close), text.substr(0, open + 1) + s.plain};
}

std::string rewritten_doc(const std::string& text) {
  if (text.find("\nOverloaded function.\n") == std::string::npos) {
    const std::size_t end = text.find('\n');
    const auto [typed, plain] = rewritten(text.substr(0, end));
    return plain + std::string(mark) + typed + (end == std::string::npos ? "" : text.substr(end));
  }
  // Each overload has a line that begins with its number.
  std::string made = text.substr(0, text.find(')')) + std::string(mark);
  std::size_t number = 1;
  for (std::size_t at = text.find("\n\n") + 2; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    const std::string begin = std::to_string(number) + ". ";
    const bool is_signature = line.starts_with(begin) && line.find(") -> ") != std::string::npos;
    number += is_signature ? 1 : 0;
    made += (is_signature ? rewritten(line.substr(begin.size())).first : line) + "\n";
    at = end + 1;
  }
  return made;
}

void rewrite_function(py::handle object) {
  if (PyInstanceMethod_Check(object.ptr()) != 0) object = PyInstanceMethod_GET_FUNCTION(object.ptr());
  if (PyCFunction_Check(object.ptr()) == 0) return;
  PyMethodDef& method = *reinterpret_cast<PyCFunctionObject*>(object.ptr())->m_ml;
  if (method.ml_doc == nullptr || std::strstr(method.ml_doc, mark.data()) != nullptr) return;
  const std::string text = rewritten_doc(method.ml_doc);
  std::free(const_cast<char*>(method.ml_doc));
  method.ml_doc = strdup(text.c_str());
}

// Python reads the signature of a class from the text with which the class was made.
void rewrite_constructor(py::handle type) {
  if (!type.attr("__dict__").contains("__init__") || type.attr("__dict__").contains("__signature__")) return;
  const py::object signature = py::getattr(type.attr("__init__"), "__text_signature__", py::none());
  if (signature.is_none()) return;
  auto* const python_type = reinterpret_cast<PyTypeObject*>(type.ptr());
  std::string text = signature.cast<std::string>();
  text = type.attr("__name__").cast<std::string>() + "(" + text.substr(std::min(text.find_first_of(" )"), text.size()));
  text =
      text.substr(0, text.size() - 1) + std::string(mark) + (python_type->tp_doc != nullptr ? python_type->tp_doc : "");
  auto* const kept = static_cast<char*>(PyObject_Malloc(text.size() + 1));
  std::memcpy(kept, text.c_str(), text.size() + 1);
  PyObject_Free(const_cast<char*>(python_type->tp_doc));
  python_type->tp_doc = kept;
}

void rewrite_scope(py::handle scope, const py::object& module, bool properties) {
  const py::dict members(scope.attr("__dict__"));
  for (const auto& [name, member] : members) {
    if (PyType_Check(member.ptr()) != 0) {
      if (Py_TYPE(member.ptr()) != py::detail::get_internals().default_metaclass) continue;  // an enumeration, an error
      if (!py::object(member.attr("__module__")).equal(module)) continue;
      rewrite_scope(member, module, properties);
      rewrite_constructor(member);
    } else if (py::isinstance(member, reinterpret_cast<PyObject*>(&PyProperty_Type))) {
      if (!properties) continue;
      rewrite_function(member.attr("fget"));
      rewrite_function(member.attr("fset"));
    } else if (py::isinstance(member, reinterpret_cast<PyObject*>(&PyStaticMethod_Type))) {
      rewrite_function(member.attr("__func__"));
    } else {
      rewrite_function(member);
    }
  }
}

}  // namespace

std::string type_name(const char* text, const std::type_info* const* types) {
  std::string name;
  for (const char* c = text; *c != '\0'; ++c) {
    if (*c == '{' || *c == '}') continue;
    if (*c != '%') {
      name += *c;
    } else if (const auto* type = py::detail::get_type_info(**types++)) {
      name += py::handle(reinterpret_cast<PyObject*>(type->type)).attr("__qualname__").cast<std::string>();
    }
  }
  return simplified(name);
}

void write_signatures(py::module_& m) {
  rewrite_scope(m, m.attr("__name__"), false);
  m.def("_write_signatures_of_properties", [] {
    const auto module = py::module_::import("dartcast._core");
    rewrite_scope(module, module.attr("__name__"), true);
  });
}

}  // namespace dartcast::python
