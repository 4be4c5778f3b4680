// Plans a run on many ranks.
//
// Phases: Divide the mesh, and count the parts that meet at every point. Build sample parts, and measure a step in
// them. Both give the work of the largest rank; a model of the network gives the time of its messages.
#include "dartcast/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "base/elementary.hpp"
#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_part.hpp"
#include "parts/bisected.hpp"
#include "parts/part_cutter.hpp"
#include "parts/part_of_rank.hpp"
#include "simulation/collectives.hpp"

namespace dartcast {

namespace {

// Counts of all parts.
struct PartCounts {
  std::vector<double> cells;
  std::vector<double> free_cells;
  std::vector<double> ghosts;
  std::vector<double> neighbours;
};

PartCounts counts_of(const MeshData& mesh, const std::vector<std::uint32_t>& owners, std::uint32_t parts) {
  std::vector<std::vector<std::uint32_t>> around(mesh.points.size());
  const auto add = [](std::vector<std::uint32_t>& list, std::uint32_t part) {
    if (std::find(list.begin(), list.end(), part) == list.end()) list.push_back(part);
  };
  for (std::size_t c = 0; c < owners.size(); ++c)
    for_each_point(mesh, c, [&](std::uint32_t p) { add(around[p], owners[c]); });
  PartCounts counts;
  for (auto* list : {&counts.cells, &counts.free_cells, &counts.ghosts, &counts.neighbours}) list->resize(parts);
  std::vector<std::uint32_t> near;
  for (std::size_t c = 0; c < owners.size(); ++c) {
    ++counts.cells[owners[c]];
    if (mesh.free.empty() || mesh.free[c] != 0) ++counts.free_cells[owners[c]];
    near.clear();
    for_each_point(mesh, c, [&](std::uint32_t p) {
      for (const std::uint32_t part : around[p]) add(near, part);
    });
    for (const std::uint32_t part : near) counts.ghosts[part] += part != owners[c] ? 1.0 : 0.0;
  }
  std::vector<std::vector<std::uint32_t>> beside(parts);
  for (const std::vector<std::uint32_t>& list : around) {
    for (const std::uint32_t a : list) {
      for (const std::uint32_t b : list) add(beside[a], b);
    }
  }
  for (std::uint32_t p = 0; p < parts; ++p) counts.neighbours[p] = static_cast<double>(beside[p].size()) - 1.0;
  return counts;
}

RankSpread spread_of(const std::vector<double>& values, double factor = 1.0) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {factor * sum / static_cast<double>(values.size()), factor * *std::max_element(values.begin(), values.end())};
}

// Measured in sample parts.
struct Sampled {
  double bytes = 0.0;             // of the environment, a cell of the part
  double seconds_particle = 0.0;  // of its step
  double seconds_cell = 0.0;      // of moving the vertices, a cell of the part
  double left = 0.0;              // particles that leave in a step, for one a cell and a ghost
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A part with particles in its own cells, which go in random directions.
class SamplePart {
 public:
  SamplePart(const MeshPart& part, const PlanOptions& options)
      : part_(part), options_(options), environment_(part.mesh, Threads{1}), cells_(part_cells(part)) {
    fill();
  }

  [[nodiscard]] Sampled measure() {
    constexpr int steps = 6;
    double walks = 0.0;
    double moves = 0.0;
    std::uint64_t walked = 0;
    for (int s = 0; s < steps; ++s) {
      moves += s > 0 && options_.deforms ? move() : 0.0;
      const auto start = std::chrono::steady_clock::now();
      aim();
      environment_.advance(particles_, targets_);
      if (s == 0) count_left();  // the first steps fill caches
      if (s == 0) continue;
      walks += seconds_since(start);
      walked += particles_.size();
    }
    Sampled result;
    const auto cells = static_cast<double>(part_.cells.size());
    result.bytes = static_cast<double>(environment_.complex().bytes()) / cells;
    result.seconds_particle = walked > 0 ? walks / static_cast<double>(walked) : 0.0;
    result.seconds_cell = moves / (steps - 1) / cells;
    const double own = static_cast<double>(std::count(part_.owners.begin(), part_.owners.end(), part_.part));
    const double ghosts = cells - own;
    if (ghosts > 0.0) result.left = left_ / (ghosts * static_cast<double>(particles_.size()) / own);
    return result;
  }

