// Reports of edits that come from Python, where anyone may write one.
#pragma once

#include <algorithm>
#include <string>

#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"

namespace dartcast::python {

/// Throws InvalidArgument unless every new vertex was made from vertices below `size`, with one weight each.
inline void expect_report(const ComplexEditReport& report, std::size_t size) {
  for (const PlacedVertex& p : report.placed) {
    const bool right = !p.of.empty() && p.of.size() == p.weights.size() &&
                       std::all_of(p.of.begin(), p.of.end(), [size](Vertex v) { return v.value < size; });
    if (!right) {
      throw InvalidArgument("edit: a vertex was made from others that are not below " + std::to_string(size) +
                            ": give the report of an edit, and what it edited");
    }
  }
}

}  // namespace dartcast::python
