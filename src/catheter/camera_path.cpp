// A camera's path: a spline through points of the lumen, and a walk from each point to the spline.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "catheter/transport.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/error.hpp"
#include "dartcast/response.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr std::size_t span_pieces = 64;  // of a span of the spline, to measure it

// One span, as a polynomial in [0, 1].
struct Span {
  Vec3 a, b, c, d;  // position a + b u + c u^2 + d u^3

  [[nodiscard]] Vec3 at(double u) const { return a + (b + (c + d * u) * u) * u; }
  [[nodiscard]] Vec3 slope(double u) const { return b + (c * 2.0 + d * (3.0 * u)) * u; }
};

// From p[1] to p[2]. The distances of knots are the roots of the points' distances.
Span span_of(const std::array<Vec3, 4>& p) {
  std::array<double, 3> gap{};
  for (std::size_t i = 0; i < 3; ++i) gap[i] = std::sqrt(norm(p[i + 1] - p[i]));
  const auto rate = [&](std::size_t i, std::size_t j, double knots) { return (p[j] - p[i]) * (gap[1] / knots); };
  const Vec3 through = p[2] - p[1];
  const Vec3 start = rate(0, 1, gap[0]) - rate(0, 2, gap[0] + gap[1]) + through;
  const Vec3 end = through - rate(1, 3, gap[1] + gap[2]) + rate(2, 3, gap[2]);
  return {p[1], start, through * 3.0 - start * 2.0 - end, (start + end) - through * 2.0};
}

// The points without repeats, and the point at which each span starts.
struct Knots {
  std::vector<Vec3> points;
  std::vector<std::size_t> index;
};

Knots knots_of(std::span<const Vec3> points) {
  Knots knots;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!knots.points.empty() && knots.points.back() == points[i]) continue;
    knots.points.push_back(points[i]);
    knots.index.push_back(i);
  }
  if (knots.points.size() < 2) throw InvalidArgument("camera path: it needs two points or more at different places");
  return knots;
}

std::vector<Span> spans_of(const std::vector<Vec3>& p) {
  std::vector<Span> spans;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const Vec3 before = i > 0 ? p[i - 1] : p[0] * 2.0 - p[1];
    const Vec3 after = i + 2 < p.size() ? p[i + 2] : p[i + 1] * 2.0 - p[i];
    spans.push_back(span_of({before, p[i], p[i + 1], after}));
  }
  return spans;
}

// The length of the spline up to each piece's end.
std::vector<double> lengths_of(const std::vector<Span>& spans) {
  std::vector<double> lengths = {0.0};
  for (const Span& s : spans) {
    for (std::size_t k = 0; k < span_pieces; ++k) {
      const double u = static_cast<double>(k) / span_pieces;
      lengths.push_back(lengths.back() + norm(s.at(u + 1.0 / span_pieces) - s.at(u)));
    }
  }
  return lengths;
}

// A camera's place on the spline: the span, and the parameter in it.
struct Stop {
  std::size_t span;
  double u;
};

Stop stop_at(const std::vector<double>& lengths, double length) {
  const auto next = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto piece = static_cast<std::size_t>(next - lengths.begin()) - 1;
  const double whole = lengths[piece + 1] - lengths[piece];
  const double share = whole > 0.0 ? std::clamp((length - lengths[piece]) / whole, 0.0, 1.0) : 0.0;
  return {piece / span_pieces, (static_cast<double>(piece % span_pieces) + share) / span_pieces};
}

std::vector<Stop> stops_along(const std::vector<Span>& spans, const CameraOptions& o) {
  const std::vector<double> lengths = lengths_of(spans);
  const double number = lengths.back() / o.spacing;
  if (!(number < static_cast<double>(o.max_count)))
    throw InvalidArgument(fmt::format(
        "camera path: a spacing of {} over a length of {} would take more than {} cameras: give a larger spacing",
        o.spacing, lengths.back(), o.max_count));
  std::vector<Stop> stops;
  for (double i = 0.0; i < number; ++i) stops.push_back(stop_at(lengths, i * o.spacing));
  stops.push_back({spans.size() - 1, 1.0});
  return stops;
}

// Walks a particle from each stop's point to the spline.
CameraPath walked(Environment& environment, const Knots& knots, const std::vector<Span>& spans,
                  const std::vector<Stop>& stops) {
  const std::vector<Location> places = environment.locate(knots.points);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].place != Place::free)
      throw InvalidArgument(fmt::format("camera path: point {} is in no free cell", knots.index[i]));
  }
  Particles particles;
  std::vector<Vec3> targets;
  for (const Stop& s : stops) {
    if (!environment.add(particles, places[s.span].simplex, knots.points[s.span]))
      throw InternalError("camera path: a point that was located is not where it was");
    targets.push_back(flushed(spans[s.span].at(s.u)));
  }
  const StepReport report = environment.advance(
      particles, targets, [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
        return AfterContact{slid(c.unused, walls, earlier), true};
      });
  CameraPath path;
  for (const ParticleState& s : particles.states()) path.cameras.push_back({s.position, {}, {}, 0.0});
  for (std::size_t i = 0; i < stops.size(); ++i) path.at_walls += particles[i].position != targets[i] ? 1 : 0;
  return path;
}

}  // namespace

CameraPath camera_path(Environment& environment, std::span<const Vec3> points, const CameraOptions& options) {
  if (!(options.spacing > 0.0) || !std::isfinite(options.spacing) || !is_finite(options.up))
    throw InvalidArgument("camera path: the spacing must be positive and finite, and the direction up finite");
  if (environment.map().dimension() != 3) throw InvalidArgument("camera path: the environment must be of space");
  const Knots knots = knots_of(points);
  const std::vector<Span> spans = spans_of(knots.points);
  const std::vector<Stop> stops = stops_along(spans, options);
  CameraPath path = walked(environment, knots, spans, stops);
  Vec3 direction = unit_or(knots.points[1] - knots.points[0], {0.0, 0.0, 1.0});
  direction = unit_or(spans.front().slope(0.0), direction);
  Vec3 up = unit_or(options.up - direction * dot(options.up, direction), any_normal(direction));
  for (std::size_t i = 0; i < stops.size(); ++i) {
    Camera& camera = path.cameras[i];
    camera.direction = unit_or(spans[stops[i].span].slope(stops[i].u), direction);
    up = camera.up = transported(up, direction, camera.direction);
    direction = camera.direction;
    if (i > 0) camera.arc = path.cameras[i - 1].arc + norm(camera.position - path.cameras[i - 1].position);
  }
  return path;
}

}  // namespace dartcast