 private:
  // Between a free own cell's middle and one of its points: there the cell is, whatever its shape.
  void fill() {
    const std::vector<Vec3> middles = middles_of(part_.mesh);
    std::vector<std::uint32_t> own;
    for (std::uint32_t c = 0; c < part_.owners.size(); ++c) {
      if (part_.owners[c] == part_.part && (part_.mesh.free.empty() || part_.mesh.free[c] != 0)) own.push_back(c);
    }
    if (own.empty()) return;
    constexpr std::size_t most = 100'000;
    const auto count = std::min(most, static_cast<std::size_t>(options_.particles));
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t c = own[random_.below(static_cast<std::uint32_t>(own.size()))];
      std::vector<std::uint32_t> corners;
      for_each_point(part_.mesh, c, [&](std::uint32_t p) { corners.push_back(p); });
      const Vec3& corner = part_.mesh.points[corners[random_.below(static_cast<std::uint32_t>(corners.size()))]];
      const double share = cube_root(random_.uniform());
      points.push_back(middles[c] + 0.999 * share * (corner - middles[c]));
      edges_ += 2.0 * norm(corner - middles[c]) / std::sqrt(3.0) / static_cast<double>(count);
    }
    environment_.add(particles_, points);
  }

  void aim() {
    targets_.resize(particles_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Vec3 d = {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0)};
      const double length = norm(d);
      targets_[i] = particles_[i].position + (length > 0.0 ? options_.step * edges_ / length : 0.0) * d;
    }
  }

  double move() {
    const auto start = std::chrono::steady_clock::now();
    const std::span<Vec3> next = environment_.next_positions();
    const double shear = ++moves_ % 2 == 0 ? 0.0 : 1e-3;
    for (std::size_t p = 0; p < next.size(); ++p) {
      const Vec3& x = part_.mesh.points[p];
      next[p] = {x.x + shear * x.y, x.y, x.z};
    }
    environment_.move();
    return seconds_since(start);
  }

  void count_left() {
    for (const ParticleState& p : particles_.states()) left_ += cells_.is_own(p.cell) ? 0.0 : 1.0;
  }

  const MeshPart& part_;
  const PlanOptions& options_;
  Environment environment_;
  PartCells cells_;
  Particles particles_;
  std::vector<Vec3> targets_;
  Random random_{1};
  double edges_ = 0.0;  // their mean length, as of a cube with such a diagonal
  int moves_ = 0;
  double left_ = 0.0;
};

Sampled sampled(const MeshData& mesh, const std::vector<std::uint32_t>& owners, const PartCounts& counts,
                const PlanOptions& options) {
  PartCutter cutter(mesh, owners, options.ranks);
  const auto largest =
      static_cast<std::uint32_t>(std::max_element(counts.ghosts.begin(), counts.ghosts.end()) - counts.ghosts.begin());
  const std::uint32_t count = std::min(options.samples, options.ranks);
  Sampled sum;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto at = static_cast<std::uint32_t>((largest + std::uint64_t{k} * options.ranks / count) % options.ranks);
    const MeshPart part = cutter.cut(cutter.cells_of(at), at);
    const Sampled one = SamplePart(part, options).measure();
    sum.bytes += one.bytes / count;
    sum.seconds_particle += one.seconds_particle / count;
    sum.seconds_cell += one.seconds_cell / count;
    sum.left += one.left / count;
  }
  return sum;
}

void check(const MeshData& mesh, const PlanOptions& o) {
  const auto refuse_unless = [](bool fits, const char* what, double value) {
    if (!fits) throw InvalidArgument(fmt::format("plan: {} is {}", what, value));
  };
  if (mesh.dimension() != 3) throw InvalidArgument("plan: meshes of the plane cannot be spread by cells");
  refuse_unless(o.particles >= 0.0 && o.particles <= 1e12, "the number of particles of a rank", o.particles);
  refuse_unless(o.cells >= 0.0 && o.cells <= 1e12, "the number of cells of a rank", o.cells);
  refuse_unless(o.step >= 0.0 && o.step <= 1.0, "the length of a step in edges", o.step);
  refuse_unless(o.latency >= 0.0 && o.latency <= 1.0, "the latency in seconds", o.latency);
  refuse_unless(o.bandwidth > 0.0 && o.bandwidth <= 1e15, "the bandwidth in bytes a second", o.bandwidth);
  refuse_unless(o.samples > 0, "the number of samples", o.samples);
}

