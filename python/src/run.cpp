// Binds dartcast/run.hpp: runs of scenes. Ctrl-C, and exceptions of the progress callback, end a run between two steps.
#include "dartcast/run.hpp"

#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "bind.hpp"
#include "ranks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::run {
namespace {

// Asks Python after each step whether to go on. An exception cancels the run, whose output is then complete.
class Asking {
 public:
  explicit Asking(py::object progress) : progress_(std::move(progress)) {
    if (!progress_.is_none() && PyCallable_Check(progress_.ptr()) == 0)
      throw py::type_error("progress: expected a function of the number of steps done and of all");
  }

  bool operator()(std::uint64_t done, std::uint64_t all) {
    if (progress_.is_none() && !is_due()) return true;
    const py::gil_scoped_acquire acquire;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      return progress_.is_none() || goes_on(progress_(done, all));
    } catch (...) {
      raised_ = std::current_exception();
      return false;
    }
  }
  /// To be called with Python's lock.
  void rethrow() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  static bool goes_on(const py::object& answer) { return answer.is_none() || answer.cast<bool>(); }
  // Python's lock can take milliseconds to get, where other threads compute.
  bool is_due() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(20)) return false;
    last_ = now;
    return true;
  }

  py::object progress_;
  std::exception_ptr raised_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// A rank that cannot go on says so to the others.
Summary run_shared(const Scene& scene, const RunOptions& options, Asking& asking) {
  try {
    return run_scene(scene, options, std::ref(asking));
  } catch (const RankFailed&) {
    throw;
  } catch (const std::exception& e) {
    if (options.ranks != nullptr) options.ranks->fail(e.what());
    throw;
  }
}

Summary run(const Scene& scene, const RunOptions& options, const py::object& progress, const py::object& ranks) {
  const Scene own_scene = scene;
  RunOptions own_options = options;
  std::optional<PythonRanks> shared;
  if (!ranks.is_none()) own_options.ranks = &shared.emplace(ranks);
  Asking asking(progress);
  Summary summary;
  {
    const py::gil_scoped_release release;
    summary = run_shared(own_scene, own_options, asking);
  }
  asking.rethrow();
  return summary;
}

void bind_summary(py::module_& m) {
  Record<StatisticsSummary>(m, "StatisticsSummary")
      .field("options", &StatisticsSummary::options)
      .field("time", &StatisticsSummary::time)
      .field("hit_faces", &StatisticsSummary::hit_faces)
      .field("hits_by_patch", &StatisticsSummary::hits_by_patch)
      .field("ended_by_patch", &StatisticsSummary::ended_by_patch)
      .field("planes", &StatisticsSummary::planes)
      .field("left", &StatisticsSummary::left)
      .field("absorbed_by_edits", &StatisticsSummary::absorbed_by_edits)
      .field("seconds", &StatisticsSummary::seconds)
      .finish();
  Record<Summary>(m, "Summary")
      .field("scene", &Summary::scene)
      .field("threads", &Summary::threads)
      .field("ranks", &Summary::ranks)
      .field("steps", &Summary::steps)
      .field("cancelled", &Summary::cancelled)
      .field("deforms", &Summary::deforms)
      .field("cells", &Summary::cells)
      .field("free_cells", &Summary::free_cells)
      .field("vertices", &Summary::vertices)
      .field("wall_faces", &Summary::wall_faces)
      .field("bytes", &Summary::bytes)
      .field("skipped", &Summary::skipped)
      .field("warnings", &Summary::warnings)
      .field("totals", &Summary::totals)
      .field("alive", &Summary::alive)
      .field("held", &Summary::held)
      .field("lost", &Summary::lost)
      .field("patch_names", &Summary::patch_names)
      .field("seconds_load", &Summary::seconds_load)
      .field("seconds_locate", &Summary::seconds_locate)
      .field("seconds_solids", &Summary::seconds_solids)
      .field("seconds_write", &Summary::seconds_write)
      .field("seconds_writing_thread", &Summary::seconds_writing_thread)
      .field("seconds_report", &Summary::seconds_report)
      .field("report", &Summary::report)
      .field("surgery", &Summary::surgery)
      .field("bodies", &Summary::bodies)
      .field("catheters", &Summary::catheters)
      .field("solids", &Summary::solids)
      .field("statistics", &Summary::statistics)
      .field("audit", &Summary::audit)
      .field("state_hash", &Summary::state_hash)
      .finish();
  m.def("summary_json", &summary_json, py::arg("summary"), doc("summary_json"));
  m.def("summary_text", &summary_text, py::arg("summary"), doc("summary_text"));
  m.def("histogram_text", &histogram_text, py::arg("summary"), doc("histogram_text"));
  m.def(
      "write_lagrangian",
      [](const std::filesystem::path& run_folder, const std::filesystem::path& openfoam_case,
         const std::string& cloud) {
        const py::gil_scoped_release release;
        return write_lagrangian(run_folder, openfoam_case, cloud);
      },
      py::arg("run_folder"), py::arg("openfoam_case"), py::arg("cloud") = "particles", doc("write_lagrangian"));
  m.def("version", &version, doc("version"));
}

}  // namespace

void bind(py::module_& m) {
  bind_summary(m);
  Record<RunOptions>(m, "RunOptions")
      .field("folder", &RunOptions::folder)
      .field("threads", &RunOptions::threads)
      .field("steps", &RunOptions::steps)
      .field("seed", &RunOptions::seed)
      .field("audit", &RunOptions::audit)
      .field("skip_bad_cells", &RunOptions::skip_bad_cells)
      .field("resume", &RunOptions::resume)
      .field("max_memory", &RunOptions::max_memory)
      .field("partition", &RunOptions::partition)
      .finish();
  const std::string text =
      std::string(doc("run_scene")) +
      "\n\nprogress: a function of the number of steps done and of all. It returns False to "
      "cancel the run; None goes on. Ctrl-C, and an exception of progress, end the run between "
      "two steps: the output folder is complete up to there, and resume goes on from there.\n\nranks: the "
      "processes that share the run (Ranks); None: this one alone. Where one raises an error, the "
      "others raise RankFailed; where progress raises or cancels on one, the run ends on all.";
  m.def("run_scene", &run, py::arg("scene"), py::arg("options") = RunOptions{}, py::arg("progress") = py::none(),
        py::arg("ranks") = py::none(), text.c_str());
}

}  // namespace dartcast::python::run
