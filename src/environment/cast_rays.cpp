// Rays: particles that take one step, from their origins to the ends of their rays, and stop at the first wall. If the
// cells on the way are asked for, each ray walks once more, with a list.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "environment/environment_members.hpp"
#include "environment/particle_details.hpp"
#include "tracking/batch/batch_stepper.hpp"
#include "tracking/checked_point.hpp"
#include "tracking/passed_facets.hpp"
#include "tracking/place_in_simplex.hpp"

namespace dartcast {

namespace {

constexpr std::size_t rays_at_once = 1024;  // walked again by one thread

// A length that no ray within the scene exceeds.
double scene_size(std::span<const Vec3> points) {
  constexpr double most = std::numeric_limits<double>::infinity();
  Vec3 low{most, most, most};
  Vec3 high{-most, -most, -most};
  for (const Vec3& x : points) {
    if (!in_exact_range(x)) continue;
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const Vec3 size = high - low;
  return 2.0 * (size.x + size.y + size.z);
}

Vec3 end_of_ray(const Vec3& origin, const Vec3& direction, double length, std::size_t i, unsigned dimension) {
  const Vec3 unit = unit_of(direction);
  if (unit == Vec3{})
    throw InvalidArgument(
        fmt::format("cast_rays: the direction of ray {} is ({}, {}, {}): it must be finite, and not zero", i,
                    direction.x, direction.y, direction.z));
  return detail::checked_point(flushed(origin) + unit * length, "the end of ray", i, dimension);
}

void check_rays(std::size_t origins, std::size_t directions, double max_distance) {
  if (origins != directions)
    throw InvalidArgument(fmt::format("cast_rays: {} directions for {} origins", directions, origins));
  if (!(max_distance >= 0.0))
    throw InvalidArgument(fmt::format("cast_rays: the distance is {}: it must not be negative", max_distance));
}

// The cells of a walk to its first wall, or to its end, and the lengths in them.
template <std::size_t N>
void list_cells(const CellComplex& complex, SimplexId start, const Vec3& p, const Vec3& q,
                std::vector<detail::PassedFacet>& passed, RayCells& list) {
  const std::size_t first = list.cells.size();
  const double length = norm(q - p);
  double so_far = 0.0;
  detail::walk_cells(current_space<N>(complex), start, p, q, passed, [&](Cell cell, double fraction) {
    if (list.cells.size() == first || list.cells.back() != cell) {
      list.cells.push_back(cell);
      list.lengths.push_back(0.0);
    }
    list.lengths.back() += (fraction - so_far) * length;
    so_far = fraction;
  });
}

// In chunks, which are joined in the order of the rays.
RayCells cells_passed(const CellComplex& complex, std::span<const Location> at, std::span<const Vec3> origins,
                      std::span<const Vec3> ends, Threads threads) {
  const std::size_t rays = origins.size();
  std::vector<RayCells> chunks(chunk_count(rays, rays_at_once));
  parallel_for(rays, rays_at_once, threads, [&](std::size_t begin, std::size_t end) {
    RayCells& chunk = chunks[begin / rays_at_once];
    std::vector<detail::PassedFacet> passed;
    for (std::size_t i = begin; i < end; ++i) {
      chunk.first.push_back(chunk.cells.size());
      if (at[i].place != Place::free) continue;
      if (complex.map().dimension() == 2)
        list_cells<3>(complex, at[i].simplex, flushed(origins[i]), ends[i], passed, chunk);
      else
        list_cells<4>(complex, at[i].simplex, flushed(origins[i]), ends[i], passed, chunk);
    }
  });
  RayCells all;
  for (const RayCells& chunk : chunks) {
    for (const std::size_t first : chunk.first) all.first.push_back(all.cells.size() + first);
    all.cells.insert(all.cells.end(), chunk.cells.begin(), chunk.cells.end());
    all.lengths.insert(all.lengths.end(), chunk.lengths.begin(), chunk.lengths.end());
  }
  all.first.push_back(all.cells.size());
  return all;
}

}  // namespace

std::vector<RayHit> Environment::cast_rays(std::span<const Vec3> origins, std::span<const Vec3> directions,
                                           double max_distance, RayCells* passed) {
  check_rays(origins.size(), directions.size(), max_distance);
  const CellComplex& complex = members_->complex;
  const unsigned dimension = map().dimension();
  const double length = std::min(max_distance, scene_size(complex.positions()));
  const std::vector<Location> at = locate(origins);
  std::vector<RayHit> hits(origins.size());
  std::vector<Vec3> ends(origins.size());
  std::vector<std::uint32_t> cast;  // rays whose origins are free
  for (std::size_t i = 0; i < origins.size(); ++i) {
    hits[i].origin = at[i].place;
    ends[i] = end_of_ray(origins[i], directions[i], length, i, dimension);
    if (at[i].place == Place::free) cast.push_back(static_cast<std::uint32_t>(i));
  }
  // By cells: rays that begin near one another find the scene in the processor's caches.
  std::stable_sort(cast.begin(), cast.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return at[a].simplex.cell < at[b].simplex.cell; });
  Particles particles;
  std::vector<Vec3> targets;
  for (const std::uint32_t i : cast) {
    targets.push_back(ends[i]);
    members_->add_to(particles, at[i].simplex, flushed(origins[i]));
  }
  const StepOptions options;
  const ContactCallback none;
  const detail::BatchStepper stepper(complex, false, threads(), options, none, false);
  const StepReport report = members_->advance(particles, targets, stepper);
  for (const Contact& contact : report.contacts.contacts) {
    const WallHit& wall = report.contacts.walls_of(contact).front();
    RayHit& hit = hits[cast[contact.particle]];
    hit.hit = true;
    hit.kind = contact.kind;
    hit.face = wall.face;
    hit.triangle = wall.triangle;
    hit.patch = wall.patch;
    hit.distance = contact.time_of_impact * length;
    hit.point = contact.point;
    hit.normal = wall.normal;
  }
  for (const HeldParticle& held : report.held) hits[cast[held.particle]].invalid_cell = held.cell;
  if (passed != nullptr) *passed = cells_passed(complex, at, origins, ends, threads());
  return hits;
}

}  // namespace dartcast
