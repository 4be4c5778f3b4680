// Binds dartcast/report.hpp.
#include "dartcast/report.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::report {

void bind(py::module_& m) {
  Record<ReportOptions>(m, "ReportOptions")
      .field("particles", &ReportOptions::particles)
      .field("frames", &ReportOptions::frames)
      .field("bytes", &ReportOptions::bytes)
      .field("threads", &ReportOptions::threads)
      .finish();
  Record<ReportSummary>(m, "ReportSummary")
      .field("file", &ReportSummary::file)
      .field("bytes", &ReportSummary::bytes)
      .field("particles", &ReportSummary::particles)
      .field("particles_recorded", &ReportSummary::particles_recorded)
      .field("particles_of_run", &ReportSummary::particles_of_run)
      .field("frames", &ReportSummary::frames)
      .field("frames_recorded", &ReportSummary::frames_recorded)
      .field("notes", &ReportSummary::notes)
      .finish();
  m.def(
      "write_report",
      [](const std::filesystem::path& run_folder, const ReportOptions& options) {
        const ReportOptions own = options;
        const py::gil_scoped_release release;
        return write_report(run_folder, own);
      },
      py::arg("run_folder"), py::arg("options") = ReportOptions{}, doc("write_report"));
  m.def("report_file", &report_file, py::arg("run_folder"), doc("report_file"));
}

}  // namespace dartcast::python::report
