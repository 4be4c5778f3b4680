// Which particles cross a plane in a step, by exact signs; and how long they had been there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/parallel.hpp"
#include "base/vec3_parts.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/statistics.hpp"
#include "predicates/expansion.hpp"

namespace dartcast {

namespace {

constexpr std::string_view plane_name_characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";

[[noreturn]] void refuse(const SectionPlane& plane, std::string_view why) {
  throw InvalidArgument(fmt::format("plane \"{}\": {}", plane.name, why));
}

void check(const SectionPlane& plane) {
  if (plane.name.empty() || plane.name.size() > 64 ||
      plane.name.find_first_not_of(plane_name_characters) != std::string::npos)
    refuse(plane, "a name has 1 to 64 letters, digits, - and _");
  if (!in_exact_range(plane.point)) refuse(plane, "its point must be finite and within 2^300");
  if (!is_finite(plane.normal) || plane.normal == Vec3{}) refuse(plane, "its normal must be finite and not zero");
  if (!std::isfinite(plane.radius) || plane.radius < 0.0) refuse(plane, "its radius must be finite and not negative");
}

/// A plane whose normal is scaled by a power of two, so that no product is too large or too small to be exact.
class ScaledPlane {
 public:
  explicit ScaledPlane(const SectionPlane& plane) : point_(plane.point), radius_(plane.radius) {
    const int exponent = std::ilogb(largest_component(plane.normal));
    const auto scaled = [&](double c) {
      const double s = std::scalbn(c, -exponent);
      return std::abs(s) < 0x1p-300 ? 0.0 : s;
    };
    normal_ = {scaled(plane.normal.x), scaled(plane.normal.y), scaled(plane.normal.z)};
  }

  [[nodiscard]] double height(const Vec3& x) const { return dot(normal_, x - point_); }

  // Two products and a sum each round by less than 2^-53 of the terms, as do the differences.
  [[nodiscard]] bool is_behind(const Vec3& x) const {
    const Vec3 d = x - point_;
    const Vec3 terms = {normal_.x * d.x, normal_.y * d.y, normal_.z * d.z};
    const double sum = terms.x + terms.y + terms.z;
    const double size = std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z);
    if (std::abs(sum) > 0x1p-50 * size && size > 0x1p-900) return sum < 0.0;
    return (scale(difference(x.x, point_.x), normal_.x) + scale(difference(x.y, point_.y), normal_.y) +
            scale(difference(x.z, point_.z), normal_.z))
               .sign() < 0;
  }

  // Precondition: the two are on different sides.
  void add_crossing(std::uint32_t plane, std::uint32_t particle, const Vec3& before, const Vec3& after,
                    std::vector<PlaneCrossing>& to) const {
    PlaneCrossing c{plane, particle, is_behind(before), 1.0, after};
    const double from = height(before);
    const double span = from - height(after);
    if (span != 0.0) c.share = std::clamp(from / span, 0.0, 1.0);
    if (c.share < 1.0) c.point = before + (after - before) * c.share;
    if (radius_ == 0.0 || norm(c.point - point_) <= radius_) to.push_back(c);
  }

 private:
  Vec3 point_;
  Vec3 normal_;
  double radius_;
};

constexpr std::size_t crossing_grain = 4096;  // particles

}  // namespace

void check(std::span<const SectionPlane> planes) {
  for (std::size_t i = 0; i < planes.size(); ++i) {
    check(planes[i]);
    const auto has_name = [&](const SectionPlane& other) { return other.name == planes[i].name; };
    if (std::any_of(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(i), has_name))
      refuse(planes[i], "another plane has this name; give it one of its own");
  }
}

std::vector<PlaneCrossing> find_crossings(std::span<const SectionPlane> planes, std::span<const Vec3> before,
                                          std::span<const Vec3> after, Threads threads) {
  check(planes);
  if (before.size() != after.size())
    throw InvalidArgument(
        fmt::format("find_crossings: {} positions before the step and {} after it", before.size(), after.size()));
  std::vector<ScaledPlane> scaled(planes.begin(), planes.end());
  std::vector<std::vector<PlaneCrossing>> found(chunk_count(before.size(), crossing_grain));
  parallel_for(before.size(), crossing_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t p = 0; p < scaled.size(); ++p) {
        if (scaled[p].is_behind(before[i]) != scaled[p].is_behind(after[i]))
          scaled[p].add_crossing(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(i), before[i], after[i],
                                 found[begin / crossing_grain]);
      }
    }
  });
  std::vector<PlaneCrossing> all;
  for (const auto& chunk : found) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

// A bin is the first one's width times a power of two. So bins are joined pair by pair, and the order of adding does
// not matter.
void ResidenceTimes::add(double seconds, double first_bin, std::uint64_t number) {
  if (count == 0) {
    bin = first_bin;
    least = seconds;
  }
  count += number;
  sum += static_cast<double>(number) * seconds;
  least = std::min(least, seconds);
  most = std::max(most, seconds);
  double place = std::floor(seconds / first_bin) * (first_bin / bin);
  while (place >= static_cast<double>(bin_count)) {
    for (std::size_t i = 0; i < bin_count; ++i) bins[i] = 2 * i < bin_count ? bins[2 * i] + bins[2 * i + 1] : 0;
    bin *= 2.0;
    place *= 0.5;
  }
  bins[static_cast<std::size_t>(place)] += number;
}

double ResidenceTimes::washout(std::size_t i) const {
  std::uint64_t later = 0;
  for (std::size_t k = i; k < bin_count; ++k) later += bins[k];
  return count == 0 ? 0.0 : static_cast<double>(later) / static_cast<double>(count);
}

}  // namespace dartcast
