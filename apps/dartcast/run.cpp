// The verb run: runs a scene, shows its progress, and prints the summary.
#include "dartcast/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "commands.hpp"
#include "dartcast/scene_file.hpp"
#include "limits.hpp"
#include "max_memory.hpp"

namespace dartcast::app {

namespace {

struct RunArguments {
  std::string scene;
  std::string folder;
  unsigned threads = 0;
  std::optional<std::uint64_t> steps;
  std::optional<std::uint64_t> seed;
  bool audit = false;
  bool resume = false;
  bool skip_bad_cells = false;
  bool quiet = false;
  bool verbose = false;
  bool json = false;
  std::uint64_t max_memory = 0;
};

// A line on the terminal that is written over, a few times a second.
class ProgressBar {
 public:
  void show(std::uint64_t step, std::uint64_t all) {
    const auto now = std::chrono::steady_clock::now();
    if (step < all && now - shown_ < std::chrono::milliseconds(200)) return;
    shown_ = now;
    constexpr std::uint64_t width = 40;
    const std::uint64_t filled = step * width / all;
    fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {} of {} steps", "", filled, "", width - filled, step, all);
    if (step == all) fmt::print(stderr, "\n");
    std::fflush(stderr);
  }

 private:
  std::chrono::steady_clock::time_point shown_{};
};

void report(const RunArguments& a, const Summary& summary, const std::string& folder) {
  if (a.json) {
    fmt::print("{}\n", summary_json(summary));
    return;
  }
  if (a.quiet) return;
  fmt::print("{}", a.verbose ? summary_text(summary) + histogram_text(summary) : summary_text(summary));
  fmt::print("output: {}\n", folder);
}

int run(const RunArguments& a) {
  const Scene scene = read_scene(a.scene);
  RunOptions options;
  options.folder = a.folder.empty() ? scene.name + "-out" : a.folder;
  options.threads = Threads{a.threads};
  options.steps = a.steps;
  options.seed = a.seed;
  options.audit = a.audit;
  options.resume = a.resume;
  options.skip_bad_cells = a.skip_bad_cells;
  options.max_memory = a.max_memory;
  ProgressBar bar;
  Progress progress;
  if (!a.quiet && !a.json && isatty(STDERR_FILENO) != 0)
    progress = [&](std::uint64_t step, std::uint64_t all) {
      bar.show(step, all);
      return true;
    };
  const Summary summary = run_scene(scene, options, progress);
  report(a, summary, options.folder.string());
  if (summary.audit && summary.audit->failed > 0) {
    fmt::print(stderr, "dartcast: the audit failed {} times; the first: {}\n", summary.audit->failed,
               summary.audit->first);
    return failed;
  }
  return done;
}

}  // namespace

void add_run(CLI::App& app, int& status) {
  const auto a = std::make_shared<RunArguments>();
  CLI::App* verb = app.add_subcommand("run", "Run a scene; writes a folder that ParaView opens.");
  verb->add_option("SCENE", a->scene, "a scene in TOML")->required();
  verb->add_option("-o,--output", a->folder, "folder for the output (the scene's name with -out)");
  verb->add_option("-j,--threads", a->threads, "threads (all the machine has)")
      ->transform(whole_number(1, max_threads()));
  verb->add_option("--steps", a->steps, "number of steps, instead of the scene's")
      ->transform(whole_number(0, max_steps));
  verb->add_option("--seed", a->seed, "seed for all that is random, instead of the scene's")
      ->transform(whole_number(0, max_seed));
  verb->add_flag("--audit", a->audit, "check each particle after each step in exact arithmetic (slow)");
  verb->add_flag("--resume", a->resume, "go on where an earlier run in the folder was cut off, or to more --steps");
  verb->add_flag("--skip-bad-cells", a->skip_bad_cells,
                 "block flat, inverted and indivisible cells: they are left out, and their faces are walls");
  add_max_memory(*verb, a->max_memory);
  auto* quiet = verb->add_flag("-q,--quiet", a->quiet, "print nothing but errors");
  verb->add_flag("-v,--verbose", a->verbose, "print more")->excludes(quiet);
  verb->add_flag("--json", a->json, "print the summary as one JSON object, and nothing else");
  verb->callback([a, &status] { status = run(*a); });
}

}  // namespace dartcast::app
