// Steps a surgical simulation, and takes the time of each step.
#include "bench/latency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <span>
#include <utility>

#include "base/random.hpp"
#include "bench/embedded_scenes.hpp"
#include "dartcast/events.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast::bench {

namespace {

// Other programs that take a part of the processor do not count.
double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

Vec3 unit(const Vec3& v) { return (1.0 / norm(v)) * v; }

// Cuts at random places of the tissue.
class Surgeon {
 public:
  explicit Surgeon(Simulation& simulation) : simulation_(simulation) {
    const CombinatorialMap& map = simulation.environment().map();
    for (const Cell c : map.cells()) {
      if (!map.is_free(c)) tissue_.push_back(c);
    }
  }

  // Before the next step: a blade of 2 mm is drawn over 2 mm, through a random cell of the tissue that no cut has
  // replaced.
  void cut() {
    const Vec3 middle = centre(random_cell());
    const Vec3 way = random_direction();
    const Vec3 blade = unit(cross(way, random_direction()));
    const auto place = [&](double along) {
      const Vec3 at = middle + way * (along * 1e-3);
      return std::array<Vec3, 2>{at - blade * 1e-3, at + blade * 1e-3};
    };
    Event event;
    event.at = simulation_.time();
    event.what = Cut{BladePath{{place(-1.0), place(1.0)}}, 2e-4};
    simulation_.set_events({event});
  }

 private:
  Cell random_cell() {
    while (true) {
      const Cell c = tissue_[random_.below(static_cast<std::uint32_t>(tissue_.size()))];
      if (simulation_.environment().map().contains(c)) return c;
    }
  }

  Vec3 random_direction() {
    const auto part = [this] { return random_.uniform(-1.0, 1.0); };
    return unit({part(), part(), part()});
  }

  // At the cell's place now.
  [[nodiscard]] Vec3 centre(Cell c) const {
    const Environment& environment = simulation_.environment();
    const std::span<const std::uint32_t> corners = environment.map().view(c).vertices();
    Vec3 sum;
    for (const std::uint32_t v : corners) sum += environment.positions()[v];
    return (1.0 / static_cast<double>(corners.size())) * sum;
  }

  Simulation& simulation_;
  std::vector<Cell> tissue_;
  Random random_{7};
};

}  // namespace

Latency measure_latency(const LatencyOptions& options) {
  Simulation simulation(load_scene_files(parse_scene(latency_scene, "latency.toml")).scene, Threads{1});
  Surgeon surgeon(simulation);
  Latency latency;
  latency.cells = simulation.environment().map().cell_count();
  latency.steps.reserve(options.steps);
  double particles = 0.0;
  for (std::size_t i = 1; i <= options.steps; ++i) {
    const bool cut = i % options.cut_every == 0;
    if (cut) surgeon.cut();
    const double start = thread_ms();
    simulation.step();
    latency.steps.push_back({thread_ms() - start, cut});
    particles += static_cast<double>(simulation.particles().size());
  }
  latency.particles = static_cast<std::size_t>(std::lround(particles / static_cast<double>(options.steps)));
  const std::vector<EventReport>& cuts = simulation.event_log().events;
  for (const EventReport& cut : cuts) latency.cells_replaced += cut.cells_removed;
  latency.cells_replaced /= std::max<std::size_t>(1, cuts.size());
  return latency;
}

double Latency::quantile(bool cut, double share) const {
  std::vector<double> times;
  for (const StepTime& step : steps) {
    if (step.cut == cut) times.push_back(step.ms);
  }
  if (times.empty()) return 0.0;
  std::sort(times.begin(), times.end());
  const double place = std::ceil(share * static_cast<double>(times.size())) - 1.0;
  return times[static_cast<std::size_t>(std::max(0.0, place))];
}

std::size_t Latency::count(bool cut) const {
  return static_cast<std::size_t>(
      std::count_if(steps.begin(), steps.end(), [cut](const StepTime& step) { return step.cut == cut; }));
}

std::size_t Latency::longest_step(bool cut) const {
  std::size_t longest = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i].cut == cut && (longest == 0 || steps[i].ms > steps[longest - 1].ms)) longest = i + 1;
  }
  return longest;
}

std::size_t Latency::over_bound(bool cut) const {
  const double most = cut ? cut_bound : bound;
  return static_cast<std::size_t>(std::count_if(
      steps.begin(), steps.end(), [&](const StepTime& step) { return step.cut == cut && step.ms > most; }));
}

}  // namespace dartcast::bench
