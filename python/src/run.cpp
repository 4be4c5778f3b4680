// Binds dartcast/run.hpp: runs of scenes. Ctrl-C, and exceptions of the progress callback, end a run between two steps.
#include "dartcast/run.hpp"

#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bind.hpp"
#include "ranks.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::run {
namespace {

// Asks Python after each step whether to go on. An exception cancels the run, whose output is then complete.
class Asking {
 public:
  Asking(py::object progress, py::object on_stage) : progress_(std::move(progress)), on_stage_(std::move(on_stage)) {
    if (!progress_.is_none() && PyCallable_Check(progress_.ptr()) == 0)
      throw py::type_error("progress: expected a function of the number of steps done and of all");
    if (!on_stage_.is_none() && PyCallable_Check(on_stage_.ptr()) == 0)
      throw py::type_error("on_stage: expected a function of a text");
  }

  bool operator()(std::uint64_t done, std::uint64_t all) {
    if (raised_) return false;
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
  /// A stage before the first step; an exception ends the run there.
  void enter(std::string_view stage) {
    const py::gil_scoped_acquire acquire;
    try {
      if (!raised_) on_stage_(std::string(stage));
    } catch (...) {
      raised_ = std::current_exception();
    }
  }
  [[nodiscard]] bool wants_stages() const { return !on_stage_.is_none(); }
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

  py::object progress_, on_stage_;
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

Summary run(const Scene& scene, const RunOptions& options,
            const Typed<"Callable[[int, int], bool | None] | None">& progress, const Typed<"Ranks | None">& ranks,
            const Typed<"Callable[[str], None] | None">& on_stage) {
  const Scene own_scene = scene;
  RunOptions own_options = options;
  std::optional<PythonRanks> shared;
  if (!ranks.is_none()) own_options.ranks = &shared.emplace(ranks);
  Asking asking(progress, on_stage);
  if (asking.wants_stages()) own_options.on_stage = [&](std::string_view stage) { asking.enter(stage); };
  Summary summary;
  {
    const py::gil_scoped_release release;
    summary = run_shared(own_scene, own_options, asking);
  }
  asking.rethrow();
  return summary;
}

}  // namespace

void bind(py::module_& m) {
  m.def(
      "run_scene", &run, py::arg("scene"), py::arg("options") = RunOptions{}, py::arg("progress") = py::none(),
      py::arg("ranks") = py::none(), py::arg("on_stage") = py::none(),
      about("run_scene",
            "progress: a function of the number of steps done and of all. It returns False to cancel the run; None "
            "goes on. Ctrl-C, and an exception of progress, end the run between two steps: the output folder is "
            "complete up to there, and resume goes on from there.\n\nranks: the processes that share the run "
            "(Ranks); None: this one alone. Where one raises an error, the others raise RankFailed; where progress "
            "raises or cancels on one, the run ends on all.\n\non_stage: a function that gets what is done before the "
            "first step, as it starts: such as \"tetgen fills the surface\"."));
}

}  // namespace dartcast::python::run
