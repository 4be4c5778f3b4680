#include "bench/spheres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/random.hpp"
#include "bench/timing.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/simulation_view.hpp"

namespace dartcast::bench {

namespace {

constexpr double radius = 0.01;
constexpr double spacing = 2.05 * radius;

Environment box_for(std::uint32_t across, bool crowded) {
  BoxOptions o;
  const double width = across * spacing;
  const auto cells = crowded ? 2U : static_cast<std::uint32_t>(std::max(1.0, width / (3.0 * radius)));
  o.cells = {cells, cells, cells};
  o.size = {width, width, 1.1 * width};
  return Environment(generate_box(o), Threads{1});
}

std::vector<Vec3> places_in_heap(std::size_t count, std::uint32_t across) {
  Random random(1);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](std::size_t k) { return spacing * (double(k) + 0.5) + 0.02 * radius * random.uniform(-1, 1); };
    places.push_back({at(i % across), at(i / across % across), at(i / across / across)});
  }
  return places;
}

// Sums at one time, to be subtracted.
struct Sums {
  SimulationTotals totals;
  CollisionSeconds collisions;
};

void time_both_searches(const Simulation& flow, double dt, SphereRow& row) {
  std::vector<SphereMotion> spheres;
  for (std::size_t i = 0; i < row.spheres; ++i) {
    spheres.push_back({flow.particles()[i].position, flow.velocities()[i] * dt, radius * (1.0 + near_share)});
  }
  CellLists lists;
  lists.update(flow.environment().map(), flow.particles().states());
  const auto time = [&](PairSearch search) {
    double best = 1e300;
    for (int i = 0; i < 3; ++i) {
      PairFinder finder;  // a later search of one would take less
      const auto start = Clock::now();
      finder.find(flow.environment().complex(), lists, flow.particles().states(), spheres, Threads{1}, search);
      best = std::min(best, seconds_since(start));
    }
    return best * 1e9 / static_cast<double>(row.spheres);
  };
  if (lists.crowded() == 0) row.pairs_by_lists_ns = time(PairSearch::lists);
  row.pairs_by_grid_ns = time(PairSearch::grid);
}

const Collider& collider_of(const Simulation& simulation) {
  return view_of(simulation).particles.sphere_contacts().collider();
}

}  // namespace

SphereRow heap(std::size_t count, bool crowded) {
  const auto across = static_cast<std::uint32_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  Environment environment = box_for(across, crowded);
  SimulationOptions o;
  o.dt = 2e-3;
  o.gravity = {0.0, 0.0, -9.81};
  o.collisions = CollisionOptions{};
  o.collisions->restitution = o.collisions->friction = 0.3;
  o.response = Reflect{0.3, 0.3};
  Simulation flow(environment, o);
  flow.add(places_in_heap(count, across), {}, radius);

  SphereRow row;
  row.spheres = flow.particles().size();
  row.cells = environment.map().cell_count();
  row.steps = std::clamp<std::size_t>(1000000 / count, 5, 200);
  for (std::size_t i = 0; i < std::clamp<std::size_t>(2000000 / count, 10, 200); ++i) flow.step();
  const Sums before = {flow.totals(), collider_of(flow).seconds()};
  const auto start = Clock::now();
  for (std::size_t i = 0; i < row.steps; ++i) flow.step();
  const double whole = seconds_since(start);
  const Sums after = {flow.totals(), collider_of(flow).seconds()};

  const double steps = static_cast<double>(row.steps);
  const auto ns = [&](double seconds) { return seconds * 1e9 / (steps * static_cast<double>(row.spheres)); };
  const CollisionSeconds& t = after.collisions;
  const CollisionSeconds& t0 = before.collisions;
  row.lists_ns = ns(t.lists - t0.lists);
  row.pairs_ns = ns(t.pairs - t0.pairs);
  row.touch_ns = ns(t.contacts - t0.contacts);
  row.impulses_ns = ns(t.impulses - t0.impulses);
  row.walls_ns = ns(after.totals.seconds_collide - before.totals.seconds_collide) - row.lists_ns - row.pairs_ns -
                 row.touch_ns - row.impulses_ns;
  row.advance_ns = ns(after.totals.seconds_detect - before.totals.seconds_detect);
  row.steps_per_second = steps / whole;
  row.contacts = static_cast<double>(after.totals.collisions.pairs_near - before.totals.collisions.pairs_near) /
                 (steps * static_cast<double>(row.spheres));
  row.deepest = after.totals.collisions.deepest / radius;
  row.by_lists = collider_of(flow).finder().by_lists();
  environment.set_threads({});
  const auto start_of_all = Clock::now();
  for (std::size_t i = 0; i < row.steps; ++i) flow.step();
  row.steps_per_second_all = steps / seconds_since(start_of_all);
  environment.set_threads({1});
  time_both_searches(flow, o.dt, row);
  return row;
}

std::string spheres_text(std::span<const SphereRow> rows) {
  std::string out;
  for (const SphereRow& r : rows) {
    out += fmt::format(
        "{} spheres in {} cells, {:.1f} pairs each ({}): {:.0f} steps a second, {:.0f} on all threads; ns per sphere "
        "and step: lists {:.0f}, "
        "pairs {:.0f}, touches {:.0f}, impulses {:.0f}, walls {:.0f}, advance {:.0f}; pairs by lists {:.0f}, by the "
        "grid {:.0f}; deepest overlap {:.1e} radii\n",
        r.spheres, r.cells, r.contacts, r.by_lists ? "lists" : "grid", r.steps_per_second, r.steps_per_second_all,
        r.lists_ns, r.pairs_ns, r.touch_ns, r.impulses_ns, r.walls_ns, r.advance_ns, r.pairs_by_lists_ns,
        r.pairs_by_grid_ns, r.deepest);
  }
  return out;
}

std::string spheres_json(std::span<const SphereRow> rows) {
  nlohmann::ordered_json json = {{"version", DARTCAST_VERSION}, {"spheres", nlohmann::ordered_json::array()}};
  for (const SphereRow& r : rows) {
    json["spheres"].push_back({{"spheres", r.spheres},
                               {"cells", r.cells},
                               {"steps", r.steps},
                               {"pairs_per_sphere", r.contacts},
                               {"found_by", r.by_lists ? "lists" : "grid"},
                               {"steps_per_second", r.steps_per_second},
                               {"steps_per_second_on_all_threads", r.steps_per_second_all},
                               {"ns_per_sphere_step",
                                {{"lists", r.lists_ns},
                                 {"pairs", r.pairs_ns},
                                 {"touches", r.touch_ns},
                                 {"impulses", r.impulses_ns},
                                 {"walls", r.walls_ns},
                                 {"advance", r.advance_ns}}},
                               {"pairs_by_lists_ns", r.pairs_by_lists_ns},
                               {"pairs_by_grid_ns", r.pairs_by_grid_ns},
                               {"deepest_overlap", r.deepest}});
  }
  return json.dump(1);
}

}  // namespace dartcast::bench
