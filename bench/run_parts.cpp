// Runs a scene by commands in processes of their own, in turn, and reads the summaries that they print.
#include "bench/run_parts.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/embedded_scenes.hpp"
#include "dartcast/error.hpp"

namespace dartcast::bench {

namespace {

namespace fs = std::filesystem;

// An argument for the shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

double seconds_of(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

// Sums over the child processes that have ended.
double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

// Returns the text that a command line prints to stdout. Its errors go to stderr.
std::string output_of(const std::string& line) {
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) throw Error("bench: no process can be started");
  std::string out;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.append(buffer.data(), n);
  if (pclose(pipe) != 0) throw Error(fmt::format("bench: this command failed: {}", line));
  return out;
}

RunSample run_once(const fs::path& command, const fs::path& scene, const fs::path& output,
                   const RunPartsOptions& options) {
  std::string line =
      fmt::format("{} run {} -o {} --json", quoted(command.string()), quoted(scene.string()), quoted(output.string()));
  if (options.steps) line += fmt::format(" --steps {}", *options.steps);
  if (options.threads > 0) line += fmt::format(" -j {}", options.threads);
  const double processor = processor_seconds();
  const auto start = std::chrono::steady_clock::now();
  const std::string summary = output_of(line);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return read_sample(summary, wall, processor_seconds() - processor);
}

// This command leads in every other pair.
RunPairs run_pairs(const fs::path& scene, const fs::path& output, const RunPartsOptions& options) {
  RunPairs pairs;
  for (std::size_t i = 0; i < options.repeat; ++i) {
    const auto other = [&] {
      if (!options.against.empty())
        pairs.other.push_back(run_once(options.against, scene, output / "against", options));
    };
    if (i % 2 == 1) other();
    pairs.own.push_back(run_once(options.command, scene, output / "own", options));
    if (i % 2 == 0) other();
  }
  return pairs;
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(fmt::format("{}: the scene cannot be read", path.string()));
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_scene(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw Error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

double RunSample::seconds(const std::string& part) const {
  if (part == "wall") return wall;
  if (part == "processor") return processor;
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == part; });
  return found == parts.end() ? 0.0 : found->second;
}

RunSample read_sample(const std::string& summary, double wall, double processor) {
  try {
    const auto json = nlohmann::ordered_json::parse(summary);
    RunSample sample;
    sample.version = json.at("version");
    sample.scene = json.at("scene");
    sample.threads = json.at("threads");
    sample.steps = json.at("steps");
    sample.state_hash = json.at("state_hash");
    sample.wall = wall;
    sample.processor = processor;
    double other = wall;
    for (const auto& [name, seconds] : json.at("seconds").items()) {
      if (name == "writing_thread") continue;  // it works beside the run, and is no part of its time
      sample.parts.emplace_back(name, seconds.get<double>());
      other -= sample.parts.back().second;
    }
    sample.parts.emplace_back("other", std::max(0.0, other));
    return sample;
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("bench: a run printed no summary that can be read: {}", e.what()));
  }
}

std::vector<std::string> RunPairs::parts() const {
  std::vector<std::string> names;
  for (const std::vector<RunSample>* samples : {&own, &other}) {
    for (const RunSample& sample : *samples) {
      for (const auto& [name, seconds] : sample.parts) {
        if (name != "other" && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    }
  }
  names.emplace_back("other");
  return names;
}

namespace {

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace

double median_seconds(std::span<const RunSample> samples, const std::string& part) {
  std::vector<double> values;
  for (const RunSample& sample : samples) values.push_back(sample.seconds(part));
  return median_of(std::move(values));
}

std::optional<double> median_ratio(const RunPairs& pairs, const std::string& part) {
  std::vector<double> values;
  for (std::size_t i = 0; i < pairs.other.size(); ++i) {
    const double own = pairs.own[i].seconds(part);
    const double other = pairs.other[i].seconds(part);
    if (own == 0.0 || other == 0.0) return {};
    values.push_back(other / own);
  }
  if (values.empty()) return {};
  return median_of(std::move(values));
}

std::string with_output_table(const std::string& scene, const std::string& table) {
  std::istringstream lines(scene);
  std::string out;
  bool in_output = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) in_output = line.starts_with("[output]");
    if (!in_output) out += line + "\n";
  }
  return out + "[output]\n" + table + "\n";
}

std::vector<RunPairs> measure_runs(const RunPartsOptions& options) {
  fs::create_directories(options.folder);
  fs::path scene = options.scene;
  if (scene.empty()) write_scene(scene = options.folder / "vessel.toml", vessel_scene);
  const fs::path without = options.folder / (scene.stem().string() + "_without_output.toml");
  write_scene(without, with_output_table(content_of(scene), "every = 0"));
  std::vector<RunPairs> runs = {run_pairs(scene, options.folder / "run", options),
                                run_pairs(without, options.folder / "run_without_output", options)};
  runs[1].output = false;
  return runs;
}

}  // namespace dartcast::bench
