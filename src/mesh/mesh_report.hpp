// What is in a mesh, what was repaired, and what is wrong with it: the answer of `dartcast check`.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dartcast {

/// One kind of thing found in a mesh: how often, and the first places (indices in the input file, ten at most).
struct Finding {
  std::string kind;
  std::size_t count = 0;
  std::vector<std::size_t> first;
  std::string message;

  /// Counts one more, at this place.
  void add(std::size_t place) {
    ++count;
    if (first.size() < 10) first.push_back(place);
  }
};

enum class Verdict { accept, repair, warn, refuse };

/// A mesh is refused for any defect; it can be used as it is, repaired, or with warnings.
struct MeshReport {
  std::string file;
  std::string format;
  int dimension = 3;                           ///< 2: a planar mesh, whose cells are polygons and whose faces are edges
  bool surface = false;                        ///< cells of two dimensions in space
  std::size_t points = 0;                      ///< after repairs
  std::map<std::string, std::size_t> cells;    ///< cells by type
  std::map<std::string, std::size_t> regions;  ///< cells by region; a region without a name goes by its tag
  std::size_t parts = 0;                       ///< groups of cells connected by faces
  std::vector<Finding> repairs;
  std::vector<Finding> warnings;
  std::vector<Finding> defects;

  [[nodiscard]] bool valid() const { return defects.empty(); }
  [[nodiscard]] Verdict verdict() const {
    if (!defects.empty()) return Verdict::refuse;
    if (!warnings.empty()) return Verdict::warn;
    return repairs.empty() ? Verdict::accept : Verdict::repair;
  }
};

constexpr std::string_view verdict_name(Verdict v) {
  constexpr std::string_view names[] = {"accept", "repair", "warn", "refuse"};
  return names[static_cast<int>(v)];
}

/// Appends a finding unless it is empty.
inline void add_finding(std::vector<Finding>& list, Finding finding) {
  if (finding.count > 0) list.push_back(std::move(finding));
}

}  // namespace dartcast
