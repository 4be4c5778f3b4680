// Samples of a surface, on it and in it: candidates in random order, kept if no sample is near.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "base/random.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/error.hpp"
#include "surface/inside.hpp"
#include "surface/triangles.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr double piece_share = 0.25;         // of the spacing: the longest edge of a piece of the surface
constexpr double cube_share = 0.5;           // of the spacing: the edge of a cube of candidates
constexpr double smallest_share = 0x1p-30;   // of the largest coordinate: a smaller spacing would be lost in rounding
constexpr std::size_t max_candidates = 200;  // for each sample that the caller accepts

enum Stream : std::uint64_t { surface_stream = 1, volume_stream = 2, order_stream = 3 };

[[noreturn]] void refuse_number(const SamplingOptions& o) {
  throw InvalidArgument(fmt::format(
      "sampling: a spacing of {} would take more than the {} samples allowed: give a larger spacing, or allow "
      "more",
      o.spacing, o.max_count));
}

void check_sampling(const MeshData& surface, const SamplingOptions& o) {
  if (!(o.spacing > 0.0) || !std::isfinite(o.spacing))
    throw InvalidArgument(fmt::format("sampling: the spacing is {}; it must be positive and finite", o.spacing));
  double largest = 0.0;
  for (const Vec3& p : surface.points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  if (o.spacing < smallest_share * largest)
    throw InvalidArgument(fmt::format(
        "sampling: a spacing of {} is lost in the rounding of coordinates as large as {}: give a larger one, or "
        "bring the surface near the origin",
        o.spacing, largest));
}

std::vector<Vec3> shuffled(std::vector<Vec3> points, std::uint64_t seed) {
  Random random(seed, order_stream);
  for (std::size_t n = points.size(); n > 1; --n) std::swap(points[n - 1], points[random.next() % n]);
  return points;
}

// The samples so far, by cubes as wide as the spacing. A sample that is too near is in the same cube or beside it.
class Samples {
 public:
  explicit Samples(double spacing) : spacing_(spacing) {}

  [[nodiscard]] bool too_near(const Vec3& x) const {
    const auto [i, j, k] = cube_of(x);
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto found = last_.find(key({i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1}));
      if (found == last_.end()) continue;
      for (std::uint32_t s = found->second; s != none; s = before_[s]) {
        if (norm(points_[s] - x) < spacing_) return true;
      }
    }
    return false;
  }

  void add(const Vec3& x) {
    const auto [found, fresh] = last_.try_emplace(key(cube_of(x)), none);
    before_.push_back(std::exchange(found->second, static_cast<std::uint32_t>(points_.size())));
    points_.push_back(x);
  }

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] std::vector<Vec3>& points() { return points_; }

 private:
  using Cube = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t none = 0xffffffffU;

  // Below 2^31 in magnitude, because the spacing is at least 2^-30 of every coordinate.
  [[nodiscard]] Cube cube_of(const Vec3& x) const {
    const auto at = [this](double c) { return static_cast<std::int64_t>(std::floor(c / spacing_)); };
    return {at(x.x), at(x.y), at(x.z)};
  }
  // Cubes that share a key only cost time.
  [[nodiscard]] static std::uint64_t key(const Cube& c) {
    std::uint64_t mixed = 0;
    for (const std::int64_t i : c) mixed = Random(mixed ^ static_cast<std::uint64_t>(i)).next();
    return mixed;
  }

  double spacing_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> before_;  // in the same cube
  std::unordered_map<std::uint64_t, std::uint32_t> last_;
};

using TrianglePiece = std::array<Vec3, 3>;

// The longest edge: from corner i to the next.
std::size_t longest_edge(const TrianglePiece& t) {
  std::array<double, 3> length{};
  for (std::size_t i = 0; i < 3; ++i) length[i] = norm(t[(i + 1) % 3] - t[i]);
  return static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
}

Vec3 random_point(const TrianglePiece& t, Random& random) {
  double u = random.uniform();
  double v = random.uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return flushed(t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v);
}

// A piece whose longest edge is 1 has at most this area.
constexpr double largest_piece = 0.4331;  // sqrt(3) / 4, rounded up