// The network as docs/benchmark.md has it: trees of messages, each with a latency and a time for its bytes.
class Network {
 public:
  explicit Network(const PlanOptions& o) : o_(o), depth_(std::bit_width(std::max(1U, o.ranks) - 1)) {}

  [[nodiscard]] double sum(double bytes) const { return depth_ * (o_.latency + bytes / o_.bandwidth); }
  // All ranks say how many bytes they send to each.
  [[nodiscard]] double announce() const { return sum(0.5 * sizeof(std::uint64_t) * o_.ranks); }
  [[nodiscard]] double to_neighbours(double neighbours, double bytes) const {
    return o_.ranks == 1 ? 0.0 : neighbours * o_.latency + bytes / o_.bandwidth;
  }
  // Before each collective call all ranks ask whether one has failed.
  [[nodiscard]] double ask() const { return sum(sizeof(int)); }

 private:
  const PlanOptions& o_;
  double depth_;
};

double seconds_of_collectives(const Network& net, double rounds) {
  const double sums = collectives::sums + rounds;
  const double bytes = collectives::summed_bytes + rounds * sizeof(std::uint64_t);
  return (sums + rounds) * net.ask() + (sums - 1.0) * net.sum(0.0) + net.sum(bytes) + rounds * net.announce();
}

}  // namespace

RunPlan plan_run(const MeshData& mesh, const PlanOptions& options) {
  check(mesh, options);
  const std::vector<std::uint32_t> owners = partition(mesh, options.ranks);
  const PartCounts counts = counts_of(mesh, owners, options.ranks);
  const Sampled measured = sampled(mesh, owners, counts, options);
  RunPlan plan;
  plan.options = options;
  const double mean = spread_of(counts.cells).mean;
  const double volume = options.cells > 0.0 ? options.cells / mean : 1.0;
  const double surface = volume / cube_root(volume);
  plan.cells = spread_of(counts.cells, volume);
  plan.ghosts = spread_of(counts.ghosts, surface);
  plan.neighbours = spread_of(counts.neighbours);
  const double free_mean = spread_of(counts.free_cells).mean;
  const double density = free_mean > 0.0 ? options.particles / (volume * free_mean) : 0.0;
  std::vector<double> bytes;
  std::vector<double> sent;
  double walk = 0.0;
  for (std::size_t p = 0; p < counts.cells.size(); ++p) {
    const double cells = volume * counts.cells[p] + surface * counts.ghosts[p];
    const double particles = density * volume * counts.free_cells[p];
    bytes.push_back(cells * measured.bytes + particles * collectives::particle_bytes);
    sent.push_back(measured.left * density * surface * counts.ghosts[p]);
    walk = std::max(walk, particles * measured.seconds_particle + cells * measured.seconds_cell);
  }
  const double along = options.ranks > 1 ? 1.0 : 0.0;
  plan.bytes = spread_of(bytes);
  plan.sent = spread_of(sent);
  plan.sent_bytes = collectives::sent_bytes;
  plan.rounds = along * collectives::rounds;
  plan.seconds_walk = walk;
  plan.seconds_pack = 2.0 * plan.sent.largest * collectives::seconds_of_packing;
  const Network net(options);
  plan.seconds_messages = plan.rounds * net.to_neighbours(plan.neighbours.largest, plan.sent.largest * plan.sent_bytes /
                                                                                       std::max(1.0, plan.rounds));
  plan.seconds_all = along * seconds_of_collectives(net, plan.rounds);
  plan.seconds_alone = options.particles * measured.seconds_particle + volume * mean * measured.seconds_cell;
  return plan;
}

}  // namespace dartcast
