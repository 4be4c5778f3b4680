// The program dartcast-soak: draws cases until one fails, makes that one simpler, and writes it to a file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "soak/apart.hpp"
#include "soak/run.hpp"

namespace {

using namespace dartcast::soak;

struct Arguments {
  double minutes = 1.0;
  SoakOptions options;
  std::vector<std::string> only;
  std::vector<std::string> replay;
  std::string table;
  bool keep = false;
};

void change(Case& c, const std::vector<std::string>& only) {
  for (const std::string& assignment : only) set(c, assignment);
}

void say(double seconds, const Counts& n) {
  fmt::print("{:7.1f} min: {} cases, {} steps, {} particle-steps, {} compared with all walls\n", seconds / 60.0,
             n.cases, n.steps, n.particle_steps, n.true_steps);
  std::fflush(stdout);
}

int replay(const Arguments& a) {
  bool good = true;
  for (const std::string& file : a.replay) {
    std::ifstream in(file);
    if (!in) throw dartcast::Error(fmt::format("{}: cannot be read", file));
    Case c = case_of(std::string(std::istreambuf_iterator<char>(in), {}));
    change(c, a.only);
    const std::string wrong = run_apart(c, a.options.limit);
    fmt::print("{}: {}\n", file, wrong.empty() ? "nothing is wrong" : wrong);
    good = good && wrong.empty();
  }
  return good ? 0 : 1;
}

void report(const Failure& failure, const Arguments& a) {
  fmt::print("\nseed {}: {}\n{}\n", failure.c.seed, failure.wrong, text_of(failure.c));
  std::fflush(stdout);
  if (a.keep) return;
  std::string last = failure.wrong;
  const Case simple = shrunk(failure.c, [&](const Case& candidate) {
    std::string wrong = run_apart(candidate, std::min(a.options.limit, 20.0));
    if (!wrong.empty()) last = wrong;
    return wrong;
  });
  const std::string name = fmt::format("soak-{}", failure.c.seed);
  std::ofstream(name + ".case") << "# " << last << "\n" << text_of(simple);
  fmt::print("simpler: {}\n{}written to {}.case: dartcast-soak --replay {}.case\n", last, text_of(simple), name, name);
  run_apart(simple, a.options.limit, name + ".json");
  if (std::filesystem::exists(name + ".json")) fmt::print("the step alone: dartcast replay {}.json\n", name);
}

int run(Arguments& a) {
  if (!a.replay.empty()) return replay(a);
  a.options.seconds = a.minutes * 60.0;
  a.options.change = [&](Case& c) { change(c, a.only); };
  a.options.say = [&](double seconds, const Counts& counts) {
    say(seconds, counts);
    if (!a.table.empty()) std::ofstream(a.table) << table_of(counts);
  };
  const SoakResult result = soak(a.options);
  a.options.say(result.seconds, result.counts);
  for (const Failure& failure : result.failures) report(failure, a);
  return result.failures.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  CLI::App app("Takes random steps in random scenes by every feature, and checks each in exact numbers.");
  app.add_option("minutes", a.minutes, "How long")->check(CLI::PositiveNumber);
  app.add_option("--cases", a.options.cases, "At most how many");
  app.add_option("--seed", a.options.seed, "Of the first case");
  app.add_option("--jobs", a.options.jobs, "Processes")->check(CLI::Range(1, 1000));
  app.add_option("--limit", a.options.limit, "Seconds for a case")->check(CLI::PositiveNumber);
  app.add_option("--only", a.only, "A choice for all cases, such as mesh=octahedra or edit=none");
  app.add_option("--replay", a.replay, "Run these cases alone")->check(CLI::ExistingFile);
  app.add_option("--table", a.table, "Write the table of features and pairs to this file");
  app.add_flag("--as-found", a.keep, "Do not make a case that fails simpler");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(a);
  } catch (const std::exception& e) {
    fmt::print(stderr, "dartcast-soak: {}\n", e.what());
    return 2;
  }
}