// Refuses surfaces whose area alone needs too many pieces.
void check_area(const std::vector<TrianglePiece>& triangles, const SamplingOptions& o, double max_count) {
  double area = 0.0;
  for (const TrianglePiece& t : triangles) area += 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
  const double edge = piece_share * o.spacing;
  if (area / edge / edge > largest_piece * max_count) refuse_number(o);
}

// One random point in each piece. Triangles are halved across their longest edge (M.-C. Rivara, 1984), so that
// needles make no more pieces than their area and length need.
std::vector<Vec3> surface_candidates(const MeshData& surface, const SamplingOptions& o) {
  std::vector<TrianglePiece> open;
  for (const SurfaceTriangle& t : surface_triangles(surface))
    open.push_back({surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]});
  const double max_count = static_cast<double>(o.max_count) * max_candidates + static_cast<double>(open.size());
  check_area(open, o, max_count);
  Random random(o.seed, surface_stream);
  std::vector<Vec3> candidates;
  while (!open.empty()) {
    const TrianglePiece piece = open.back();
    open.pop_back();
    const std::size_t i = longest_edge(piece);
    const Vec3 &a = piece[i], &b = piece[(i + 1) % 3], &c = piece[(i + 2) % 3];
    if (norm(b - a) <= piece_share * o.spacing) {
      candidates.push_back(random_point(piece, random));
      if (static_cast<double>(candidates.size()) > max_count) refuse_number(o);
      continue;
    }
    const Vec3 middle = a * 0.5 + b * 0.5;
    open.push_back({a, middle, c});
    open.push_back({middle, b, c});
  }
  return candidates;
}

void sample_surface_into(Samples& samples, const MeshData& surface, const SamplingOptions& o) {
  for (const Vec3& x : shuffled(surface_candidates(surface, o), o.seed)) {
    if (samples.too_near(x)) continue;
    if (samples.size() == o.max_count) refuse_number(o);
    samples.add(x);
  }
}

// One random point in each cube of a grid over the surface's box.
std::vector<Vec3> volume_candidates(const MeshData& surface, const InsideTest& inside, const SamplingOptions& o) {
  Box box = box_of(surface.points, inside.triangles().front());
  for (const SurfaceTriangle& t : inside.triangles()) box = join(box, box_of(surface.points, t));
  const double edge = cube_share * o.spacing;
  const Vec3 size = (box.high - box.low) * (1.0 / edge);
  const std::array<double, 3> cubes = {std::floor(size.x) + 1.0, std::floor(size.y) + 1.0, std::floor(size.z) + 1.0};
  if (cubes[0] * cubes[1] * cubes[2] > static_cast<double>(o.max_count) * max_candidates) refuse_number(o);
  Random random(o.seed, volume_stream);
  std::vector<Vec3> candidates;
  for (double k = 0.0; k < cubes[2]; ++k) {
    for (double j = 0.0; j < cubes[1]; ++j) {
      for (double i = 0.0; i < cubes[0]; ++i) {
        const Vec3 place = {i + random.uniform(), j + random.uniform(), k + random.uniform()};
        candidates.push_back(flushed(box.low + place * edge));
      }
    }
  }
  return candidates;
}

void sample_volume_into(Samples& samples, const MeshData& surface, const SamplingOptions& o) {
  const InsideTest inside(surface);
  for (const Vec3& x : shuffled(volume_candidates(surface, inside, o), o.seed)) {
    if (samples.too_near(x) || inside.side(x) != PointSide::inside) continue;
    if (samples.size() == o.max_count) refuse_number(o);
    samples.add(x);
  }
}

}  // namespace

std::vector<Vec3> sample_surface(const MeshData& surface, const SamplingOptions& options) {
  check_sampling(surface, options);
  Samples samples(options.spacing);
  sample_surface_into(samples, surface, options);
  return std::move(samples.points());
}

std::vector<Vec3> sample_volume(const MeshData& surface, const SamplingOptions& options) {
  check_sampling(surface, options);
  Samples samples(options.spacing);
  sample_volume_into(samples, surface, options);
  return std::move(samples.points());
}

SolidSamples sample_solid(const MeshData& surface, const SamplingOptions& options) {
  check_sampling(surface, options);
  Samples samples(options.spacing);
  sample_surface_into(samples, surface, options);
  const std::size_t on_surface = samples.size();
  sample_volume_into(samples, surface, options);
  return {std::move(samples.points()), on_surface};
}

}  // namespace dartcast
