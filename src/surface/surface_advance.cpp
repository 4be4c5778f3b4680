// Steps many particles on a surface, in parallel.
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/surface.hpp"

namespace dartcast {

namespace {

constexpr std::size_t particle_grain = 512;

SurfaceStep named_step(const Surface& surface, SurfacePlace& place, const Vec3& displacement,
                       const SurfaceContactCallback& respond, const SurfaceOptions& options,
                       std::vector<SurfaceContact>& contacts, std::size_t particle) {
  try {
    return step(surface, place, displacement, respond, options, {&contacts, nullptr},
                static_cast<std::uint32_t>(particle));
  } catch (const InvalidArgument& e) {
    throw InvalidArgument(fmt::format("particle {}: {}", particle, e.what()));
  }
}

}  // namespace

SurfaceReport advance(const Surface& surface, std::span<SurfacePlace> places, std::span<const Vec3> displacements,
                      const SurfaceContactCallback& respond, const SurfaceOptions& options, Threads threads) {
  if (places.size() != displacements.size())
    throw InvalidArgument(fmt::format("advance: {} places and {} displacements", places.size(), displacements.size()));
  SurfaceReport report;
  report.steps.resize(places.size());
  std::vector<SurfacePlace> moved(places.begin(), places.end());
  std::vector<std::vector<SurfaceContact>> parts(chunk_count(places.size(), particle_grain));
  parallel_for(places.size(), particle_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      report.steps[i] =
          named_step(surface, moved[i], displacements[i], respond, options, parts[begin / particle_grain], i);
    }
  });
  for (const auto& part : parts) report.contacts.insert(report.contacts.end(), part.begin(), part.end());
  std::copy(moved.begin(), moved.end(), places.begin());
  return report;
}

}  // namespace dartcast
