#include "bench/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "dartcast/error.hpp"

namespace dartcast::bench {

namespace {

// Cells along each axis: 10^3, 10^4 ... 10^7 cells, about.
constexpr std::array<std::uint32_t, 5> sizes = {10, 22, 46, 100, 215};

WorkloadOptions workload(const char* name, Scene scene, std::uint32_t size, std::size_t steps) {
  WorkloadOptions options;
  options.name = name;
  options.scene = scene;
  options.size = size;
  options.steps = steps;
  return options;
}

WorkloadOptions deforming(WorkloadOptions options) {
  options.deforms = true;
  return options;
}

void add_static(std::vector<WorkloadOptions>& list) {
  for (const std::uint32_t size : sizes) list.push_back(workload("W1", Scene::box, size, 1000));
}

// Fewer steps where refitting takes long.
void add_deforming(std::vector<WorkloadOptions>& list) {
  constexpr std::array<std::size_t, sizes.size()> steps = {1000, 1000, 300, 60, 15};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    list.push_back(deforming(workload("W2", Scene::box, sizes[i], steps[i])));
  }
  list.push_back(deforming(workload("W2", Scene::box, 46, 50)));
  list.back().particles = 100000;
}

// Squares along each axis: 10^3 ... 10^6 faces, about.
void add_plane(std::vector<WorkloadOptions>& list) {
  for (const bool deforms : {false, true}) {
    for (const std::uint32_t size : {32U, 100U, 316U, 1000U}) {
      list.push_back(workload("W6", Scene::squares, size, 1000));
      list.back().deforms = deforms;
    }
  }
}

// First of all, since threads are capped for good once Embree has been used.
void add_many_particles(std::vector<WorkloadOptions>& list) {
  for (const bool cell_order : {false, true}) {
    WorkloadOptions options = workload("W3", Scene::box, 46, 20);
    options.particles = 1000000;
    options.cell_order = cell_order;
    options.threads = {1, 2};
    options.against_competitors = false;
    list.push_back(options);
  }
}

void add_ranges(std::vector<WorkloadOptions>& list) {
  for (const bool deforms : {false, true}) {
    for (const double share : {0.1, 0.01, 0.001}) {
      for (const double length : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
        list.push_back(workload("W5", Scene::box, 46, deforms ? 50 : 300));
        list.back().deforms = deforms;
        list.back().blocked_share = share;
        list.back().step_length = length;
      }
    }
  }
  for (const std::uint32_t faces : {6, 8, 14, 20, 32, 60}) list.push_back(workload("W5", Scene::tube, faces - 2, 500));
}

std::vector<WorkloadOptions> everything() {
  std::vector<WorkloadOptions> list;
  add_many_particles(list);
  add_static(list);
  add_deforming(list);
  list.push_back(workload("W4", Scene::lattice, 46, 1000));
  add_ranges(list);
  add_plane(list);
  list.push_back(workload("bar", Scene::bar, 0, 1000));
  list.push_back(deforming(workload("bar_deforming", Scene::bar, 0, 1000)));
  list.push_back(deforming(workload("vessel", Scene::vessel, 0, 1000)));
  return list;
}

std::vector<WorkloadOptions> quick() {
  std::vector<WorkloadOptions> list;
  for (const std::uint32_t size : {10U, 46U, 100U}) list.push_back(workload("W1", Scene::box, size, 1000));
  list.push_back(deforming(workload("W2", Scene::box, 46, 200)));
  return list;
}

}  // namespace

std::vector<WorkloadOptions> plan(const PlanOptions& options) {
  std::vector<WorkloadOptions> list = options.quick ? quick() : everything();
  std::vector<std::string> names;
  for (const WorkloadOptions& w : list) {
    if (names.empty() || names.back() != w.name) names.push_back(w.name);
  }
  for (const std::string& name : options.only) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InvalidArgument(fmt::format("there is no workload '{}' here, but {}", name, fmt::join(names, ", ")));
  }
  std::erase_if(list, [&](const WorkloadOptions& w) {
    return !options.only.empty() && std::find(options.only.begin(), options.only.end(), w.name) == options.only.end();
  });
  for (WorkloadOptions& w : list) w.steps = std::min(w.steps, options.steps.value_or(w.steps));
  return list;
}

}  // namespace dartcast::bench
