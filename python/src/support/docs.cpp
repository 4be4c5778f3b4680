// Docstrings from the public headers. The table is generated, sorted by name.
#include "support/docs.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace dartcast::python {
namespace {

using Entry = std::pair<std::string_view, const char*>;

constexpr auto entries = std::to_array<Entry>({
#include "docs.inl"
});

}  // namespace

const char* doc(std::string_view name) {
  const auto* const at = std::lower_bound(entries.begin(), entries.end(), name,
                                          [](const Entry& e, std::string_view n) { return e.first < n; });
  if (at == entries.end() || at->first != name) throw std::logic_error("no public header has " + std::string(name));
  return at->second;
}

}  // namespace dartcast::python
