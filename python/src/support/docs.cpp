// Docstrings and arguments from the public headers. The table is generated, sorted by name.
#include "support/docs.hpp"

#include <algorithm>
#include <stdexcept>

#include "dartcast/cell_tally.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

struct Entry {
  std::string_view name;
  const char* text;
  std::span<const Argument> arguments = {};
};

constexpr std::uint32_t all_classes = CellTally::all_classes;  // an argument's value in the headers

#include "docs.inl"

const Entry* find(std::string_view name) {
  const auto* const at = std::lower_bound(std::begin(entries), std::end(entries), name,
                                          [](const Entry& e, std::string_view n) { return e.name < n; });
  return at != std::end(entries) && at->name == name ? at : nullptr;
}

const Entry& entry(std::string_view name) {
  if (const Entry* const found = find(name)) return *found;
  throw std::logic_error("no public header has " + std::string(name));
}

}  // namespace

bool is_public(std::string_view name) { return find(name) != nullptr; }

const char* doc(std::string_view name) { return entry(name).text; }

About about(std::string_view name, std::string_view more) {
  const Entry& found = entry(name);
  std::string text = found.text;
  if (!more.empty()) text.append(text.empty() ? "" : "\n\n").append(more);
  return {text, found.arguments};
}

void About::add_to(py::detail::function_record& function) const {
  function.doc = const_cast<char*>(text.c_str());  // pybind11 copies it
  const std::size_t given = function.nargs_pos - (function.is_method ? 1U : 0U);
  if (function.signature != nullptr || !function.args.empty() || given == 0) return;
  if (given != arguments.size())
    throw std::logic_error(std::string(function.name) + ": it has other arguments than in C++: name them");
  if (function.is_method) function.args.emplace_back("self", nullptr, py::handle(), true, false);
  for (const Argument& a : arguments) {
    const py::handle value = a.value != nullptr ? a.value().release() : py::handle();
    function.args.emplace_back(a.name, nullptr, value, true, true);
  }
}

}  // namespace dartcast::python
