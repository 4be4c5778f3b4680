// Leaves the bad cells of a mesh out.
#include "complex/skip_bad_cells.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "mesh/collapsed.hpp"
#include "mesh/faces.hpp"
#include "mesh/orientation.hpp"

namespace dartcast {

namespace {

using CellMarks = std::vector<std::uint8_t>;  // 1: bad

template <class T>
void keep_good(std::vector<T>& values, const CellMarks& bad, std::size_t each = 1) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (bad[i / each] == 0) values[kept++] = values[i];
  }
  values.resize(kept);
}

void remove_cells(MeshData& mesh, const CellMarks& bad) {
  MeshData kept;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (bad[c] == 0) kept.add_cell(mesh.types[c], mesh.cell(c));
  }
  mesh.types = std::move(kept.types);
  mesh.offsets = std::move(kept.offsets);
  mesh.connectivity = std::move(kept.connectivity);
  keep_good(mesh.source, bad);
  keep_good(mesh.regions, bad);
  keep_good(mesh.free, bad);
  for (DataArray& array : mesh.cell_data) keep_good(array.values, bad, array.components);
}

// Cells without volume, and cells that no order of their corners makes positive.
CellMarks shapeless_cells(MeshData& mesh) {
  CellMarks bad(mesh.cell_count(), 0);
  for (std::size_t c = 0; c < bad.size(); ++c) {
    const Orientation found = orient_cell(mesh, c);
    bad[c] = found == Orientation::flat || found == Orientation::inverted ? 1 : 0;
  }
  return bad;
}

CellMarks repeating_cells(const MeshData& mesh) {
  CellMarks bad(mesh.cell_count(), 0);
  for (std::size_t c = 0; c < bad.size(); ++c) bad[c] = repeats_corner(mesh, c) ? 1 : 0;
  return bad;
}

// Groups of cells that match face to face, and the pairs of groups that use a face from the same side. The two sides of
// an overlap alternate from group to group. The side with fewer cells is the inverted one.
class OverlappingGroups {
 public:
  explicit OverlappingGroups(const FaceMatch& match) : group_of_(match.part) {
    for (const std::uint32_t g : group_of_) ++size_[g];
    for (const auto& [a, b] : match.same_side) {
      beside_[group_of_[a]].push_back(group_of_[b]);
      beside_[group_of_[b]].push_back(group_of_[a]);
    }
  }

  CellMarks smaller_side() {
    for (const auto& entry : beside_) {
      if (side_.count(entry.first) == 0) divide_from(entry.first);
    }
    CellMarks bad(group_of_.size(), 0);
    for (std::size_t c = 0; c < bad.size(); ++c) {
      const auto found = bad_.find(group_of_[c]);
      bad[c] = found != bad_.end() && found->second ? 1 : 0;
    }
    return bad;
  }

 private:
  void divide_from(std::uint32_t first) {
    std::vector<std::uint32_t> reached = {first};
    std::array<std::size_t, 2> cells{};
    side_[first] = 0;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const std::uint32_t g = reached[i];
      cells[side_[g]] += size_[g];
      for (const std::uint32_t next : beside_[g]) {
        if (side_.try_emplace(next, 1U - side_[g]).second) reached.push_back(next);
      }
    }
    const unsigned fewer = cells[0] < cells[1] ? 0 : 1;
    for (const std::uint32_t g : reached) bad_[g] = side_[g] == fewer;
  }

  const std::vector<std::uint32_t>& group_of_;
  std::map<std::uint32_t, std::size_t> size_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> beside_;
  std::map<std::uint32_t, unsigned> side_;
  std::map<std::uint32_t, bool> bad_;
};

CellMarks indivisible_cells(const MeshData& mesh, Threads threads) {
  const CellComplex complex(mesh, threads);
  CellMarks bad(mesh.cell_count(), 0);
  std::vector<std::uint32_t> sources;
  for (const InvalidCell& invalid : complex.invalid_cells()) sources.push_back(complex.map().source(invalid.cell));
  std::sort(sources.begin(), sources.end());
  for (std::size_t c = 0; c < bad.size(); ++c)
    bad[c] = std::binary_search(sources.begin(), sources.end(), mesh.source[c]) ? 1 : 0;
  return bad;
}

bool has_any(const CellMarks& bad) { return std::find(bad.begin(), bad.end(), 1) != bad.end(); }

// The cells of the first kind that occurs.
CellMarks some_bad_cells(MeshData& mesh, const MeshReport& report, Threads threads) {
  for (const Finding& defect : report.defects) {
    if (!is_of_bad_cells(defect.kind)) throw InvalidMesh(defect.message);
  }
  if (report.valid()) return indivisible_cells(mesh, threads);
  const bool repeats = report.defects.front().kind == "repeated_corner";
  CellMarks bad = repeats ? repeating_cells(mesh) : shapeless_cells(mesh);
  if (!has_any(bad) && !repeats) {
    const FaceMatch match = match_faces(mesh);
    bad = OverlappingGroups(match).smaller_side();
  }
  if (!has_any(bad)) throw InvalidMesh(report.defects.front().message);
  return bad;
}

}  // namespace

bool is_of_bad_cells(std::string_view defect) {
  return defect == "flat" || defect == "inverted" || defect == "same_side" || defect == "repeated_corner";
}

Finding skip_bad_cells(MeshData& mesh, Threads threads) {
  std::vector<std::uint32_t> skipped;
  while (true) {
    const MeshReport report = check_and_repair(mesh);
    if (mesh.source.empty()) {
      mesh.source.resize(mesh.cell_count());
      std::iota(mesh.source.begin(), mesh.source.end(), 0U);
    }
    const CellMarks bad = some_bad_cells(mesh, report, threads);
    if (!has_any(bad)) break;
    for (std::size_t c = 0; c < bad.size(); ++c) {
      if (bad[c] != 0) skipped.push_back(mesh.source[c]);
    }
    remove_cells(mesh, bad);
  }
  std::sort(skipped.begin(), skipped.end());
  Finding finding{"bad_cells",
                  0,
                  {},
                  "bad cells (flat, inverted, or not to be divided into positive simplices) are "
                  "blocked: they are left out, and their faces are walls"};
  for (const std::uint32_t c : skipped) finding.add(c);
  return finding;
}

}  // namespace dartcast
