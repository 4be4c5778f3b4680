// Leaves bad cells of a mesh file out, and reports them as a warning.
#include "formats/skip_in_file.hpp"

#include <algorithm>
#include <utility>

#include "complex/skip_bad_cells.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"

namespace dartcast {

void skip_bad_cells(MeshFile& file, Threads threads) {
  MeshReport& report = file.report;
  if (!std::all_of(report.defects.begin(), report.defects.end(),
                   [](const Finding& defect) { return is_of_bad_cells(defect.kind); }))
    return;
  try {
    Finding skipped = skip_bad_cells(file.mesh, threads);
    if (skipped.count == 0) return;
    MeshReport after = check_and_repair(file.mesh);
    after.file = std::move(report.file);
    after.format = std::move(report.format);
    after.repairs.insert(after.repairs.begin(), report.repairs.begin(), report.repairs.end());
    after.warnings.insert(after.warnings.begin(), std::move(skipped));
    report = std::move(after);
  } catch (const InvalidMesh& e) {
    if (report.valid()) report.defects.push_back({"structure", 1, {}, e.what()});
  }
}

}  // namespace dartcast
