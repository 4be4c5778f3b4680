// Surfaces: construction, moves, places and points.
#include "dartcast/surface.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "surface/check_surface.hpp"
#include "surface/unfold.hpp"

namespace dartcast {

namespace {

constexpr std::size_t surface_grain = 4096;

MeshData checked_surface(MeshData mesh) {
  const MeshReport report = check_and_repair_surface(mesh);
  if (!report.defects.empty()) {
    const Finding& f = report.defects.front();
    throw InvalidMesh(fmt::format("{}: {}, the first: {}", f.message, f.count, fmt::join(f.first, ", ")));
  }
  return mesh;
}

void check_positions(std::span<const Vec3> positions, std::size_t count) {
  if (positions.size() != count)
    throw InvalidArgument(fmt::format("move: {} positions for a surface of {} points", positions.size(), count));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!in_exact_range(positions[i]))
      throw InvalidArgument(
          fmt::format("move: position {} is ({}, {}, {}): coordinates must be finite, and at most 2^300 in magnitude",
                      i, positions[i].x, positions[i].y, positions[i].z));
  }
}

}  // namespace

Surface::Surface(MeshData mesh) {
  mesh = checked_surface(std::move(mesh));
  map_ = CombinatorialMap(mesh);
  positions_ = std::move(mesh.points);
  std::transform(positions_.begin(), positions_.end(), positions_.begin(), flushed);
}

void Surface::move(std::span<const Vec3> positions, Threads threads) {
  check_positions(positions, positions_.size());
  const std::vector<Cell> cells = map_.cells();
  std::vector<std::vector<std::uint32_t>> flat(chunk_count(cells.size(), surface_grain));
  parallel_for(cells.size(), surface_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (has_flat_triangle(cells[i], positions)) flat[begin / surface_grain].push_back(map_.source(cells[i]));
    }
  });
  std::vector<std::uint32_t> faces;
  for (const auto& part : flat) faces.insert(faces.end(), part.begin(), part.end());
  if (!faces.empty()) {
    const std::size_t count = faces.size();
    faces.resize(std::min<std::size_t>(count, 10));
    throw InvalidMesh(
        fmt::format("move: {} faces would have a triangle without area, the first: {}; move their "
                    "corners less",
                    count, fmt::join(faces, ", ")));
  }
  std::transform(positions.begin(), positions.end(), positions_.begin(), flushed);
}

bool Surface::has_flat_triangle(Cell c, std::span<const Vec3> positions) const {
  const CellView v = map_.view(c);
  const auto& simplices = v.shape().simplices();
  return std::any_of(simplices.begin(), simplices.end(), [&](const ImplicitSimplex& s) {
    const auto at = [&](unsigned i) { return positions[v.vertex(s.vertex[i]).value]; };
    return !detail::has_area(at(0), at(1), at(2));
  });
}

void Surface::set_free(Cell face, bool free) {
  if (!map_.contains(face)) throw InvalidArgument("set_free: the surface has no such face");
  map_.set_free(face, free);
}

std::vector<SimplexId> Surface::triangles() const {
  std::vector<SimplexId> all;
  for (const Cell c : map_.cells()) {
    for (std::uint16_t s = 0; s < map_.shape(c).simplices().size(); ++s) all.push_back({c, s});
  }
  return all;
}

std::array<Vertex, 3> Surface::vertices(SimplexId t) const {
  const CellView c = map_.view(t.cell);
  const auto& local = c.shape().simplices()[t.simplex].vertex;
  return {c.vertex(local[0]), c.vertex(local[1]), c.vertex(local[2])};
}

std::array<Vec3, 3> Surface::corners(SimplexId t) const {
  const auto v = vertices(t);
  return {positions_[v[0].value], positions_[v[1].value], positions_[v[2].value]};
}

AcrossEdge Surface::across(SimplexId t, unsigned edge) const {
  const CellView c = map_.view(t.cell);
  const Across across = c.shape().simplices()[t.simplex].across[edge];
  if (!across.outer()) return {{}, {t.cell, across.index}, across.place, false};
  AcrossEdge out{{t.cell, across.face()}, {}, 0, c.is_wall(across.face())};
  const CellFace other = map_.opposite(out.face);
  if (!other.valid()) return out;
  const Across entry = map_.shape(other.cell).entry(other.face, 0);
  out.triangle = {other.cell, entry.index};
  out.edge = entry.place;
  return out;
}

Vec3 Surface::normal(SimplexId t) const {
  const auto v = corners(t);
  return detail::frame_of(v[0], v[1], v[2]).normal;
}

bool Surface::contains(const SurfacePlace& place) const {
  const SimplexId t = place.triangle;
  if (!map_.contains(t.cell) || t.simplex >= map_.shape(t.cell).simplices().size()) return false;
  return detail::are_weights(place.weights);
}

Vec3 Surface::point(const SurfacePlace& place) const {
  const auto number = vertices(place.triangle);
  const auto& w = place.weights;
  unsigned k = 0;  // the nearest corner: of equals the lower number, so that both sides of an edge agree
  for (unsigned i = 1; i < 3; ++i) {
    if (w[i] > w[k] || (w[i] == w[k] && number[i] < number[k])) k = i;
  }
  const Vec3 origin = positions_[number[k].value];
  const auto part = [&](unsigned i) { return (positions_[number[i].value] - origin) * w[i]; };
  return origin + (part((k + 1) % 3) + part((k + 2) % 3));
}

SurfacePlace Surface::place(SimplexId triangle, const std::array<double, 3>& weights) const {
  const double largest = *std::max_element(weights.begin(), weights.end());
  const bool valid = std::all_of(weights.begin(), weights.end(), [](double x) { return x >= 0.0 && std::isfinite(x); });
  if (!valid || !(largest > 0.0))
    throw InvalidArgument("place: weights must be finite and not negative, and not all of them 0");
  const std::array<double, 3> scaled = {weights[0] / largest, weights[1] / largest, weights[2] / largest};
  const double sum = scaled[0] + scaled[1] + scaled[2];
  const SurfacePlace out{triangle, detail::normalized({scaled[0] / sum, scaled[1] / sum, scaled[2] / sum})};
  if (!contains(out)) throw InvalidArgument("place: the surface has no such triangle");
  return out;
}

}  // namespace dartcast
