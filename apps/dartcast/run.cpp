// The verb run: runs a scene, shows its progress, and prints the summary.
#include "dartcast/run.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "dartcast/scene_file.hpp"
#include "interruption.hpp"
#include "limits.hpp"
#include "max_memory.hpp"
#include "processes.hpp"
#include "terminal.hpp"

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
  std::string partition = "particles";
  bool quiet = false;
  bool verbose = false;
  bool json = false;
  std::uint64_t max_memory = 0;
};

// A text as one word of a shell.
std::string quoted(const std::string& text) {
  const bool is_plain = !text.empty() && text.find_first_not_of(
                                             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                             "0123456789_./-+=:,@%") == std::string::npos;
  if (is_plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

// The command that goes on where a run was interrupted, as a shell takes it.
std::string resume_command(const RunArguments& a, const std::string& folder) {
  std::string line = fmt::format("dartcast run {} -o {} --resume", quoted(a.scene), quoted(folder));
  if (a.threads > 0) line += fmt::format(" -j {}", a.threads);
  if (a.steps) line += fmt::format(" --steps {}", *a.steps);
  if (a.seed) line += fmt::format(" --seed {}", *a.seed);
  if (a.audit) line += " --audit";
  if (a.skip_bad_cells) line += " --skip-bad-cells";
  return line;
}

void report(const RunArguments& a, const Summary& summary, const std::string& folder) {
  if (a.json) {
    fmt::print("{}\n", summary_json(summary));
    return;
  }
  if (a.quiet) return;
  std::string text = summary_text(summary) + fmt::format("{:<13}{}\n", "output", folder);
  if (summary.report) {
    for (const std::string& note : summary.report->notes) text += fmt::format("{:<13}{}\n", "", note);
    text += fmt::format("{:<13}{}\n", "report", summary.report->file.string());
  }
  if (has_colours(stdout)) text = with_bold_subjects(text);
  fmt::print("{}", a.verbose ? text + histogram_text(summary) : text);
}

// A number of bytes in the largest unit of which there is one.
std::string bytes_in_words(std::uint64_t bytes) {
  static constexpr std::array<const char*, 5> units = {"bytes", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < units.size(); ++unit) value /= 1000.0;
  return fmt::format("{:.{}f} {}", value, unit > 0 && value < 9.95 ? 1 : 0, units[unit]);
}

void announce(const RunArguments& a, const ExpectedOutput& expected, const std::string& folder) {
  if (a.quiet || a.json) return;
  fmt::print("{:<13}about {} in {}: ", "output", bytes_in_words(expected.bytes), folder);
  if (expected.every == 0)
    fmt::print("no frames\n");
  else
    fmt::print("{} frames, one every {} steps\n", expected.frames, expected.every);
  std::fflush(stdout);
}

int status_of(const RunArguments& a, const Summary& summary, const std::string& folder) {
  if (summary.audit && summary.audit->failed > 0) {
    fmt::print(stderr, "dartcast: the audit failed {} times; the first: {}\n", summary.audit->failed,
               summary.audit->first);
    if (!summary.replay.empty())
      fmt::print(stderr, "dartcast: the step is in {0}: dartcast replay {0}\n", quoted(summary.replay.string()));
    return failed;
  }
  if (!summary.cancelled) return done;
  fmt::print(stderr, "dartcast: interrupted after step {}; to go on: {}\n", summary.steps, resume_command(a, folder));
  return interrupted + Interruption::signal();
}

std::string loading_text(const MeshSource& mesh) {
  if (const auto* file = std::get_if<std::filesystem::path>(&mesh)) return "loading " + file->filename().string();
  const auto* made = std::get_if<SurfaceScene>(&mesh);
  return made == nullptr ? "making the mesh" : "meshing " + made->surfaces.front().file.filename().string();
}

// Where ranks share the run, the first speaks for all.
int run(const RunArguments& a, Ranks* ranks) {
  const Scene scene = read_scene(a.scene);
  RunOptions options;
  options.folder = a.folder.empty() ? scene.name + "-out" : a.folder;
  options.threads = a.threads > 0 ? Threads{a.threads} : threads_of_rank(ranks);
  options.ranks = ranks;
  options.partition = a.partition == "cells" ? Partition::cells : Partition::particles;
  options.steps = a.steps;
  options.seed = a.seed;
  options.audit = a.audit;
  options.resume = a.resume;
  options.skip_bad_cells = a.skip_bad_cells;
  options.max_memory = a.max_memory;
  const bool speaks = ranks == nullptr || ranks->rank() == 0;
  const bool shows_progress = speaks && !a.quiet && !a.json && is_terminal(stderr);
  WaitingLine waiting(loading_text(scene.environment.mesh), shows_progress);
  options.on_stage = [&](std::string_view stage) { waiting.enter(stage); };
  ProgressLine line;
  const Interruption interruption;
  const Summary summary = run_scene(
      scene, options,
      [&](std::uint64_t step, std::uint64_t all) {
        waiting.end();
        if (shows_progress) line.show(step, all);
        if (step == all) Interruption::last_step();
        return !Interruption::asked_after_step();
      },
      [&](const ExpectedOutput& expected) {
        waiting.end();
        announce(a, expected, options.folder.string());
      });
  waiting.end();
  line.clear();
  if (!speaks) return done;
  report(a, summary, options.folder.string());
  return status_of(a, summary, options.folder.string());
}

}  // namespace

void add_run(CLI::App& app, int& status) {
  const auto a = std::make_shared<RunArguments>();
  const std::vector<std::string> partitions = {"particles", "cells"};
  CLI::App* verb = app.add_subcommand("run", "Run a scene; writes a folder that ParaView opens.");
  verb->add_option("SCENE", a->scene, "a scene in TOML")->required()->type_name("FILE");
  verb->add_option("-o,--output", a->folder, "folder for the output (the scene's name with -out)")->type_name("FOLDER");
  verb->add_option("-j,--threads", a->threads, fmt::format("threads, 1 to {} (all the machine has)", max_threads()))
      ->type_name("N")
      ->transform(whole_number(1, max_threads()));
  verb->add_option("--steps", a->steps, "number of steps, instead of the scene's")
      ->type_name("N")
      ->transform(whole_number(0, max_steps));
  verb->add_option("--seed", a->seed, "seed for all that is random, instead of the scene's")
      ->type_name("N")
      ->transform(whole_number(0, max_seed));
  verb->add_flag("--audit", a->audit, "check each particle after each step in exact arithmetic (slow)");
  verb->add_flag("--resume", a->resume, "go on where an earlier run in the folder was cut off, or to more --steps");
  verb->add_flag("--skip-bad-cells", a->skip_bad_cells,
                 "block flat, inverted and indivisible cells: they are left out, and their faces are walls");
  verb->add_option("--partition", a->partition,
                   "under mpirun: each process has some of the particles, or some of the cells (particles)")
      ->type_name(alternatives(partitions))
      ->check(one_of(partitions));
  add_max_memory(*verb, a->max_memory);
  auto* quiet = verb->add_flag("-q,--quiet", a->quiet, "print nothing but errors");
  verb->add_flag("-v,--verbose", a->verbose, "print more")->excludes(quiet);
  verb->add_flag("--json", a->json, "print the summary as one JSON object, and nothing else");
  verb->callback([a, &status] { status = on_ranks([&](Ranks* ranks) { return run(*a, ranks); }); });
}

}  // namespace dartcast::app
