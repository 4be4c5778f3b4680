// Rays among walls. For each scene: all rays through cells, and the same segments by Embree, by turns.
#include "bench/rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/keyed_random.hpp"
#include "base/random.hpp"
#include "bench/competitors.hpp"
#include "bench/timing.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "simulation/seeding.hpp"

namespace dartcast::bench {

namespace {

constexpr std::size_t ray_count = 20000;
constexpr int rounds = 9;

template <class Work>
double nanoseconds_each(Work&& work) {
  const auto start = Clock::now();
  work();
  return 1e9 * seconds_since(start) / ray_count;
}

MeshData box(std::size_t across, double blocked_share) {
  BoxOptions o;
  const auto n = static_cast<std::uint32_t>(across);
  o.cells = {n, n, n};
  o.size = Vec3{1, 1, 1} * static_cast<double>(n);
  o.blocked_layer = true;
  o.blocked_share = blocked_share;
  return generate_box(o);
}

class RayBench {
 public:
  RayBench(std::size_t across, double blocked_share)
      : environment_(box(across, blocked_share), Threads{1}),
        walls_(walls_of(environment_.complex())),
        hits_(ray_count) {
    Random random(3);
    KeyedRandom places(3, RandomPurpose::place, 0);
    const VolumeSampler sampler(environment_.complex());
    const double far = 3.0 * static_cast<double>(across);
    while (origins_.size() < ray_count) {
      Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      if (norm(d) > 1.0 || norm(d) < 0.1) continue;
      origins_.push_back(sampler.sample(environment_.complex(), places)->position);
      directions_.push_back(d);
      segments_.push_back({origins_.back(), origins_.back() + d * (far / norm(d))});
    }
    walls_.gather(environment_.complex().positions(), points_);
  }

  void run(RayBenchRow& row) {
    row.rays = ray_count;
    row.cells = environment_.map().cell_count();
    std::unique_ptr<Competitor> single;
    std::unique_ptr<Competitor> packet;
    for (const PeerKind& kind : competitor_kinds()) {
      if (kind.name == "embree_single") single = kind.make({environment_.complex(), walls_, points_, {}, false});
      if (kind.name == "embree_packet") packet = kind.make({environment_.complex(), walls_, points_, {}, false});
    }
    std::vector<double> locate;
    std::vector<double> cast;
    std::vector<double> by_one;
    std::vector<double> by_many;
    for (int round = 0; round < rounds; ++round) {
      locate.push_back(nanoseconds_each([&] { (void)environment_.locate(origins_); }));
      cast.push_back(nanoseconds_each([&] { found_ = environment_.cast_rays(origins_, directions_); }));
      if (single) by_one.push_back(nanoseconds_each([&] { single->cast(segments_, hits_); }));
      if (packet) by_many.push_back(nanoseconds_each([&] { packet->cast(segments_, hits_); }));
    }
    row.locate_ns = median(locate);
    row.cast_ns = median(cast);
    if (single) row.embree_single = median(by_one);
    if (!packet) return;
    row.embree_packet = median(by_many);
    packet->translate(hits_);
    for (std::size_t i = 0; i < ray_count; ++i) {
      const std::uint32_t mine = found_[i].hit ? walls_.number({found_[i].face, found_[i].triangle}) : Hit::none;
      row.unlike += mine != hits_[i].triangle ? 1 : 0;
    }
  }

 private:
  Environment environment_;
  Walls walls_;
  std::vector<Vec3> points_, origins_, directions_;
  std::vector<Segment> segments_;
  std::vector<RayHit> found_;
  std::vector<Hit> hits_;
};

}  // namespace

RayBenchRow time_rays(std::size_t across, double blocked_share) {
  RayBenchRow row;
  row.blocked_share = blocked_share;
  RayBench(across, blocked_share).run(row);
  return row;
}

std::string rays_text(std::span<const RayBenchRow> rows) {
  std::string out =
      "ns for a ray, of 20,000 in a box at rest, on one thread\n"
      "    cells   blocked     cast (of it, locate)   Embree, one   packets   other walls\n";
  for (const RayBenchRow& r : rows)
    out += fmt::format("{:9}   {:6.1f}%   {:6.0f} ({:4.0f})            {:8.0f}  {:8.0f}   {:8}\n", r.cells,
                       100.0 * r.blocked_share, r.cast_ns, r.locate_ns, r.embree_single, r.embree_packet, r.unlike);
  return out;
}

std::string rays_json(std::span<const RayBenchRow> rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RayBenchRow& r : rows)
    json.push_back({{"cells", r.cells},
                    {"blocked_share", r.blocked_share},
                    {"rays", r.rays},
                    {"locate_ns", r.locate_ns},
                    {"cast_ns", r.cast_ns},
                    {"embree_single_ns", r.embree_single},
                    {"embree_packet_ns", r.embree_packet},
                    {"unlike", r.unlike}});
  return json.dump(1);
}

}  // namespace dartcast::bench
