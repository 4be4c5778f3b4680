// A swarm on a torus that breathes. It leaves one place in all directions, goes straight on within the surface, and
// comes back from a ring of blocked faces. Writes surface_NN.vtu and particles_NN.csv into the folder named, or here.
#include "dartcast/surface.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "dartcast/mesh_files.hpp"

namespace {

using dartcast::MeshData;
using dartcast::Surface;
using dartcast::SurfacePlace;
using dartcast::Vec3;

constexpr std::uint32_t around = 120;
constexpr std::uint32_t across = 48;
constexpr double pi = std::numbers::pi;

Vec3 on_torus(std::uint32_t i, std::uint32_t j, double time) {
  const double u = 2 * pi * i / around;
  const double v = 2 * pi * j / across;
  const double thick = 0.4 * (1.0 + 0.25 * std::sin(3 * u + 4.0 * time));
  const double r = 1.0 + thick * std::cos(v);
  return {r * std::cos(u), r * std::sin(u), thick * std::sin(v)};
}

std::vector<Vec3> points_at(double time) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) points.push_back(on_torus(i, j, time));
  }
  return points;
}

MeshData torus() {
  MeshData mesh;
  mesh.points = points_at(0.0);
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return (a % around) * across + b % across; };
      const std::uint32_t corners[] = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      mesh.add_cell(dartcast::CellType::quadrilateral, corners);
      mesh.free.push_back(i == 2 * around / 3 ? 0 : 1);
    }
  }
  return mesh;
}

void write_frame(const std::filesystem::path& folder, MeshData& mesh, const Surface& surface,
                 const std::vector<SurfacePlace>& places, int frame) {
  const std::string number = (frame < 10 ? "0" : "") + std::to_string(frame);
  mesh.points.assign(surface.positions().begin(), surface.positions().end());
  dartcast::write_mesh(mesh, folder / ("surface_" + number + ".vtu"));
  std::string table = "x,y,z\n";
  for (const SurfacePlace& place : places) {
    const Vec3 p = surface.point(place);
    table += std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) + "\n";
  }
  dartcast::write_bytes(folder / ("particles_" + number + ".csv"), table);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dartcast;
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  MeshData mesh = torus();
  Surface surface(mesh);
  const SurfacePlace start = SurfaceLocator(surface).nearest(surface, {1.41, 0.011, 0.013}).place;
  std::vector<SurfacePlace> places(3000, start);
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < places.size(); ++i)
    directions.push_back(tangent(surface, start.triangle, 0, 2 * pi * static_cast<double>(i) / 3000.0));

  const double step_length = 0.05;
  std::size_t contacts = 0;
  for (int frame = 0; frame < 60; ++frame) {
    write_frame(folder, mesh, surface, places, frame);
    surface.move(points_at(0.02 * (frame + 1)));
    std::vector<Vec3> displacements;
    for (const Vec3& d : directions) displacements.push_back(d * step_length);
    const SurfaceReport report = advance(surface, places, displacements, [](const SurfaceContact& c) {
      return AfterSurfaceContact{reflected(c, c.unused), true};
    });
    for (std::size_t i = 0; i < places.size(); ++i) directions[i] = report.steps[i].direction;
    contacts += report.contacts.size();
  }
  std::printf("%zu particles went %.1f each and met the blocked ring %zu times\n", places.size(), 60 * step_length,
              contacts);
}
