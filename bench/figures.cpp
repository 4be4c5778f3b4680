#include "bench/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

namespace dartcast::bench {

namespace {

double nanoseconds(const Row& row, const Series& series) { return series.ns_per_particle_step(row.workload.particles); }

using Which = std::function<bool(const WorkloadOptions&)>;

const Row* find(std::span<const Row> rows, unsigned threads, const Which& which) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.threads == threads && which(r.workload); });
  return found == rows.end() ? nullptr : &*found;
}

Which box(const char* name, std::uint32_t size, std::size_t particles = 1000) {
  return [=](const WorkloadOptions& w) { return w.name == name && w.size == size && w.particles == particles; };
}

// Adds how many times longer dartcast takes in `a` than in `b`, where both have been run.
void add_ratio(std::vector<Figure>& list, const Row* a, const Row* b, Figure figure) {
  if (a == nullptr || b == nullptr) return;
  figure.value = nanoseconds(*a, a->all_series[0]) / nanoseconds(*b, b->all_series[0]);
  list.push_back(std::move(figure));
}

void add_growth(std::vector<Figure>& list, std::span<const Row> rows) {
  const Row* small = find(rows, 1, box("W1", 10));
  const Row* large = find(rows, 1, box("W1", 100));
  if (small == nullptr || large == nullptr) return;
  for (std::size_t k = 0; k < small->all_series.size(); ++k) {
    const std::string& name = small->all_series[k].name;
    list.push_back({"growth_" + name, fmt::format("{}: from 10^3 to 10^6 cells its time grows by the factor", name),
                    nanoseconds(*large, large->all_series[k]) / nanoseconds(*small, small->all_series[k])});
  }
}

void add_plane_growth(std::vector<Figure>& list, std::span<const Row> rows) {
  for (const bool deforms : {false, true}) {
    const auto of_size = [&](std::uint32_t size) -> Which {
      return [=](const WorkloadOptions& w) { return w.name == "W6" && w.deforms == deforms && w.size == size; };
    };
    const Row* small = find(rows, 1, of_size(32));
    const Row* large = find(rows, 1, of_size(1000));
    if (small == nullptr || large == nullptr) continue;
    for (std::size_t k = 0; k < small->all_series.size(); ++k) {
      const std::string& name = small->all_series[k].name;
      list.push_back({fmt::format("growth_plane_{}_{}", deforms ? "moving" : "still", name),
                      fmt::format("{} in the plane, {}: from 10^3 to 10^6 faces its time grows by the factor", name,
                                  deforms ? "every vertex moving" : "standing still"),
                      nanoseconds(*large, large->all_series[k]) / nanoseconds(*small, small->all_series[k])});
    }
  }
}

// The shortest step measured from which on a hierarchy takes less time than dartcast.
void add_crossover(std::vector<Figure>& list, std::span<const Row> rows) {
  double crossover = std::numeric_limits<double>::infinity();
  std::size_t measured = 0;
  for (const Row& row : rows) {  // the steps grow from row to row
    const WorkloadOptions& w = row.workload;
    if (w.name != "W5" || w.scene != Scene::box || w.deforms || w.blocked_share != 0.1) continue;
    ++measured;
    const bool beaten = std::any_of(row.all_series.begin(), row.all_series.end(), [&](const Series& series) {
      return series.name != "dartcast" && series.name != "paper" && ratio_to_dartcast(row, series) < 1.0;
    });
    crossover = beaten ? std::min(crossover, row.workload.step_length) : std::numeric_limits<double>::infinity();
  }
  if (measured < 2 || crossover == std::numeric_limits<double>::infinity()) return;
  list.push_back({"hierarchy_wins_from_step_length",
                  "where 10^5 cells stand still, a hierarchy is the better choice from steps of so many cells on",
                  crossover});
}

}  // namespace

const Series* best_of_embree(const Row& row) {
  const Series* one = row.series("embree_single");
  const Series* many = row.series("embree_packet");
  if (one == nullptr || many == nullptr) return nullptr;
  return nanoseconds(row, *one) < nanoseconds(row, *many) ? one : many;
}

double ratio_to_dartcast(const Row& row, const Series& series) {
  return nanoseconds(row, series) / nanoseconds(row, row.all_series[0]);
}

std::vector<Figure> figures(std::span<const Row> rows) {
  std::vector<Figure> list;
  add_growth(list, rows);
  const Row* still = find(rows, 1, box("W1", 46));
  add_ratio(list, find(rows, 1, box("W2", 46)), still,
            {"deforming", "every vertex moving, 10^5 cells: times the time where none moves", 0.0});
  add_ratio(list, find(rows, 1, box("W4", 46)), still,
            {"degenerate", "on lattice lines, 10^5 cells: times the time at random places", 0.0});
  add_crossover(list, rows);
  add_plane_growth(list, rows);
  for (const bool order : {false, true}) {
    const auto many = [&](const WorkloadOptions& w) { return w.name == "W3" && w.cell_order == order; };
    add_ratio(list, find(rows, 1, many), find(rows, 2, many),
              {order ? "two_threads_cell_order" : "two_threads_random",
               fmt::format("10^6 particles {}: two threads are faster by the factor",
                           order ? "sorted by cell" : "in random order"),
               0.0});
  }
  return list;
}

}  // namespace dartcast::bench
