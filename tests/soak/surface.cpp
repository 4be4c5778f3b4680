// Makes a surface of a scene's walls, and takes steps on it.
#include "soak/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/surface.hpp"
#include "soak/scene.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::soak {

namespace {

MeshData walls_of(const CellComplex& complex) {
  const CombinatorialMap& map = complex.map();
  MeshData mesh;
  mesh.points.assign(complex.positions().begin(), complex.positions().end());
  for (Vec3& p : mesh.points)
    if (!(norm(p) < 1e60)) p = {};
  for (const Cell c : map.cells()) {
    const CellView cell = map.view(c);
    std::vector<std::uint32_t> corners;
    if (map.dimension() == 2) {
      for (std::uint16_t k = 0; k < cell.shape().corner_count(); ++k) corners.push_back(cell.vertex(k).value);
      mesh.add_cell(CellType::polygon, corners);
    }
    for (std::uint16_t f = 0; map.dimension() == 3 && f < cell.shape().face_count(); ++f) {
      if (!cell.is_free() || !cell.is_wall(f)) continue;
      corners.clear();
      for (const std::uint16_t k : cell.shape().corners(f)) corners.push_back(cell.vertex(k).value);
      mesh.add_cell(CellType::polygon, corners);
    }
  }
  return mesh;
}

// The answers depend on the particle and the contact alone.
AfterSurfaceContact answer(const SurfaceContact& c) {
  if (c.particle % 3 == 0) return {reflected(c, c.unused, 0.8), true};
  if (c.particle % 3 == 1) return {slid(c, c.unused), true};
  return {};
}

std::string check(const Surface& surface, const SurfacePlace& place, const SurfaceStep& step, double way,
                  const std::vector<SurfaceCrossing>& crossings) {
  if (!surface.contains(place)) return "is in no triangle";
  if (!is_finite(surface.point(place))) return "is nowhere";
  if (step.length > way * (1.0 + 1e-9)) return fmt::format("went {} of {}", step.length, way);
  if (step.end == SurfaceEnd::arrived && step.contacts == 0 && step.length < way * (1.0 - 1e-9))
    return fmt::format("arrived after {} of {}", step.length, way);
  for (std::size_t k = 1; k < crossings.size(); ++k)
    if (crossings[k].time < crossings[k - 1].time) return "has crossings out of order";
  return "";
}

}  // namespace

std::string step_on_surface(const Case& c, const CellComplex& complex, std::uint64_t step) {
  Random random = random_for(c, Use::answer, 500 + step);
  std::optional<Surface> surface;
  try {
    surface.emplace(walls_of(complex));
  } catch (const InvalidMesh&) {  // walls that meet at an edge in threes, or a face without area
    return "";
  }
  const std::vector<Cell> faces = surface->map().cells();
  for (const Cell f : faces)
    if (random.below(8) == 0) surface->set_free(f, false);
  const std::vector<SimplexId> triangles = surface->triangles();
  std::vector<SurfacePlace> places;
  std::vector<Vec3> ways;
  for (int i = 0; i < 60; ++i) {
    const SimplexId t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    std::array<double, 3> weights{};
    while (weights[0] + weights[1] + weights[2] == 0.0)
      for (double& w : weights) w = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 1.0);
    places.push_back(surface->place(t, weights));
    const double size = norm(surface->corners(t)[1] - surface->corners(t)[0]);
    const Vec3 normal = surface->normal(t);
    const Vec3 way = test::random_vector(random, 1.0) * (size * std::pow(10.0, random.uniform(-3.0, 1.5)));
    ways.push_back(way - dot(way, normal) * normal);
  }
  std::vector<SurfacePlace> one = places, several = places;
  const SurfaceReport report = advance(*surface, one, ways, answer, {}, Threads{1});
  const SurfaceReport again = advance(*surface, several, ways, answer, {}, Threads{3});
  if (one != several || report.contacts.size() != again.contacts.size()) return "threads give other places";
  std::size_t contacts = 0;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    std::vector<SurfaceCrossing> crossings;
    std::vector<SurfaceContact> met;
    SurfacePlace place = places[i];
    const SurfaceStep alone =
        dartcast::step(*surface, place, ways[i], answer, {}, {.contacts = &met, .crossings = &crossings}, i);
    contacts += met.size();
    std::string wrong = place == one[i] && alone.length == report.steps[i].length ? "" : "alone ends elsewhere";
    // On the border of a blocked face it goes on in the free one beside that, whose plane is another.
    const bool is_free = surface->map().is_free(places[i].triangle.cell);
    if (wrong.empty() && is_free) wrong = check(*surface, place, alone, norm(ways[i]), crossings);
    if (!wrong.empty()) return fmt::format("particle {} {}", i, wrong);
  }
  return contacts == report.contacts.size() ? "" : "contacts that no particle alone has";
}

}  // namespace dartcast::soak
