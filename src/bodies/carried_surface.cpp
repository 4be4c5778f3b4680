// Weights of samples for each vertex, by moving least squares, and the vertices that follow from them.
#include "bodies/carried_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

namespace {

constexpr double max_amplification = 8.0;
constexpr double flatness = 0x1p-20;  // of the extent of samples; thinner sets count as flat
constexpr std::size_t grain = 256;    // vertices

// Sorts nearest samples first; at equal distances the lower number first.
class NearestSamples {
 public:
  explicit NearestSamples(std::span<const Vec3> samples) : samples_(samples), tree_(points(samples)) {
    bounds_ = {samples.front(), samples.front()};
    for (const Vec3& p : samples) bounds_ = join(bounds_, {p, p});
    const Vec3 size = bounds_.high - bounds_.low;
    start_ = std::max({size.x, size.y, size.z}) / cube_root(static_cast<double>(samples.size()));
    if (!(start_ > 0.0)) start_ = 1.0;  // all at one place: any radius will do
  }

  [[nodiscard]] std::vector<std::uint32_t> of(const Vec3& x, std::size_t count) const {
    std::vector<std::pair<double, std::uint32_t>> found;
    for (double radius = start_; found.size() < count; radius *= 2.0) {
      found.clear();
      const Vec3 r = {radius, radius, radius};
      const Box box = {x - r, x + r};
      const Box both = join(box, bounds_);
      const bool all = both.low == box.low && both.high == box.high;
      tree_.query(box, [&](std::size_t i) {
        const double distance = norm(samples_[i] - x);
        if (all || distance <= radius) found.emplace_back(distance, static_cast<std::uint32_t>(i));
        return true;
      });
      if (all) break;
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> nearest;
    for (std::size_t i = 0; i < std::min(count, found.size()); ++i) nearest.push_back(found[i].second);
    return nearest;
  }

 private:
  static std::vector<Box> points(std::span<const Vec3> samples) {
    std::vector<Box> boxes;
    for (const Vec3& p : samples) boxes.push_back({p, p});
    return boxes;
  }

  std::span<const Vec3> samples_;
  BoxTree tree_;
  Box bounds_;
  double start_;
};

using Columns = std::array<std::vector<double>, 4>;

double product(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Makes the columns orthonormal, left to right, each twice (W. Kahan, B. N. Parlett: twice is enough), and solves R' z
// = (1, 0, 0, 0) for the factor R. Returns nothing if a column depends on those before it, to rounding.
std::optional<std::array<double, 4>> orthonormalized(Columns& q) {
  std::array<double, 4> z{};
  for (std::size_t j = 0; j < 4; ++j) {
    const double length = std::sqrt(product(q[j], q[j]));
    double rest = j == 0 ? 1.0 : 0.0;
    for (std::size_t i = 0; i < 2 * j; ++i) {
      const std::vector<double>& before = q[i % j];
      const double r = product(before, q[j]);
      for (std::size_t k = 0; k < before.size(); ++k) q[j][k] -= r * before[k];
      rest -= r * z[i % j];
    }
    const double left = std::sqrt(product(q[j], q[j]));
    if (!(left > flatness * length)) return {};
    for (double& c : q[j]) c /= left;
    z[j] = rest / left;
  }
  return z;
}

// Affine weights of x over some samples: sum w = 1 and sum w p = x. The sum of (w / theta)^2 is the least possible, for
// a bell theta around x. Empty if the samples lie in a plane.
std::vector<double> affine_weights(const Vec3& x, std::span<const Vec3> samples, std::span<const std::uint32_t> near) {
  double far = 0.0;
  for (const std::uint32_t i : near) far = std::max(far, norm(samples[i] - x));
  if (!(far > 0.0)) return {};
  std::vector<double> bell;
  Columns columns;  // theta (1, p - x), in units of the farthest
  for (const std::uint32_t i : near) {
    const Vec3 r = (samples[i] - x) * (1.0 / far);
    bell.push_back(exponential(-2.0 * dot(r, r)));
    const std::array<double, 4> row = {1.0, r.x, r.y, r.z};
    for (std::size_t j = 0; j < 4; ++j) columns[j].push_back(bell.back() * row[j]);
  }
  const auto z = orthonormalized(columns);
  if (!z) return {};
  std::vector<double> w(near.size());
  for (std::size_t k = 0; k < w.size(); ++k) {
    for (std::size_t j = 0; j < 4; ++j) w[k] += bell[k] * columns[j][k] * (*z)[j];
  }
  return w;
}

double magnitudes(std::span<const double> weights) {
  return std::accumulate(weights.begin(), weights.end(), 0.0, [](double s, double w) { return s + std::abs(w); });
}

void check_points(const char* what, std::span<const Vec3> points) {
  const auto bad = std::find_if(points.begin(), points.end(), [](const Vec3& p) { return !is_finite(p); });
  if (bad != points.end())
    throw InvalidArgument(fmt::format("carried surface: {} {} is not finite", what, bad - points.begin()));
}

}  // namespace

CarriedSurface::CarriedSurface(std::span<const Vec3> vertices, std::span<const Vec3> samples, std::size_t neighbours)
    : samples_(samples.size()) {
  check_points("vertex", vertices);
  check_points("sample", samples);
  if (samples.size() < 4)
    throw InvalidArgument(fmt::format(
        "carried surface: {} samples do not span space: take 4 or more, with a smaller spacing", samples.size()));
  const NearestSamples nearest(samples);
  for (const Vec3& x : vertices) {
    std::size_t count = std::clamp<std::size_t>(neighbours, 4, samples.size());
    std::vector<std::uint32_t> near;
    std::vector<double> w;
    while (true) {
      near = nearest.of(x, count);
      w = affine_weights(x, samples, near);
      if ((!w.empty() && magnitudes(w) <= max_amplification) || count == samples.size()) break;
      count = std::min(2 * count, samples.size());
    }
    if (w.empty())
      throw InvalidArgument(
          "carried surface: the samples lie in a plane: sample the volume too, or with a smaller spacing");
    amplification_ = std::max(amplification_, magnitudes(w));
    for (std::size_t i = 0; i < near.size(); ++i) weights_.push_back({near[i], w[i]});
    first_.push_back(weights_.size());
  }
}

void CarriedSurface::positions(std::span<const Vec3> samples, std::span<Vec3> vertices, Threads threads) const {
  if (samples.size() != samples_ || vertices.size() != vertex_count())
    throw InvalidArgument(fmt::format("carried surface: {} samples and {} vertices for {} and {}", samples.size(),
                                      vertices.size(), samples_, vertex_count()));
  parallel_for(vertices.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      // Relative to the nearest sample: the weights sum to 1, and a translation rounds nothing but the result.
      const Vec3& origin = samples[weights_[first_[v]].sample];
      Vec3 sum;
      for (std::size_t k = first_[v] + 1; k < first_[v + 1]; ++k)
        sum += (samples[weights_[k].sample] - origin) * weights_[k].weight;
      vertices[v] = origin + sum;
    }
  });
}

}  // namespace dartcast
